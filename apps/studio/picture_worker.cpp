#include "picture_worker.h"

#include <bit>
#include <utility>

#include "coif/base/random.h"

namespace coif::studio {
namespace {

/// What decides which strands grow where, but for where the vertices are.
std::uint64_t topologyHash(const PictureRequest& request) {
  const Scene& scene = *request.scene;
  const HairMesh& mesh = scene.hairMesh;
  std::uint64_t hash = hashCombine(mesh.vertices().size(), mesh.bundles().size());
  hash = hashCombine(hash, request.loaded.hash);
  const StrandSettings& s = scene.strands;
  for (std::uint64_t value : {std::uint64_t(s.count), std::uint64_t(s.points), s.seed, std::uint64_t(s.knots),
                              std::uint64_t(s.width * 1e9), std::uint64_t(s.tipWidth * 1e9)}) {
    hash = hashCombine(hash, value);
  }
  for (const HairVertex& vertex : mesh.vertices()) hash = hashCombine(hash, std::uint32_t(vertex.id));
  for (const Bundle& bundle : mesh.bundles()) {
    for (std::uint32_t v : bundle.vertices) hash = hashCombine(hash, v);
    // Moving the root layer moves the roots on the head: then they grow again.
    for (std::uint32_t v : bundle.face(0)) {
      for (double x : mesh.position(v)) hash = hashCombine(hash, std::bit_cast<std::uint64_t>(x));
    }
  }
  return hash;
}

std::vector<Vec3> positionsOf(const PictureRequest& request) {
  if (!request.moved.empty()) return request.moved;
  std::vector<Vec3> positions;
  for (const HairVertex& vertex : request.scene->hairMesh.vertices()) positions.push_back(vertex.position);
  return positions;
}

}  // namespace

PictureWorker::PictureWorker(std::function<void()> ready, Trace& trace)
    : ready_(std::move(ready)), trace_(trace), thread_([this] { loop(); }) {}

PictureWorker::~PictureWorker() {
  {
    const std::scoped_lock lock(mutex_);
    stop_ = true;
    cancel_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void PictureWorker::ask(PictureRequest request) {
  {
    const std::scoped_lock lock(mutex_);
    wanted_ = std::move(request);
    busy_ = true;
    if (!draftRuns_) cancel_ = true;
  }
  wake_.notify_all();
}

std::optional<PictureAnswer> PictureWorker::take() {
  const std::scoped_lock lock(mutex_);
  return std::exchange(done_, std::nullopt);
}

void PictureWorker::loop() {
  (void)openPreview();  // while the first document is read; the first request says what is wrong with it
  while (true) {
    PictureRequest request;
    {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, [&] { return stop_ || wanted_.has_value(); });
      if (stop_) break;
      request = std::move(*wanted_);
      wanted_.reset();
      cancel_ = false;
      draftRuns_ = request.draft;
    }
    PictureAnswer made = answer(request);
    {
      const std::scoped_lock lock(mutex_);
      draftRuns_ = false;
      if (!wanted_) busy_ = false;
      if (!cancel_) done_ = std::move(made);
    }
    ready_();
  }
  session_.reset();
  preview_.reset();
}

Status PictureWorker::openPreview() {
  if (preview_) return {};
  const Trace::Span span(trace_, "open the preview");
  COIF_ASSIGN(Preview made, Preview::create());
  preview_.emplace(std::move(made));
  session_ = std::make_unique<PreviewSession>(*preview_);
  return {};
}

void PictureWorker::forgetPreview() {
  session_.reset();
  preview_.reset();
  shownHead_.reset();
  headShown_ = false;
  shown_.reset();
}

PictureAnswer PictureWorker::answer(const PictureRequest& request) {
  const Stopwatch watch;
  PictureAnswer out;
  out.camera = request.camera;
  const auto failed = [](const Status& s) { return !s.ok() && s.error().code == ErrorCode::Unsupported; };
  if (lost_.exchange(false)) forgetPreview();
  // A driver that fails, or a context that is lost, is left for a new one: all that it showed is kept here.
  const bool had = preview_.has_value();
  Status status = show(request, out);
  if (failed(status)) forgetPreview();
  if (failed(status) && had) status = show(request, out);
  if (failed(status)) forgetPreview();
  if (!status.ok()) out.problem = status.error().text();
  out.seconds = watch.seconds();
  return out;
}

/// Strands that only moved follow on the GPU, with the style that was planned for them. A fine picture shows
/// what would be exported: all of them, planned on the mesh at rest.
Status PictureWorker::updateHair(const PictureRequest& request, const Context& context) {
  const Scene& scene = *request.scene;
  if (!request.strands || scene.hairMesh.layerCount() < 2) {
    if (shown_) session_->clearHair();
    shown_.reset();
    return {};
  }
  const std::uint64_t topology = topologyHash(request);
  const bool same = shown_ && shown_->topology == topology && shown_->styles == scene.styles;
  const bool good = same && (request.draft || scene.styles.empty() ||
                             (shown_->whole && shown_->planned == meshHash(scene.hairMesh)));
  if (good && request.revision == shownRevision_) return {};
  if (!good) COIF_TRY(growHair(request, topology, context));
  if (good || !request.moved.empty()) {
    const Trace::Span span(trace_, "move strands");
    COIF_TRY(session_->moveHair(positionsOf(request), context));
  }
  shownRevision_ = request.revision;
  return {};
}

/// A draft of a new style takes a few strands, the first in their order, as wide as all together.
Status PictureWorker::growHair(const PictureRequest& request, std::uint64_t topology,
                               const Context& context) {
  Trace::Span span(trace_, "grow strands");
  constexpr std::size_t kFewest = 4096;
  Scene scene = *request.scene;
  scene.placedHash = meshHash(scene.hairMesh);  // it is shown where it stands
  const bool styled = !scene.styles.empty();
  StrandSettings& s = scene.strands;
  const std::size_t count = s.count, points = std::max<std::size_t>(s.points, 2);
  s.tolerance = 0;            // a style is laid on fixed points
  if (!styled) s.points = 2;  // roots and widths are all that the session wants
  if (styled && request.draft) {
    std::size_t few = kFewest;
    while (few < count && few * (points - 1) < 2 * draftSegments_) few *= 2;
    s.count = std::min(few, count);
  }
  shown_.reset();
  Evaluation& evaluation = s.count == count ? evaluation_ : drafts_;
  COIF_ASSIGN(const StrandSet* grown, evaluation.grownStrands(scene, context));
  StrandSet widened;
  if (s.count != count) {
    widened = *grown;
    for (float& width : widened.widths) width *= float(double(count) / double(s.count));
  }
  COIF_TRY(session_->setHair(scene.hairMesh, s.count == count ? *grown : widened, s.knots,
                             std::uint32_t(points), context));
  if (styled) {
    const Trace::Span planning(trace_, "plan style");
    COIF_ASSIGN([[maybe_unused]] const StrandSet* strands, evaluation.strands(scene, context));
    const StylePlan* plan = evaluation.stylePlan();
    COIF_TRY(session_->setStyle(plan != nullptr ? plan->view() : StrandStyle{}, context));
  }
  span.note("strands", double(s.count));
  shown_ = Shown{topology, scene.placedHash, scene.styles, s.count == count};
  return {};
}

/// In steps of two, and not back and forth: other detail means other shadow maps.
void PictureWorker::adaptDrafts(double seconds) {
  constexpr double kWanted = 0.12;
  constexpr std::size_t kLeast = 7500, kMost = 4000000;
  if (seconds > 1.6 * kWanted && draftSegments_ > kLeast) draftSegments_ /= 2;
  if (seconds < 0.4 * kWanted && draftSegments_ < kMost) draftSegments_ *= 2;
}

Status PictureWorker::show(const PictureRequest& request, PictureAnswer& out) {
  Context context;
  context.cancel = &cancel_;
  COIF_TRY(openPreview());
  if (request.head && request.loaded.surface && (!headShown_ || shownHead_ != request.loaded.surface)) {
    COIF_TRY(session_->setHead(request.loaded.surface->mesh()));
    headShown_ = true, shownHead_ = request.loaded.surface;
  } else if (headShown_ && !(request.head && request.loaded.surface)) {
    session_->clearHead();
    headShown_ = false;
  }
  for (Evaluation* evaluation : {&evaluation_, &drafts_}) {
    evaluation->clearReports();
    evaluation->holdHead(request.loaded);
  }
  const Status hair = updateHair(request, context);
  if (!hair.ok()) {
    shown_.reset();
    session_->clearHair();
    if (hair.error().code == ErrorCode::Cancelled) return hair;
  }
  session_->setCamera(request.camera);
  session_->setLights(request.lights);
  Trace::Span span(trace_, request.draft ? "draft picture" : "fine picture");
  PreviewOptions options = request.options;
  if (request.draft) {
    options.maxSegments = draftSegments_;
    // Without a GPU the layered shadow map alone would take longer than the rest of a draft.
    if (preview_->software()) options.visibility.method = VisibilityMethod::LightMap;
    // The very first picture waits for as few shaders as can be.
    options.shadows = options.shadows && anythingShown_;
    anythingShown_ = true;
  }
  options.measure = trace_.on();
  COIF_ASSIGN(Picture picture, session_->render(options, context));
  for (const StageReport& stage : picture.stages) span.note(stage.name + " ms", 1e3 * stage.seconds);
  span.note("strand bytes", double(picture.uploaded.strands));
  span.note("style bytes", double(picture.uploaded.style));
  span.note("hair mesh bytes", double(picture.uploaded.hairMesh));
  span.note("strands", double(picture.strandsDrawn));
  span.note("segments", double(picture.segmentsDrawn));
  if (request.draft) adaptDrafts(picture.seconds);
  out.image = std::move(picture.image);
  out.strandsDrawn = picture.strandsDrawn;
  out.stages = evaluation_.reports().empty() ? drafts_.reports() : evaluation_.reports();
  out.stages.insert(out.stages.end(), picture.stages.begin(), picture.stages.end());
  return hair;
}

}  // namespace coif::studio
