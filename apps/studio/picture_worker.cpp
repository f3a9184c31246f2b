#include "picture_worker.h"

#include <bit>
#include <utility>

#include "coif/base/random.h"

namespace coif::studio {
namespace {

/// What decides which strands grow where, but for where the vertices are.
std::uint64_t topologyHash(const Scene& scene) {
  const HairMesh& mesh = scene.hairMesh;
  std::uint64_t hash = hashCombine(mesh.vertices().size(), mesh.bundles().size());
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
  headShown_ = hairShown_ = false;
  shownTopology_ = 0;
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

Status PictureWorker::updateHair(const PictureRequest& request, const Context& context) {
  if (!request.strands || request.scene->hairMesh.layerCount() < 2) {
    if (std::exchange(hairShown_, false)) session_->clearHair();
    shownTopology_ = 0;
    return {};
  }
  if (hairShown_ && request.revision == shownRevision_) return {};
  const std::uint64_t topology = topologyHash(*request.scene);
  if (!request.scene->styles.empty()) {
    const Trace::Span span(trace_, "style strands");
    Scene shown = *request.scene;
    shown.placedHash = meshHash(shown.hairMesh);  // as it is shown without a style: where it stands
    COIF_ASSIGN(const StrandSet* styled, evaluation_.strands(shown, context));
    COIF_TRY(session_->setStrands(*styled, context));
    hairShown_ = true;
    shownTopology_ = 0;
  } else if (hairShown_ && topology == shownTopology_) {
    std::vector<Vec3> positions;
    for (const HairVertex& vertex : request.scene->hairMesh.vertices()) positions.push_back(vertex.position);
    const Trace::Span span(trace_, "move strands");
    COIF_TRY(session_->moveHair(positions, context));
  } else {
    const Trace::Span span(trace_, "grow strands");
    Scene roots = *request.scene;  // roots and widths are all that the session wants
    roots.strands.points = 2, roots.strands.tolerance = 0;
    COIF_ASSIGN(const StrandSet* strands, evaluation_.grownStrands(roots, context));
    COIF_TRY(session_->setHair(request.scene->hairMesh, *strands, request.scene->strands.knots,
                               request.scene->strands.points, context));
    hairShown_ = true;
    shownTopology_ = topology;
  }
  shownRevision_ = request.revision;
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
  if (request.head && request.surface && (!headShown_ || shownHead_ != request.surface)) {
    COIF_TRY(session_->setHead(request.surface->mesh()));
    headShown_ = true, shownHead_ = request.surface;
  } else if (headShown_ && !(request.head && request.surface)) {
    session_->clearHead();
    headShown_ = false;
  }
  evaluation_.clearReports();
  const Status hair = updateHair(request, context);
  if (!hair.ok()) {
    hairShown_ = false, shownTopology_ = 0;
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
  span.note("hair mesh bytes", double(picture.uploaded.hairMesh));
  span.note("strands", double(picture.strandsDrawn));
  span.note("segments", double(picture.segmentsDrawn));
  if (request.draft) adaptDrafts(picture.seconds);
  out.image = std::move(picture.image);
  out.strandsDrawn = picture.strandsDrawn;
  out.stages = evaluation_.reports();
  out.stages.insert(out.stages.end(), picture.stages.begin(), picture.stages.end());
  return hair;
}

}  // namespace coif::studio
