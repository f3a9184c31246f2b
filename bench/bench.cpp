#include "bench/bench.h"

#include <cmath>
#include <limits>

namespace coif {

namespace {

using Run = BenchReport (*)(const BenchOptions&);

struct Entry {
  std::string_view name;
  Run run;
};

constexpr Entry kBenches[] = {
    {"place", benchPlace},
    {"coordinates", benchCoordinates},
    {"strands", benchStrands},
    {"visibility", benchVisibility},
    {"scattering", benchScattering},
#ifdef COIF_WITH_PREVIEW
    {"gpu", benchGpu},
    {"picture", benchPicture},
    {"skips", benchSkips},
#endif
    {"dynamics", benchDynamics},
};

}  // namespace

double BenchPlot::abscissa(const BenchSample& sample) const {
  if (against == "seconds") return sample.seconds;
  for (const auto& [key, value] : sample.measures) {
    if (key == against) return value;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

void BenchPlot::rateAgainst(const std::string& method,
                            const std::vector<std::pair<std::string, std::string>>& parameters) {
  for (const BenchSample& base : samples) {
    if (base.method != method || base.parameters != parameters || !(base.seconds > 0)) continue;
    const double seconds = base.seconds;
    for (BenchSample& sample : samples) sample.ratio = sample.seconds / seconds;
    return;
  }
}

bool BenchFigure::holds() const {
  if (std::isnan(value)) return false;
  return kind == Bar::None || (kind == Bar::AtMost ? value <= bar : value >= bar);
}

bool BenchReport::holds() const {
  for (const BenchFigure& figure : figures) {
    if (!figure.holds()) return false;
  }
  return true;
}

std::vector<std::string> benchNames() {
  std::vector<std::string> names;
  for (const Entry& entry : kBenches) names.emplace_back(entry.name);
  return names;
}

Result<BenchReport> runBench(std::string_view name, const BenchOptions& options) {
  for (const Entry& entry : kBenches) {
    if (entry.name != name) continue;
    const Stopwatch watch;
    BenchReport report;
    try {
      report = entry.run(options);
    } catch (const BenchFault& fault) {
      return fault.error;
    }
    report.name = entry.name;
    report.seed = options.seed;
    report.quick = options.quick;
    report.seconds = watch.seconds();
    return report;
  }
  std::string known;
  for (const Entry& entry : kBenches) known += (known.empty() ? "" : ", ") + std::string(entry.name);
  return makeError(ErrorCode::NotFound,
                   "there is no bench named '" + std::string(name) + "'; there are: " + known);
}

Result<std::vector<BenchReport>> runBenches(std::string_view name, const BenchOptions& options) {
  std::vector<BenchReport> reports;
  for (const std::string& each : name == "all" ? benchNames() : std::vector{std::string(name)}) {
    COIF_ASSIGN(BenchReport report, runBench(each, options));
    reports.push_back(std::move(report));
  }
  return reports;
}

}  // namespace coif
