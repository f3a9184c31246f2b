// A Python process beside the studio: lines of JSON both ways over a socket.
//
// Python asks, with an id: {"id": 1, "run": "extrude", "arguments": {"distance": 0.5}}, "act", "rest",
// "state", "write", "open", "save", "export", "screenshot", "close"; the studio answers {"id": 1, "value": …}
// or
// {"id": 1, "error": "a sentence"}. Python tells {"output": text} and {"done": n, "more": false}; the studio
// tells {"execute": n, "source": text, "name": "file"}. python/coif/_studio.py is the other end.
#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

namespace coif::studio {

class Channel {
 public:
  /// Takes the socket over. `wake` is called from the channel's thread when a line came or the end.
  Channel(int socket, std::function<void()> wake);
  ~Channel();
  Channel(const Channel&) = delete;
  Channel& operator=(const Channel&) = delete;

  void send(const nlohmann::json& message);  ///< lost when the other end is gone
  std::vector<nlohmann::json> take();        ///< what came since the last call, in order
  std::string takeRest();                  ///< lines that were no message: what a process says when it fails
  bool closed() const { return closed_; }  ///< and nothing more will come

 private:
  void loop();
  void takeLines(std::string& buffer);

  int socket_;
  std::function<void()> wake_;
  std::mutex mutex_;
  std::vector<nlohmann::json> came_;
  std::string rest_;
  std::atomic<bool> closed_{false};
  std::thread thread_;
};

}  // namespace coif::studio
