// Error against run time: measured samples, plots, named figures with bars, and how they are written down.
//
// A bench compares methods that solve one problem, against a truth computed in the program itself. It quotes
// ratios to a baseline of the same run; absolute seconds are kept for the plots only. Figures with a bar say
// whether a promise of the documentation holds.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "coif/base/context.h"
#include "coif/base/result.h"

namespace coif {

struct BenchFigure;

struct BenchOptions {
  bool quick = false;  ///< a few seconds, for tests: fewer sizes, same figures
  std::uint64_t seed = 1;
  /// Seconds after which a bench of many rows (gpu) begins no further one; it measures what matters most
  /// first, and says what it left out. 0: no bound.
  double budgetSeconds = 200;
  /// picture: where traced pictures are kept for the next time, and taken from; empty: nowhere.
  std::filesystem::path truthFolder = {};
  int truthSamples = 0;  ///< picture: a pixel and half of the truth; 0: as many as the bench thinks best
  /// Told of each figure as soon as it is measured (gpu), so that a run that is cut off keeps them.
  std::function<void(const BenchFigure&)> onFigure = {};
  Context context;
};

/// One run of one method.
struct BenchSample {
  std::string method;
  std::vector<std::pair<std::string, std::string>>
      parameters;      ///< what was chosen, in the columns of the CSV
  double error = 0;    ///< against the truth, in the plot's unit
  double seconds = 0;  ///< the fastest of the repeats
  double ratio = 0;    ///< seconds / those of the plot's baseline; 0: no baseline in this plot
  std::vector<std::pair<std::string, double>> measures =
      {};  ///< what else was measured: columns of their own
};

/// One problem: a curve a method, samples joined in their order.
struct BenchPlot {
  std::string name;  ///< stem of the .csv and .svg files: [a-z0-9-]
  std::string title;
  std::string errorUnit;
  std::string truth;  ///< how the truth was computed, and its own error
  std::vector<BenchSample> samples;
  std::string against = "seconds";  ///< what the error is drawn over: seconds, or the name of a measure
  bool curves = false;              ///< functions: linear axes, errorUnit is the whole label, no markers

  /// Of `against`; NaN where the sample does not say.
  double abscissa(const BenchSample& sample) const;

  /// Sets every ratio against the first sample that equals this one's method and has these parameters.
  void rateAgainst(const std::string& method,
                   const std::vector<std::pair<std::string, std::string>>& parameters);
};

enum class Bar { None, AtMost, AtLeast };

/// A named number, with the bar that it has to clear.
struct BenchFigure {
  std::string name;
  double value = 0;
  std::string unit;
  Bar kind = Bar::None;
  double bar = 0;
  /// True without a bar; false for a value that is not a number.
  bool holds() const;
};

struct BenchReport {
  std::string name;  ///< "place"
  std::string title;
  std::string about;  ///< what was varied and what was held, a paragraph of plain text
  std::vector<BenchPlot> plots;
  std::vector<BenchFigure> figures;
  std::uint64_t seed = 0;
  bool quick = false;
  double seconds = 0;  ///< of the whole bench
  bool holds() const;  ///< all its figures do
};

/// Names that runBench knows, in the order in which "all" runs them.
std::vector<std::string> benchNames();
/// Errors: NotFound for a name that is none, with those that are.
Result<BenchReport> runBench(std::string_view name, const BenchOptions& options = {});
/// One report, or one a bench for "all".
Result<std::vector<BenchReport>> runBenches(std::string_view name, const BenchOptions& options = {});

/// The figures, samples, machine and build as one JSON object.
std::string benchJson(const std::vector<BenchReport>& reports);
std::string benchCsv(const BenchPlot& plot);
/// A log–log plot, error over seconds or over a measure, or curves on linear axes, as a stand-alone SVG file.
std::string benchSvg(const BenchPlot& plot);
/// Every plot inline, every figure in a table, machine, compiler, build and seed stated.
std::string benchHtml(const std::vector<BenchReport>& reports);
/// Writes PLOT.csv, PLOT.svg, report.html and report.json into `folder`, made if need be. Errors: Unreadable.
Status writeBench(const std::vector<BenchReport>& reports, const std::filesystem::path& folder);

/// What the numbers were measured on.
struct BenchMachine {
  std::string processor, system, compiler, build, version;
  int threads = 0;
};
BenchMachine benchMachine();

/// Seconds of the fastest of several calls: at least two, until a tenth of a second is spent, at most twenty;
/// one when a call takes longer than that.
template <class Call>
double fastestSeconds(const Call& call);

/// Ends a bench from within; runBench returns the error.
struct BenchFault {
  Error error;
};
/// The value, or the bench's end.
template <class T>
T require(Result<T> result) {
  if (!result.ok()) throw BenchFault{result.error()};
  return std::move(result).value();
}

// The benches, one file each. They may throw BenchFault.
BenchReport benchPlace(const BenchOptions& options);        ///< bench_place.cpp
BenchReport benchCoordinates(const BenchOptions& options);  ///< bench_coordinates.cpp
BenchReport benchStrands(const BenchOptions& options);      ///< bench_strands.cpp
BenchReport benchVisibility(const BenchOptions& options);   ///< bench_visibility.cpp
BenchReport benchScattering(const BenchOptions& options);   ///< bench_scattering.cpp
BenchReport benchGpu(const BenchOptions& options);          ///< bench_gpu.cpp; not without COIF_WITH_PREVIEW
BenchReport benchPicture(const BenchOptions& options);      ///< bench_picture.cpp; not without COIF_WITH_PREVIEW
BenchReport benchSkips(const BenchOptions& options);        ///< bench_skips.cpp; not without COIF_WITH_PREVIEW
BenchReport benchDynamics(const BenchOptions& options);     ///< bench_dynamics.cpp

}  // namespace coif

#include "bench/bench_timing.h"
