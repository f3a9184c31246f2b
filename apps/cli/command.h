// What every subcommand of `coif` shares: global switches, progress, and one way to end.
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <string>

#include "coif/base/context.h"
#include "coif/base/result.h"

namespace coif::cli {

/// 0 done, 1 the input is at fault, 2 bad usage.
enum class Exit { Done = 0, InputFault = 1, BadUsage = 2 };

struct Session {
  bool quiet = false;  ///< no progress, no summary
  bool json = false;   ///< one JSON object on standard output
  int threads = 0;
  Exit exit = Exit::Done;

  /// Threads, and a progress line on a terminal for anything over a second.
  Context context() const;
  /// Prints the error as a sentence (and as JSON where asked) and sets exit to InputFault.
  void fail(const Error& error);
  /// The same for a value that the command line itself got wrong.
  void usage(const std::string& sentence);
  /// A line for people; silent with --quiet or --json.
  void say(const std::string& line) const;
  /// The command's result: `json` with --json.
  void finish(const nlohmann::ordered_json& json) const;
};

/// Clears the progress line that context() may have left.
void endProgress();

void addNew(CLI::App& app, Session& session);
void addBuild(CLI::App& app, Session& session);
void addRender(CLI::App& app, Session& session);
void addInfo(CLI::App& app, Session& session);
void addCheck(CLI::App& app, Session& session);
void addConvert(CLI::App& app, Session& session);
void addBench(CLI::App& app, Session& session);
void addStyle(CLI::App& app, Session& session);
void addSimulate(CLI::App& app, Session& session);
void addDrape(CLI::App& app, Session& session);
void addExampleHead(CLI::App& app, Session& session);

}  // namespace coif::cli
