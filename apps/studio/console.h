// The Python console: a child process with the coif module, what it printed, what is being typed.
//
// A process of its own: a script that loops can be stopped and one that crashes takes nothing along.
#pragma once

#include <sys/types.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "channel.h"
#include "coif/base/result.h"

namespace coif::studio {

class Console {
 public:
  explicit Console(std::function<void()> wake) : wake_(std::move(wake)) {}
  ~Console() { end(); }

  /// Runs source text, as if typed ("" for the name) or as a script. Starts Python first where it does not
  /// run: COIF_PYTHON, else python3.
  void execute(const std::string& source, const std::string& name = "");
  /// KeyboardInterrupt at the first call; the end of the process at the second.
  void stop();
  bool busy() const { return running_ > 0; }

  /// Requests that came; output and endings are taken by the console itself. Call once a frame.
  std::vector<nlohmann::json> poll();
  void answer(const nlohmann::json& message);

  const std::string& text() const { return text_; }  ///< all that was typed and printed, its newest part
  void clear() { text_.clear(); }
  bool wantsMore() const { return more_; }  ///< the statement typed so far goes on
  bool takeGrown() { return std::exchange(grown_, false); }

 private:
  Status start();
  void end();
  void print(const std::string& text);

  std::function<void()> wake_;
  std::unique_ptr<Channel> channel_;
  pid_t process_ = -1;
  int running_ = 0, executed_ = 0;
  bool interrupted_ = false, more_ = false, grown_ = false;
  std::string text_;
};

}  // namespace coif::studio
