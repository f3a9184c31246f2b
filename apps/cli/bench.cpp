// coif bench: error against run time for the choices a user has.
#include "bench/bench.h"

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>

#include "command.h"
#include "values.h"

namespace coif::cli {

namespace {

struct BenchArguments {
  std::string name, folder;
  std::string truth;
  int truthSamples = 0;
  bool quick = false;
  double budget = BenchOptions{}.budgetSeconds;
  std::uint64_t seed = 1;
};

Status bench(const BenchArguments& arguments, Session& session) {
  BenchOptions options;
  options.quick = arguments.quick;
  options.seed = arguments.seed;
  options.budgetSeconds = arguments.budget;
  options.truthFolder = arguments.truth;
  options.truthSamples = arguments.truthSamples;
  options.context = session.context();
  std::ofstream rows;
  if (!arguments.folder.empty()) {
    std::error_code failed;
    std::filesystem::create_directories(arguments.folder, failed);
    if (failed)
      return makeError(ErrorCode::Unreadable, "the folder cannot be made: " + failed.message(), "",
                       arguments.folder);
  }
  options.onFigure = [&](const BenchFigure& figure) {
    endProgress();
    char value[40];
    std::snprintf(value, sizeof value, "%.4g", figure.value);
    if (!session.quiet) std::cerr << figure.name << ": " << value << " " << figure.unit << std::endl;
    if (arguments.folder.empty()) return;
    const std::filesystem::path path =
        std::filesystem::path(arguments.folder) / (arguments.name + "-rows.csv");
    if (!rows.is_open()) rows.open(path), rows << "figure,value,unit\n";
    rows << '"' << figure.name << "\"," << value << ',' << figure.unit << std::endl;
  };
  COIF_ASSIGN(const auto reports, runBenches(arguments.name, options));
  for (const BenchReport& report : reports) {
    session.say(report.title);
    for (const BenchFigure& figure : report.figures) {
      char line[256];
      std::snprintf(line, sizeof line, "  %-52s %12.4g %-12s", figure.name.c_str(), figure.value,
                    figure.unit.c_str());
      std::string text = line;
      if (figure.kind != Bar::None) {
        std::snprintf(line, sizeof line, " %s %.4g  %s", figure.kind == Bar::AtMost ? "at most" : "at least",
                      figure.bar, figure.holds() ? "holds" : "MISSED");
        text += line;
      }
      session.say(text);
    }
  }
  if (!arguments.folder.empty()) {
    COIF_TRY(writeBench(reports, arguments.folder));
    session.say("wrote " + arguments.folder + "/report.html");
  }
  session.finish(nlohmann::ordered_json::parse(benchJson(reports)));
  return {};
}

}  // namespace

void addBench(CLI::App& app, Session& session) {
  auto arguments = std::make_shared<BenchArguments>();
  std::vector<std::string> names = benchNames();
  names.push_back("all");
  CLI::App* command = app.add_subcommand("bench", "Measure error against run time");
  command->footer("Example:\n  coif bench place -o bench-out\n");
  command->add_option("name", arguments->name, "What to measure")->required()->check(CLI::IsMember(names));
  command->add_option("-o,--output", arguments->folder, "Folder for .csv, .svg and report.html");
  command->add_option("--seed", arguments->seed, "Seed of the test cases")->check(wholeNumber());
  command
      ->add_option("--budget", arguments->budget,
                   "gpu: seconds after which no further row is begun, 0 for no bound")
      ->check(number(0, 1e6));
  command->add_option("--truth", arguments->truth,
                      "picture: folder where path-traced pictures are kept, and taken from");
  command->add_option("--truth-samples", arguments->truthSamples,
                      "picture: samples a pixel of each half of the truth")
      ->check(CLI::Range(2, 1 << 20));
  command->add_flag("--quick", arguments->quick, "Fewer sizes, a few seconds");
  command->callback([arguments, &session] {
    if (const Status status = bench(*arguments, session); !status.ok()) session.fail(status.error());
  });
}

}  // namespace coif::cli
