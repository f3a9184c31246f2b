// coif-studio: the editor.
#include <signal.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <iostream>
#include <utility>

#include "coif/scene/hairstyle.h"
#include "studio.h"

namespace {

/// With COIF_STUDIO_LOSABLE set, SIGUSR1 stands for a driver that was reset: for tests, where none ever is.
volatile std::sig_atomic_t loseContext = 0;

}  // namespace

int main(int argc, char** argv) {
  using namespace coif::studio;
  // A full disk or a pipe that is gone is an error of the write, not the end.
  ::signal(SIGXFSZ, SIG_IGN);
  ::signal(SIGPIPE, SIG_IGN);
  CLI::App app("Coif Studio: sculpt hairstyles on hair meshes");
  app.footer("Example:\n  coif-studio head.obj --style bob\n");
  app.set_version_flag("--version", std::string("coif-studio ") + COIF_VERSION);
  StudioOptions options;  // its clock starts here
  std::string size;       // else as in the last run
  app.add_option("file", options.open, "A .coif document, or a head: OBJ, PLY, OFF, STL, GLB, glTF or USD");
  std::vector<std::string> styles(coif::hairstyleNames().begin(), coif::hairstyleNames().end());
  styles.push_back("");
  app.add_option("--style", options.style, "The hairstyle that a head is opened with; '' for bare roots")
      ->check(CLI::IsMember(styles));
  app.add_option("--size", size, "The window, WIDTHxHEIGHT");
  app.add_option("--trace", options.trace, "Write how long each part of a frame took, for chrome://tracing");
  app.add_option("--python-log", options.pythonLog, "Append each command that is done, as a line of Python");
  bool listCommands = false;
  app.add_flag("--list-commands", listCommands, "Print every command with menu and key as JSON, and end");
  app.add_option("--script", options.script, "A Python script to run on the document");
  app.add_option("--channel", options.channel, "A socket to the Python process that opens the studio")
      ->group("");
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return app.exit(success);
  } catch (const CLI::ParseError& error) {  // as the command says it
    std::string sentence = error.what();
    if (!sentence.ends_with('.')) sentence += '.';
    std::cerr << "coif-studio: " << sentence << " Try 'coif-studio --help'.\n";
    return 2;
  }
  Window::Place place = Settings::load().window;
  if (!size.empty()) {
    place.maximised = false;
    if (std::sscanf(size.c_str(), "%dx%d", &place.width, &place.height) != 2 || place.width < 200 ||
        place.height < 100 || place.width > 16384 || place.height > 16384) {
      std::cerr << "coif-studio: --size wants WIDTHxHEIGHT of at least 200x100, not '" << size << "'\n";
      return 2;
    }
  }
  std::error_code ignored;
  std::filesystem::create_directories(stateFolder(), ignored);
  auto window = Window::open(place, (stateFolder() / "layout.ini").string());
  if (!window.ok()) {
    std::cerr << "coif-studio: " << window.error().text() << "\n";
    return 1;
  }
  Studio studio(**window, options);
  if (listCommands) {
    std::cout << studio.commandList() << "\n";
    return 0;
  }
  const bool losable = std::getenv("COIF_STUDIO_LOSABLE") != nullptr;
  if (losable) ::signal(SIGUSR1, [](int) { loseContext = 1; });
  const coif::Status ran = (*window)->run({[&] {
                                             if (std::exchange(loseContext, 0)) (*window)->loseContext();
                                             return studio.frame();
                                           },
                                           [&] { return studio.mayClose(); }, [&] { studio.contextLost(); }});
  const coif::Status kept = studio.finish();
  for (const coif::Status& status : {ran, kept}) {
    if (status.ok()) continue;
    std::cerr << "coif-studio: " << status.error().text() << "\n";
    return 1;
  }
  return 0;
}
