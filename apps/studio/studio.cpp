#include "studio.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <fstream>

#include "coif/base/random.h"
#include "coif/io/safe_file.h"
#include "coif/scalp/example_head.h"
#include "coif/scene/evaluate.h"
#include "coif/scene/seen_from_head.h"

namespace coif::studio {
namespace {

constexpr double kAutosaveSeconds = 30, kFineAfterSeconds = 0.35, kNoteSeconds = 4, kTellAfterSeconds = 0.5;
constexpr double kPatienceSeconds = 0.2;  // for a command, before the window goes on without it

/// 1, 2 or 5 times a power of ten, about as large.
double niceStep(double size) {
  const double power = std::pow(10, std::floor(std::log10(std::max(size, 1e-12))));
  return size < 2 * power ? power : size < 5 * power ? 2 * power : 5 * power;
}

}  // namespace

double secondsNow() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Studio::Studio(Window& window, StudioOptions options)
    : window_(window),
      options_(std::move(options)),
      settings_(Settings::load()),
      trace_(options_.trace, options_.began),
      pictures_(std::make_unique<PictureWorker>(&Window::wake, trace_)),
      leftBehind_(Document::leftBehind()) {
  actions_ = makeActions();
  window_.setTheme(settings_.lightTheme);
  view_.settings.habit = settings_.mayaMouse ? MouseHabit::Maya : MouseHabit::Blender;
  tourOpen_ = !settings_.tourSeen && options_.open.empty();
  if (options_.channel >= 0) channel_ = std::make_unique<Channel>(options_.channel, &Window::wake);
  if (!options_.open.empty()) openPath(options_.open, options_.style);
  if (options_.open.empty() && leftBehind_.empty()) openExample();
}

Studio::~Studio() {
  job_.abandon();  // it may look at the document
}

Status Studio::finish() {
  settings_.window = window_.place();
  (void)settings_.save();  // a folder that cannot be written only forgets the layout
  return trace_.write();
}

void Studio::contextLost() {
  pictures_->loseContext();
  askedKey_ = 0;
  say("the graphics driver was reset: the window was made anew, and nothing of the document is lost");
  if (!document_) return;
  if (const Status status = document_->autosave(); !status.ok())
    say("autosave: " + status.error().text(), true);
}

void Studio::say(std::string message, bool problem) {
  message_ = std::move(message);
  messageIsProblem_ = problem;
  if (problem) note_ = message_, noteUntil_ = secondsNow() + kNoteSeconds;
}

void Studio::run(const std::string& command, const CommandArguments& arguments, const Done& done) {
  const auto over = [this, done](const std::string& problem) {
    if (!problem.empty()) say(problem, true);
    if (done) done(problem);
  };
  if (!document_) return over("open a head or a document first");
  if (waitsForJob()) return over(message_);
  const Trace::Span span(trace_, "command");
  Editor& editor = document_->editor;
  const std::size_t before = editor.undoCount();
  if (command == "undo" || command == "redo") {
    const Status status = editor.run(command, arguments);
    if (status.ok()) ran(command, arguments, before);
    return over(status.ok() ? "" : status.error().text());
  }
  // What is quick is done when this returns; what is not goes on beside the window.
  job_.start(
      findCommand(command) != nullptr ? findCommand(command)->label : command,
      [this, over, &editor, command, arguments, before](const Context& context) -> Job::Finish {
        auto prepared =
            std::make_shared<Result<PreparedCommand>>(editor.prepare(command, arguments, context));
        return [this, over, &editor, command, arguments, before, prepared] {
          if (!prepared->ok()) return over(prepared->error().text());
          const Status taken = editor.commit(std::move(**prepared));
          if (taken.ok()) ran(command, arguments, before);
          over(taken.ok() ? "" : taken.error().text());
        };
      },
      kPatienceSeconds);
}

bool Studio::waitsForJob() {
  if (!job_.busy()) return false;
  say(job_.what() + " is still running: wait, or cancel it", true);
  return true;
}

void Studio::ran(const std::string& command, const CommandArguments& arguments, std::size_t stepsBefore) {
  say(findCommand(command)->label);
  followTour(command);
  if (command == "undo" || command == "redo" || document_->editor.undoCount() > stepsBefore) {
    if (!options_.pythonLog.empty()) {
      std::ofstream(options_.pythonLog, std::ios::app) << pythonLine(command, arguments) << "\n";
    }
  }
  // A first change is worth a copy at once; later ones wait their turn.
  if (lastAutosave_ == 0) lastAutosave_ = secondsNow() - kAutosaveSeconds + 2;
  if (command != "undo" && command != "redo") lastCommand_ = command, lastArguments_ = arguments;
}

void Studio::openPath(const std::filesystem::path& path, const std::string& style) {
  if (waitsForJob()) return;
  job_.start(
      "Opening " + path.filename().string(), [this, path, style](const Context& context) -> Job::Finish {
        const Trace::Span span(trace_, "open");
        auto made = std::make_shared<Result<std::unique_ptr<Document>>>(Document::open(path, style, context));
        return [this, made] { made->ok() ? adopt(std::move(**made)) : say(made->error().text(), true); };
      });
}

void Studio::recover(const std::filesystem::path& autosave) {
  job_.start("Recovering", [this, autosave](const Context& context) -> Job::Finish {
    auto made = std::make_shared<Result<std::unique_ptr<Document>>>(Document::recover(autosave, context));
    return [this, made] { made->ok() ? adopt(std::move(**made)) : say(made->error().text(), true); };
  });
}

void Studio::openExample() {
  job_.start("Opening the example", [this](const Context& context) -> Job::Finish {
    const Trace::Span span(trace_, "open the example");
    auto made = std::make_shared<Result<std::unique_ptr<Document>>>(Document::openExample(context));
    return [this, made] { made->ok() ? adopt(std::move(**made)) : say(made->error().text(), true); };
  });
}

void Studio::adopt(std::unique_ptr<Document> document) {
  document_ = std::move(document);
  ++documentNumber_;
  tool_.reset(), forgetAttempt();
  player_.reset();
  played_.reset(), playedMesh_.reset();
  lastCommand_.clear();
  const Scene& scene = document_->editor.scene();
  view_.upAxis = scene.upAxis;
  Box box{Vec3::Zero(), Vec3::Ones()};
  std::vector<Vec3> points;
  for (const HairVertex& vertex : scene.hairMesh.vertices()) points.push_back(vertex.position);
  if (!points.empty()) box = bounds(points);
  tools_.snap.step = niceStep(0.02 * (box.hi - box.lo).norm());
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
  lastAutosave_ = 0;  // the next change is a first one again
  say("saved " + path.string());
}

void Studio::exportTo(const std::filesystem::path& path) {
  if (!document_ || waitsForJob()) return;
  auto scene = std::make_shared<const Scene>(document_->editor.scene());
  StrandExport what;
  what.mesh = exportMesh_;
  const LoadedHead head = document_->loadedHead();
  job_.start("Exporting " + path.filename().string(),
             [this, scene, path, what, head](const Context& context) -> Job::Finish {
               Evaluation evaluation;
               evaluation.holdHead(head);
               const auto report = evaluation.exportTo(*scene, path, what, context);
               const std::string problem = report.ok() ? "" : report.error().text();
               return [this, path, problem] {
                 problem.empty() ? say("exported " + path.string()) : say(problem, true);
               };
             });
}

void Studio::autosave() {
  if (!document_ || !document_->editor.modified()) return;
  if (secondsNow() - lastAutosave_ < kAutosaveSeconds) {
    if (document_->needsAutosave()) window_.wakeWithin(kAutosaveSeconds - (secondsNow() - lastAutosave_));
    return;
  }
  lastAutosave_ = secondsNow();
  if (const Status status = document_->autosave(); !status.ok())
    say("autosave: " + status.error().text(), true);
}

void Studio::leaveDocument(std::function<void()> then) {
  if (document_ && document_->editor.modified()) {
    leaving_ = std::move(then);
    return;
  }
  if (document_) document_->forgetAutosave();
  then();
}

bool Studio::mayClose() {
  leaveDocument([this] { quit_ = true; });
  return quit_;
}

std::uint64_t Studio::shownRevision() const {
  const std::uint64_t state = attempt_ ? attemptNumber_ : played_ ? hashCombine(played_->frame, 1) : 0;
  return hashCombine(hashCombine(documentNumber_, document_->editor.revision()), state);
}

PictureRequest Studio::pictureRequest(bool fine) const {
  const Editor& editor = document_->editor;
  const ViewSettings& s = view_.settings;
  const LookSettings look = shownLook();
  PictureRequest request;
  auto scene = std::make_shared<Scene>(editor.scene());
  if (attempt_) scene->hairMesh = *attempt_;
  if (!attempt_ && played_) request.moved = played_->positions;
  scene->styles = shownStyles();
  request.revision = pendingStyles_ ? hashCombine(shownRevision(), pendingStylesNumber_) : shownRevision();
  request.scene = std::move(scene);
  request.camera = played_ ? cameraFromHead(view_.camera, played_->pose) : view_.camera;
  request.draft = !fine;
  request.loaded = document_->loadedHead();
  request.strands = strandsInPicture();
  request.head = s.showHead && headInPicture();
  request.lights = lightsOf(look.light, editor.scene().upAxis);
  if (played_) request.lights = lightsFromHead(request.lights, played_->pose);
  PreviewOptions& options = request.options;
  const int reduce = fine ? 1 : 2;  // a draft first, the fine picture once all is at rest
  options.width = std::max(view_.width() / reduce, 8);
  options.height = std::max(view_.height() / reduce, 8);
  options.subframes = fine ? 3 : 1;
  options.hairColor = look.hairColor;
  options.fibre = fibreOf(look);
  options.shading = s.shading;
  options.shadows = s.shadows;
  options.transparentBackground = true;  // the studio's own backdrop and grid lie behind
  return request;
}

void Studio::askForPicture(bool moving) {
  if (!document_ || turntable_ || view_.width() < 8 || view_.height() < 8) return;
  std::uint64_t key =
      hashCombine(shownRevision(), std::uint64_t(view_.width()) * 65536 + std::uint64_t(view_.height()));
  const ViewSettings& s = view_.settings;
  const bool head = s.showHead && headInPicture();
  key = hashCombine(key, (strandsInPicture() ? 1u : 0u) + (head ? 2u : 0u) + (s.shadows ? 4u : 0u) +
                             8u * unsigned(s.shading));
  for (const Vec3& v : {view_.camera.eye, view_.camera.target, Vec3(view_.camera.fovDeg, 0, 0)}) {
    for (double x : v) key = hashCombine(key, std::bit_cast<std::uint64_t>(x));
  }
  if (pendingStyles_) key = hashCombine(key, pendingStylesNumber_);
  const LookSettings look = shownLook();
  for (double x : {double(look.hairColor.x()), double(look.hairColor.y()), double(look.hairColor.z()),
                   look.longitudinalRoughness, look.azimuthalRoughness, look.light.azimuthDeg,
                   look.light.elevationDeg, look.light.key, look.light.fill, look.light.rim, look.light.sky,
                   look.light.followCamera ? 1.0 : 0.0}) {
    key = hashCombine(key, std::bit_cast<std::uint64_t>(x));
  }
  const bool changed = key != askedKey_;
  if (changed) askedKey_ = key, lastChange_ = secondsNow(), fine_ = false;
  const Trace::Span span(trace_, "ask for a picture");
  const bool rested =
      !moving && !fine_ && !pictures_->busy() && secondsNow() - lastChange_ > kFineAfterSeconds;
  if (!fine_ && !rested) window_.wakeWithin(kFineAfterSeconds);
  if (!changed && !rested) return;

  PictureRequest request = pictureRequest(rested);
  if (rested) fine_ = true;
  pictures_->ask(std::move(request));
}

void Studio::takePictures() {
  auto answer = pictures_->take();
  if (!answer) return;
  const Trace::Span span(trace_, "upload picture");
  if (turntable_) takeTurntableFrame(*answer);
  if (!answer->problem.empty()) say(answer->problem, true);
  if (answer->image.width > 0) window_.canvas().upload(answer->image);
  stages_ = std::move(answer->stages);
  pictureSeconds_ = answer->seconds;
  strandsDrawn_ = answer->strandsDrawn;
}

void Studio::takeKeys() {
  if (!keyAskedFor_.empty()) return takeNewKey();
  if (ImGui::GetIO().WantTextInput || window_.keys().none()) return;
  if (turntable_ && window_.keys().pressed("Escape")) turntable_.reset(), say("the turntable was stopped");
  for (const MenuEntry& entry : entries()) {
    if (window_.keys().pressed(entry.key)) return carryOut(entry);
  }
}

/// With how far it got what takes its time, as nobody may be looking at the window itself.
std::string Studio::title() const {
  std::string text = document_ ? document_->title() + " – Coif Studio" : "Coif Studio";
  if (!job_.busy() || job_.seconds() < kTellAfterSeconds) return text;
  return std::to_string(int(100 * std::clamp(job_.fraction(), 0.0, 1.0))) + " % – " + text;
}

bool Studio::frame() {
  Trace::Span span(trace_, "frame");
  span.note("drawn before", double(window_.framesDrawn()));
  job_.poll();
  if (const auto dropped = window_.takeDropped(); !dropped.empty())
    leaveDocument([this, path = dropped.front()] { openPath(path, options_.style); });
  takePictures();
  takeMotion();
  takeScripts();
  drawMenus();
  drawPanels();
  const bool moving = view_.navigate(!tool_ || !tool_->usesWheel()) | turnTable();
  if (document_) {
    const auto project = [&] {
      const Trace::Span mesh(trace_, "project mesh");
      view_.update(shownMesh(), shownRevision(), document_->editor.state(), document_->head().get(),
                   tool_ != nullptr || brush_.stroking());
    };
    project();
    if (!takeTools()) takeKeys();
    if (document_) {  // a key may have opened another
      // A head that moves is drawn by a camera that moves the other way.
      const Camera worldCamera = view_.camera;
      if (playedMesh_) view_.camera = cameraFromHead(worldCamera, played_->pose);
      project();
      drawUnderView();
      view_.drawPicture(window_.canvas().texture());
      drawOverView();
      view_.camera = worldCamera;
    }
  } else {
    takeKeys();
  }
  askForPicture(moving || tool_ != nullptr || brush_.stroking());
  drawPalette();
  drawSelectDialog();
  drawPathDialog();
  drawRecoveryDialog();
  drawCloseDialog();
  drawTour();
  drawKeyMap();
  drawExportDialog();
  autosave();
  window_.setTitle(title());
  return !quit_;
}

}  // namespace coif::studio
