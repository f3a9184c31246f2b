#include "studio.h"

#include <bit>
#include <chrono>
#include <fstream>

#include "coif/base/random.h"
#include "coif/io/safe_file.h"
#include "coif/scalp/example_head.h"
#include "coif/scene/evaluate.h"

namespace coif::studio {
namespace {

constexpr double kAutosaveSeconds = 30, kFineAfterSeconds = 0.35;
constexpr std::size_t kDraftSegments = 60000;

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

Studio::Studio(Window& window, StudioOptions options)
    : window_(window),
      options_(std::move(options)),
      settings_(Settings::load()),
      trace_(options_.trace),
      pictures_(std::make_unique<PictureWorker>(&Window::wake)),
      leftBehind_(Document::leftBehind()) {
  settings_.lightTheme ? ImGui::StyleColorsLight() : ImGui::StyleColorsDark();
  view_.settings.habit = settings_.mayaMouse ? MouseHabit::Maya : MouseHabit::Blender;
  tourOpen_ = settings_.recent.empty() && options_.open.empty();
  if (!options_.open.empty()) openPath(options_.open, options_.style);
}

Studio::~Studio() = default;

void Studio::say(std::string message, bool problem) {
  message_ = std::move(message);
  messageIsProblem_ = problem;
}

void Studio::run(const std::string& command, const CommandArguments& arguments) {
  if (!document_) return say("open a head or a document first", true);
  const Trace::Span span(trace_, "command");
  const std::size_t before = document_->editor.undoCount();
  if (const Status status = document_->editor.run(command, arguments); !status.ok()) {
    return say(status.error().text(), true);
  }
  const CommandInfo* info = findCommand(command);
  say(info->label);
  if (command == "undo" || command == "redo" || document_->editor.undoCount() > before) {
    if (!options_.pythonLog.empty()) {
      std::ofstream(options_.pythonLog, std::ios::app) << pythonLine(command, arguments) << "\n";
    }
  }
  // A first change is worth a copy at once; later ones wait their turn.
  if (lastAutosave_ == 0) lastAutosave_ = now() - kAutosaveSeconds + 2;
  if (command != "undo" && command != "redo") lastCommand_ = command, lastArguments_ = arguments;
}

void Studio::openPath(const std::filesystem::path& path, const std::string& style) {
  if (opening_.valid()) return say("a file is being opened already", true);
  openingName_ = path.filename().string();
  opening_ = std::async(std::launch::async, [path, style] {
    auto made = Document::open(path, style, {});
    Window::wake();
    return made;
  });
}

void Studio::adopt(std::unique_ptr<Document> document) {
  document_ = std::move(document);
  tool_.reset(), attempt_.reset();
  lastCommand_.clear();
  const Scene& scene = document_->editor.scene();
  view_.upAxis = scene.upAxis;
  Box box{Vec3::Zero(), Vec3::Ones()};
  std::vector<Vec3> points;
  for (const HairVertex& vertex : scene.hairMesh.vertices()) points.push_back(vertex.position);
  if (!points.empty()) box = bounds(points);
  view_.camera = frameBox(box, scene.upAxis, scene.look.azimuthDeg, scene.look.elevationDeg, view_.aspect());
  if (!document_->headProblem.empty()) {
    say(document_->headProblem, true);
  } else {
    say("opened " + document_->title());
  }
  if (!document_->path.empty()) {
    settings_.addRecent(document_->path);
    (void)settings_.save();
  }
}

void Studio::saveTo(const std::filesystem::path& path) {
  if (!document_) return;
  if (const Status status = document_->save(path); !status.ok()) return say(status.error().text(), true);
  settings_.addRecent(path);
  (void)settings_.save();
  say("saved " + path.string());
}

void Studio::exportTo(const std::filesystem::path& path) {
  if (!document_) return;
  Evaluation evaluation;
  const auto report = evaluation.exportTo(document_->editor.scene(), path);
  if (!report.ok()) return say(report.error().text(), true);
  say("exported " + path.string());
}

void Studio::autosave() {
  if (!document_ || !document_->editor.modified()) return;
  if (now() - lastAutosave_ < kAutosaveSeconds) {
    if (document_->needsAutosave()) window_.wakeWithin(kAutosaveSeconds - (now() - lastAutosave_));
    return;
  }
  lastAutosave_ = now();
  if (const Status status = document_->autosave(); !status.ok())
    say("autosave: " + status.error().text(), true);
}

bool Studio::mayClose() {
  if (document_ && document_->editor.modified()) {
    closeAsked_ = true;
    return false;
  }
  if (document_) document_->forgetAutosave();
  return true;
}

void Studio::askForPicture(bool moving) {
  if (!document_ || view_.width() < 8 || view_.height() < 8) return;
  const Editor& editor = document_->editor;
  std::uint64_t key =
      hashCombine(editor.revision(), std::uint64_t(view_.width()) * 65536 + std::uint64_t(view_.height()));
  key = hashCombine(key, (view_.settings.showStrands ? 1u : 0u) + (view_.settings.showHead ? 2u : 0u));
  for (const Vec3& v : {view_.camera.eye, view_.camera.target, Vec3(view_.camera.fovDeg, 0, 0)}) {
    for (double x : v) key = hashCombine(key, std::bit_cast<std::uint64_t>(x));
  }
  if (attempt_) key = hashCombine(key, meshHash(*attempt_));
  const bool changed = key != askedKey_;
  if (changed) askedKey_ = key, lastChange_ = now(), fine_ = false;
  const bool rested = !moving && !fine_ && !pictures_->busy() && now() - lastChange_ > kFineAfterSeconds;
  if (!fine_ && !rested) window_.wakeWithin(kFineAfterSeconds);
  if (!changed && !rested) return;

  PictureRequest request;
  auto scene = std::make_shared<Scene>(editor.scene());
  if (attempt_) scene->hairMesh = *attempt_;
  request.revision = attempt_ ? key : editor.revision();
  request.scene = std::move(scene);
  request.camera = view_.camera;
  request.surface = document_->head;
  request.strands = view_.settings.showStrands;
  request.head = view_.settings.showHead;
  PreviewOptions& options = request.options;
  const int reduce = rested ? 1 : 2;  // a draft first, the fine picture once all is at rest
  options.width = std::max(view_.width() / reduce, 8);
  options.height = std::max(view_.height() / reduce, 8);
  options.subframes = rested ? 3 : 1;
  options.maxSegments = rested ? 0 : kDraftSegments;
  options.hairColor = editor.state().look.hairColor;
  if (rested) fine_ = true;
  pictures_->ask(std::move(request));
}

void Studio::takePictures() {
  auto answer = pictures_->take();
  if (!answer) return;
  const Trace::Span span(trace_, "upload picture");
  if (!answer->problem.empty()) say(answer->problem, true);
  if (answer->image.width > 0) window_.canvas().upload(answer->image);
  stages_ = std::move(answer->stages);
  pictureSeconds_ = answer->seconds;
  strandsDrawn_ = answer->strandsDrawn;
}

void Studio::takeKeys() {
  if (ImGui::GetIO().WantTextInput || tool_) return;
  if (window_.keys().pressed("F3") || window_.keys().pressed("Ctrl+Space"))
    paletteOpen_ = true, paletteText_.clear();
  if (window_.keys().pressed("Ctrl+O")) askPath(PathUse::Open);
  if (window_.keys().pressed("Ctrl+S"))
    document_ && !document_->path.empty() ? saveTo(document_->path) : askPath(PathUse::SaveAs);
  if (window_.keys().pressed("Ctrl+Shift+E")) askPath(PathUse::Export);
  if (window_.keys().pressed("F12")) askPath(PathUse::Screenshot);
  if (window_.keys().pressed("1")) view_.settings.kind = SelectKind::Vertex;
  if (window_.keys().pressed("2")) view_.settings.kind = SelectKind::Edge;
  if (window_.keys().pressed("3")) view_.settings.kind = SelectKind::Face;
  if (window_.keys().pressed("Home") && document_) view_.frame(document_->editor.mesh(), {});
  if (window_.keys().pressed("F") && document_)
    view_.frame(document_->editor.mesh(), document_->editor.state().selection);
  if (window_.keys().pressed("Z")) view_.settings.mesh = MeshStyle((int(view_.settings.mesh) + 1) % 3);
  if (!document_ || !view_.screen()) return;
  using Kind = ModalTool::Kind;
  for (const auto& [command, kind] : {std::pair("translate", Kind::Move), std::pair("rotate", Kind::Rotate),
                                      std::pair("scale", Kind::Scale), std::pair("extrude", Kind::Extrude)}) {
    if (!window_.keys().pressed(settings_.keyOf(command))) continue;
    if (document_->editor.state().selection.empty()) return say("select something first", true);
    tool_.emplace(kind, document_->editor, view_, softRadius_);
    return;
  }
  for (const CommandInfo& info : commandInfos()) {
    const std::string key = settings_.keyOf(info.name);
    if (key.empty() || !window_.keys().pressed(key)) continue;
    CommandArguments arguments;
    for (const CommandArgument& argument : info.arguments) {
      if (argument.name != "kind") continue;
      arguments["kind"] = argument.choices[std::size_t(view_.settings.kind)];
    }
    return run(info.name, arguments);
  }
}

void Studio::takeTools() {
  if (!document_ || !view_.screen()) return;
  if (tool_) {
    const Trace::Span span(trace_, "drag");
    tool_->update(view_, window_.keys());
    const CommandArguments arguments = tool_->arguments(view_);
    if (tool_->dropped()) {
      tool_.reset(), attempt_.reset();
    } else if (tool_->confirmed()) {
      const std::string command = tool_->command();
      tool_.reset(), attempt_.reset();
      run(command, arguments);
    } else {
      auto attempt = document_->editor.attempt(tool_->command(), arguments);
      if (attempt.ok()) {
        attempt_ = std::move(*attempt);
      } else {
        say(attempt.error().text(), true);
      }
    }
    return;
  }
  if (const auto arguments = select_.update(view_)) run("select", *arguments);
}

bool Studio::frame() {
  const Trace::Span span(trace_, "frame");
  if (opening_.valid() && opening_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    auto made = opening_.get();
    made.ok() ? adopt(std::move(*made)) : say(made.error().text(), true);
  }
  for (const std::string& path : window_.takeDropped()) openPath(path, options_.style);
  takePictures();
  drawMenus();
  drawPanels();
  const bool moving = view_.navigate();
  if (document_) {
    const Editor& editor = document_->editor;
    const HairMesh& shown = attempt_ ? *attempt_ : editor.mesh();
    {
      const Trace::Span mesh(trace_, "project mesh");
      view_.update(shown, attempt_ ? meshHash(shown) : editor.revision(), editor.state(),
                   document_->head.get());
    }
    takeKeys();
    takeTools();
    if (document_) {  // a key may have opened another
      const HairMesh& now = attempt_ ? *attempt_ : document_->editor.mesh();
      view_.update(now, attempt_ ? meshHash(now) : document_->editor.revision(), document_->editor.state(),
                   document_->head.get());
      view_.drawPicture(window_.canvas().texture());
      EditState state = document_->editor.state();
      if (attempt_) state.selection = keepValid(now, state.selection);
      const Trace::Span draw(trace_, "draw mesh");
      view_.drawMesh(now, state);
      select_.draw(view_);
    }
  } else {
    takeKeys();
  }
  askForPicture(moving || tool_.has_value());
  drawPalette();
  drawPathDialog();
  drawRecoveryDialog();
  drawCloseDialog();
  drawTour();
  autosave();
  window_.setTitle((document_ ? document_->title() + " – " : std::string()) + "Coif Studio");
  return !quit_;
}

}  // namespace coif::studio
