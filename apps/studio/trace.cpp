#include "trace.h"

#include <nlohmann/json.hpp>

#include "coif/io/safe_file.h"

namespace coif::studio {

void Trace::add(const char* name, Time start, Time end) {
  using Microseconds = std::chrono::duration<double, std::micro>;
  if (on())
    events_.push_back({name, Microseconds(start - begin_).count(), Microseconds(end - start).count()});
}

Status Trace::write() const {
  if (!on()) return {};
  nlohmann::json events = nlohmann::json::array();
  for (const Event& event : events_) {
    events.push_back({{"name", event.name},
                      {"ph", "X"},
                      {"ts", event.startUs},
                      {"dur", event.lengthUs},
                      {"pid", 1},
                      {"tid", 1}});
  }
  COIF_ASSIGN(auto file, SafeFile::create(file_));
  file.write(nlohmann::json{{"traceEvents", events}}.dump());
  return file.commit();
}

}  // namespace coif::studio
