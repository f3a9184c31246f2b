#include "channel.h"

#include <sys/socket.h>
#include <unistd.h>

#include <utility>

namespace coif::studio {
namespace {

constexpr std::size_t kMostBuffered = std::size_t{64} << 20;  // a line longer than this is no message

}  // namespace

Channel::Channel(int socket, std::function<void()> wake)
    : socket_(socket), wake_(std::move(wake)), thread_([this] { loop(); }) {}

Channel::~Channel() {
  ::shutdown(socket_, SHUT_RDWR);
  thread_.join();
  ::close(socket_);
}

void Channel::send(const nlohmann::json& message) {
  // What Python prints may be no UTF-8; what it is told is.
  const std::string line = message.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  std::size_t sent = 0;
  while (sent < line.size()) {
    const ssize_t n = ::send(socket_, line.data() + sent, line.size() - sent, MSG_NOSIGNAL);
    if (n <= 0) return;
    sent += std::size_t(n);
  }
}

std::vector<nlohmann::json> Channel::take() {
  const std::scoped_lock lock(mutex_);
  return std::exchange(came_, {});
}

std::string Channel::takeRest() {
  const std::scoped_lock lock(mutex_);
  return std::exchange(rest_, {});
}

void Channel::takeLines(std::string& buffer) {
  std::size_t from = 0;
  const std::scoped_lock lock(mutex_);
  for (std::size_t end; (end = buffer.find('\n', from)) != std::string::npos; from = end + 1) {
    auto message = nlohmann::json::parse(buffer.begin() + std::ptrdiff_t(from),
                                         buffer.begin() + std::ptrdiff_t(end), nullptr, false);
    if (message.is_object()) {
      came_.push_back(std::move(message));
    } else {
      rest_.append(buffer, from, end + 1 - from);
    }
  }
  buffer.erase(0, from);
}

void Channel::loop() {
  std::string buffer;
  char bytes[1 << 16];
  while (buffer.size() < kMostBuffered) {
    const ssize_t n = ::read(socket_, bytes, sizeof bytes);
    if (n <= 0) break;
    buffer.append(bytes, std::size_t(n));
    takeLines(buffer);
    wake_();
  }
  closed_ = true;
  wake_();
}

}  // namespace coif::studio
