#include <cstdio>
#include <nlohmann/json.hpp>

#include "coif/scene/evaluate.h"

namespace coif {

namespace {

std::string bytesText(std::uint64_t bytes) {
  const char* units[] = {"B", "KiB", "MiB", "GiB"};
  double value = double(bytes);
  int unit = 0;
  while (value >= 1024 && unit < 3) value /= 1024, ++unit;
  char text[32];
  std::snprintf(text, sizeof text, unit == 0 ? "%.0f %s" : "%.1f %s", value, units[unit]);
  return text;
}

}  // namespace

std::string explainText(const std::vector<StageReport>& reports) {
  std::string out = "stage    state    seconds      bytes  why\n";
  for (const StageReport& report : reports) {
    char line[128];
    std::snprintf(line, sizeof line, "%-8s %-8s %7.3f %10s  ", report.name.c_str(), name(report.state),
                  report.seconds, report.bytes ? bytesText(report.bytes).c_str() : "-");
    out += line + report.reason + "\n";
    const std::string indent(38, ' ');
    if (report.error.value >= 0) {
      std::snprintf(line, sizeof line, "error %.2g ", report.error.value);
      out += indent + line + report.error.unit + " (" + report.error.method + ")\n";
    }
    for (const LeftOut& part : report.leftOut) {
      std::snprintf(line, sizeof line, "left out in %.3g %% of ", 100 * part.share);
      out += indent + line + part.of + ": " + part.what + " (" + part.control + "): " + part.trigger + "\n";
    }
    for (const std::string& note : report.notes) out += indent + note + "\n";
  }
  return out;
}

std::string reportJson(const std::vector<StageReport>& reports) {
  nlohmann::ordered_json stages = nlohmann::ordered_json::array();
  for (const StageReport& report : reports) {
    nlohmann::ordered_json stage = {{"stage", report.name},
                                    {"state", name(report.state)},
                                    {"because", report.reason},
                                    {"seconds", report.seconds},
                                    {"bytes", report.bytes}};
    if (report.error.value >= 0) {
      stage["error"] = {
          {"value", report.error.value}, {"unit", report.error.unit}, {"method", report.error.method}};
    }
    for (const LeftOut& part : report.leftOut) {
      stage["leftOut"].push_back({{"what", part.what},
                                  {"switch", part.control},
                                  {"trigger", part.trigger},
                                  {"share", part.share},
                                  {"of", part.of}});
    }
    stage["notes"] = report.notes;
    stages.push_back(std::move(stage));
  }
  const nlohmann::ordered_json out = {{"stages", std::move(stages)}};
  return out.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace coif
