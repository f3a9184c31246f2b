// coif-studio: the editor.
#include <signal.h>

#include <CLI/CLI.hpp>
#include <iostream>

#include "studio.h"

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
  app.add_option("--style", options.style, "The hairstyle that a head is opened with; '' for bare roots");
  app.add_option("--size", size, "The window, WIDTHxHEIGHT");
  app.add_option("--trace", options.trace, "Write how long each part of a frame took, for chrome://tracing");
  app.add_option("--python-log", options.pythonLog, "Append each command that is done, as a line of Python");
  bool listCommands = false;
  app.add_flag("--list-commands", listCommands, "Print every command with menu and key as JSON, and end");
  app.add_option("--script", options.script, "A Python script to run on the document");
  app.add_option("--channel", options.channel, "A socket to the Python process that opens the studio")
      ->group("");
  CLI11_PARSE(app, argc, argv);
  const Settings remembered = Settings::load();
  int width = remembered.width, height = remembered.height;
  if (size.empty()) size = std::to_string(width) + "x" + std::to_string(height);
  if (std::sscanf(size.c_str(), "%dx%d", &width, &height) != 2 || width < 200 || height < 100 ||
      width > 16384 || height > 16384) {
    std::cerr << "coif-studio: --size wants WIDTHxHEIGHT of at least 200x100, not '" << size << "'\n";
    return 2;
  }
  std::error_code ignored;
  std::filesystem::create_directories(stateFolder(), ignored);
  auto window = Window::open(width, height, (stateFolder() / "layout.ini").string());
  if (!window.ok()) {
    std::cerr << "coif-studio: " << window.error().text() << "\n";
    return 1;
  }
  Studio studio(**window, options);
  if (listCommands) {
    std::cout << studio.commandList() << "\n";
    return 0;
  }
  (*window)->run([&] { return studio.frame(); }, [&] { return studio.mayClose(); });
  if (const coif::Status traced = studio.finish(); !traced.ok()) {
    std::cerr << "coif-studio: " << traced.error().text() << "\n";
    return 1;
  }
  return 0;
}
