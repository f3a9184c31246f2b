#include "trace.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <thread>

#include "coif/io/safe_file.h"

namespace coif::studio {

void Trace::add(const char* name, Time start, Time end, Notes notes) {
  using Microseconds = std::chrono::duration<double, std::micro>;
  if (!on()) return;
  const std::size_t thread = std::hash<std::thread::id>{}(std::this_thread::get_id());
  const std::scoped_lock lock(mutex_);
  events_.push_back({name, thread, Microseconds(start - begin_).count(), Microseconds(end - start).count(),
                     std::move(notes)});
}

Status Trace::write() const {
  if (!on()) return {};
  const std::scoped_lock lock(mutex_);
  nlohmann::json events = nlohmann::json::array();
  std::vector<std::size_t> threads;  // numbered as they first appear
  for (const Event& event : events_) {
    auto found = std::ranges::find(threads, event.thread);
    if (found == threads.end()) found = threads.insert(found, event.thread);
    nlohmann::json notes = nlohmann::json::object();
    for (const auto& [what, value] : event.notes) notes[what] = value;
    events.push_back({{"name", event.name},
                      {"ph", "X"},
                      {"ts", event.startUs},
                      {"dur", event.lengthUs},
                      {"pid", 1},
                      {"tid", found - threads.begin() + 1},
                      {"args", notes}});
  }
  COIF_ASSIGN(auto file, SafeFile::create(file_));
  file.write(nlohmann::json{{"traceEvents", events}}.dump());
  return file.commit();
}

}  // namespace coif::studio
