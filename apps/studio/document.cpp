#include "document.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "coif/io/mesh_io.h"
#include "coif/io/safe_file.h"
#include "coif/scalp/example_head.h"
#include "coif/scene/new_scene.h"

namespace coif::studio {
namespace {

namespace fs = std::filesystem;

fs::path autosaveFolder() {
  return stateFolder() / "autosave";
}

/// What is reported of a part goes from `from` to `to` of the whole.
Context part(const Context& whole, double from, double to) {
  Context context = whole;
  context.progress = [&whole, from, to](std::string_view what, double fraction) {
    whole.report(what, from + fraction * (to - from));
  };
  return context;
}

/// A head's own document; `head` is read on the way.
Result<Scene> sceneOf(const fs::path& path, const std::string& style, LoadedHead& head,
                      const Context& context) {
  if (path.extension() == ".coif") return loadScene(path);
  COIF_ASSIGN(head, loadHead(fs::absolute(path), part(context, 0, 0.4)));
  const Surface& surface = *head.surface;
  context.report("finding the scalp", 0.4);
  COIF_ASSIGN(const Region region, automaticCap(surface));
  if (context.cancelled()) return makeError(ErrorCode::Cancelled, "the head was not opened");
  CageOptions options;
  if (!style.empty()) options.count = int(suggestedCageCount(style));
  COIF_ASSIGN(const Cage cage, buildCage(surface.mesh(), surface, region, options, part(context, 0.55, 1)));
  COIF_ASSIGN(Hairstyle hairstyle,
              style.empty() ? bareRoots(cage) : modelHairstyle(style, cage, surface, context));
  COIF_ASSIGN(Scene scene, sceneOnHead(path, surface.mesh(), cage, std::move(hairstyle)));
  scene.name = style.empty() ? path.stem().string() : style;
  return scene;
}

}  // namespace

fs::path stateFolder() {
  if (const char* state = std::getenv("XDG_STATE_HOME"); state != nullptr && *state != 0)
    return fs::path(state) / "coif";
  const char* home = std::getenv("HOME");
  return fs::path(home != nullptr ? home : "/tmp") / ".local/state/coif";
}

Document::Document(Scene scene) : editor(std::move(scene)) {
  key_ = std::to_string(::getpid()) + "-" +
         std::to_string(std::chrono::steady_clock::now().time_since_epoch().count());
}

Result<std::unique_ptr<Document>> Document::open(const fs::path& path, const std::string& style,
                                                 const Context& context) {
  LoadedHead head;
  auto made = sceneOf(path, style, head, context);
  if (!made.ok()) return inFile(made.error(), path.string());
  std::unique_ptr<Document> document(new Document(std::move(*made)));
  if (path.extension() == ".coif") document->path = path;
  COIF_TRY(document->takeHead(std::move(head), context));
  return document;
}

Result<std::unique_ptr<Document>> Document::openExample(const Context& context) {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  const fs::path shipped = program.parent_path().parent_path() / "share/coif/example/bob.coif";
  if (fs::exists(shipped, error)) {
    COIF_ASSIGN(std::unique_ptr<Document> document, open(shipped, "", context));
    document->path.clear();
    return document;
  }
  const fs::path head = stateFolder() / "example-head.obj";
  if (!fs::exists(head, error)) {
    fs::create_directories(stateFolder(), error);
    COIF_TRY(savePolygonMesh(makeExampleHead(), head));
  }
  return open(head, "bob", context);
}

Status Document::takeHead(LoadedHead read, const Context& context) {
  head_ = std::move(read);
  if (!head_.surface && !editor.scene().head.path.empty()) {
    auto loaded = loadHead(editor.scene().headPath(), context);
    if (!loaded.ok() && loaded.error().code == ErrorCode::Cancelled) return loaded.error();
    if (loaded.ok()) head_ = std::move(*loaded);
    if (!loaded.ok()) headProblem = "the head could not be read: " + loaded.error().text();
  }
  if (head_.surface) headBox_ = bounds(head_.surface->mesh().positions);
  editor.setHead(head_.surface.get());
  return {};
}

std::string Document::title() const {
  const std::string name = path.empty() ? editor.scene().name + " (not saved yet)" : path.filename().string();
  return (editor.modified() ? "*" : "") + name;
}

Status Document::save(const fs::path& to) {
  COIF_TRY(editor.save(to));
  path = to;
  forgetAutosave();
  return {};
}

fs::path Document::autosavePath() const {
  return autosaveFolder() / (key_ + ".coif");
}

Status Document::autosave() {
  if (!needsAutosave()) return {};
  std::error_code ignored;
  fs::create_directories(autosaveFolder(), ignored);
  // A copy: saving a document moves its relative head path along, and marks it as saved.
  Scene copy = editor.scene();
  copy.head.path = copy.head.path.empty() ? copy.head.path : editor.scene().headPath();
  // What it is a copy of comes first: a crash between the two leaves no copy without a name.
  const std::string origin = path.empty() ? std::string() : fs::absolute(path).string();
  COIF_ASSIGN(auto file, SafeFile::create(autosavePath().string() + ".json"));
  const std::string text = nlohmann::json{{"original", origin}}.dump();
  file.write(text);
  COIF_TRY(file.commit());
  COIF_TRY(saveScene(copy, autosavePath()));
  autosavedRevision_ = editor.revision();
  return {};
}

void Document::forgetAutosave() {
  std::error_code ignored;
  fs::remove(autosavePath(), ignored);
  fs::remove(autosavePath().string() + ".json", ignored);
  autosavedRevision_ = editor.revision();
}

std::vector<fs::path> Document::leftBehind() {
  std::vector<std::pair<fs::file_time_type, fs::path>> found;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(autosaveFolder(), error)) {
    if (entry.path().extension() != ".coif") continue;
    // Named by the process that wrote it: one that still runs is not a crash.
    const long process = std::strtol(entry.path().filename().c_str(), nullptr, 10);
    if (fs::exists("/proc/" + std::to_string(process))) continue;
    found.push_back({entry.last_write_time(error), entry.path()});
  }
  std::ranges::sort(found, std::greater());
  std::vector<fs::path> paths;
  for (const auto& [time, path] : found) paths.push_back(path);
  return paths;
}

Result<std::unique_ptr<Document>> Document::recover(const fs::path& autosave, const Context& context) {
  COIF_ASSIGN(std::unique_ptr<Document> document, open(autosave, "", context));
  document->path.clear();
  if (const auto bytes = readFile(autosave.string() + ".json"); bytes.ok()) {
    const auto json =
        nlohmann::json::parse(reinterpret_cast<const char*>(bytes->data()),
                              reinterpret_cast<const char*>(bytes->data()) + bytes->size(), nullptr, false);
    if (json.is_object() && json.contains("original") && json["original"].is_string()) {
      document->path = json["original"].get<std::string>();
    }
  }
  document->editor.markModified();
  // The copy stays until there is a newer one, now under this process's name.
  std::error_code ignored;
  fs::rename(autosave, document->autosavePath(), ignored);
  fs::rename(autosave.string() + ".json", document->autosavePath().string() + ".json", ignored);
  return document;
}

}  // namespace coif::studio
