#include "console.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>

extern char** environ;

namespace coif::studio {
namespace {

constexpr std::size_t kMostText = 1 << 20;
constexpr int kChildSocket = 3;

}  // namespace

Status Console::start() {
  int pair[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) != 0)
    return makeError(ErrorCode::Unreadable, std::string("no socket for Python: ") + std::strerror(errno));
  const char* own = std::getenv("COIF_PYTHON");
  const std::string python = own != nullptr && *own != 0 ? own : "python3";
  std::string program =
      "import sys\n"
      "try:\n from coif._studio import serve\n"
      "except ImportError as error:\n"
      " sys.exit(f'{error}: install the Python module coif, or name a Python that has it in COIF_PYTHON')\n"
      "serve(3)";
  char* arguments[] = {const_cast<char*>(python.c_str()), const_cast<char*>("-c"), program.data(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, pair[1], kChildSocket);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  // What the interpreter itself says at its end (a missing module) comes the same way as everything else.
  posix_spawn_file_actions_adddup2(&actions, pair[1], 2);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);  // Ctrl+C in a terminal is not meant for it
  const int failed = ::posix_spawnp(&process_, python.c_str(), &actions, &attributes, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  ::close(pair[1]);
  if (failed != 0) {
    ::close(pair[0]);
    process_ = -1;
    return makeError(ErrorCode::NotFound, python + " cannot be started: " + std::strerror(failed));
  }
  channel_ = std::make_unique<Channel>(pair[0], wake_);
  return {};
}

void Console::end() {
  channel_.reset();
  if (process_ > 0) {
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
  }
  process_ = -1;
  running_ = 0;
  more_ = false;
}

void Console::execute(const std::string& source, const std::string& name) {
  if (name.empty()) print((more_ ? "... " : ">>> ") + source + "\n");
  if (!channel_) {
    if (const Status status = start(); !status.ok()) return print(status.error().text() + "\n");
  }
  ++running_;
  interrupted_ = false;
  channel_->send({{"execute", ++executed_}, {"source", source}, {"name", name}});
}

void Console::stop() {
  if (process_ <= 0 || running_ == 0) return;
  if (!std::exchange(interrupted_, true)) {
    ::kill(process_, SIGINT);
    return;
  }
  end();
  print("Python was ended; its variables are gone.\n");
}

std::vector<nlohmann::json> Console::poll() {
  std::vector<nlohmann::json> requests;
  if (!channel_) return requests;
  const bool closed = channel_->closed();
  for (nlohmann::json& message : channel_->take()) {
    if (message.contains("output")) {
      print(message.value("output", ""));
    } else if (message.contains("done")) {
      running_ = std::max(running_ - 1, 0);
      more_ = message.value("more", false);
    } else {
      requests.push_back(std::move(message));
    }
  }
  if (closed) {
    print(channel_->takeRest());
    end();
    print("Python has ended.\n");
  }
  return requests;
}

void Console::answer(const nlohmann::json& message) {
  if (channel_) channel_->send(message);
}

void Console::print(const std::string& text) {
  if (text.empty()) return;
  text_ += text;
  grown_ = true;
  if (text_.size() > kMostText) text_.erase(0, text_.size() - kMostText / 2);
}

}  // namespace coif::studio
