// coif: hairstyles from a head model, at the command line.
#include <csignal>
#include <exception>
#include <iostream>

#include "command.h"

int main(int argc, char** argv) {
  using namespace coif::cli;
  // A file-size limit is a failed write like a full disk: an error with a sentence, not the end of the
  // process.
  std::signal(SIGXFSZ, SIG_IGN);
  CLI::App app{
      "Coif models hair with hair meshes: from a head to strands for Blender, Unreal and renderers."};
  app.footer(
      "Example:\n  coif new --scalp head.obj --style bob -o bob.coif\n"
      "  coif build bob.coif -o bob.usdc -o bob.glb --strands 100000\n");
  app.set_version_flag("--version", "coif " COIF_VERSION);
  app.require_subcommand(1);
  app.fallthrough();
  Session session;
  app.add_flag("-q,--quiet", session.quiet, "Print nothing but errors");
  app.add_flag("--json", session.json, "Print the result as one JSON object");
  app.add_option("--threads", session.threads, "Threads to use; 0 is all cores")->check(CLI::Range(0, 1024));
  addNew(app, session);
  addBuild(app, session);
  addRender(app, session);
  addInfo(app, session);
  addCheck(app, session);
  addConvert(app, session);
  addBench(app, session);
  addStyle(app, session);
  addSimulate(app, session);
  addDrape(app, session);
  addExampleHead(app, session);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    std::string sentence = error.what();
    if (app.get_subcommands().empty() && !app.remaining().empty())
      sentence = "'" + app.remaining().front() + "' is neither a command nor an option";
    if (!sentence.empty() && sentence.back() != '.') sentence += '.';
    std::cerr << "coif: " << sentence << " Try 'coif --help'.\n";
    return int(Exit::BadUsage);
  } catch (const std::bad_alloc&) {
    std::cerr << "coif: there is not enough memory for this.\n";
    return int(Exit::InputFault);
  } catch (const std::exception& error) {
    std::cerr << "coif: an internal check failed, please report it: " << error.what() << "\n";
    return int(Exit::InputFault);
  }
  return int(session.exit);
}
