#include "coif/scene/evaluate.h"

#include <algorithm>
#include <bit>

#include "coif/base/random.h"
#include "coif/hairmesh/invariants.h"
#include "coif/io/mesh_io.h"
#include "coif/io/skin_io.h"
#include "scene/evaluation_impl.h"

namespace coif {

namespace {

std::uint64_t hashDouble(std::uint64_t hash, double value) {
  return hashCombine(hash, std::bit_cast<std::uint64_t>(value));
}

std::uint64_t hashStrands(const StrandSettings& s, std::uint64_t mesh, std::uint64_t head,
                          double metersPerUnit) {
  std::uint64_t hash = hashCombine(mesh, head);
  for (std::uint64_t value :
       {std::uint64_t(s.count), std::uint64_t(s.points), s.seed, std::uint64_t(s.knots)}) {
    hash = hashCombine(hash, value);
  }
  for (double value : {s.tolerance, s.width, s.tipWidth, metersPerUnit}) hash = hashDouble(hash, value);
  return hash;
}

std::uint64_t meshBytes(const HairMesh& mesh) {
  std::uint64_t bytes =
      mesh.vertices().size() * sizeof(HairVertex) + mesh.splits().size() * sizeof(EdgeSplit);
  for (const Bundle& bundle : mesh.bundles()) bytes += sizeof(Bundle) + bundle.vertices.size() * 4;
  return bytes;
}

std::uint64_t meshBytes(const PolygonMesh& mesh) {
  return mesh.positions.size() * sizeof(Vec3) + (mesh.corners.size() + mesh.faceOffsets.size()) * 4 +
         mesh.cornerUvs.size() * sizeof(Vec2);
}

std::string countText(std::size_t count, const char* what) {
  return std::to_string(count) + " " + what;
}

}  // namespace

GrowOptions growOptions(const Scene& scene, const Surface* head) {
  const StrandSettings& s = scene.strands;
  GrowOptions out;
  out.count = s.count;
  out.points = s.points;
  if (s.tolerance > 0) out.tolerance = s.tolerance;
  out.seed = s.seed;
  out.knots = s.knots;
  out.width = s.width;
  out.tipWidth = s.tipWidth;
  out.metersPerUnit = scene.metersPerUnit;
  out.upAxis = scene.upAxis;
  out.head = head;
  return out;
}

Result<LoadedHead> loadHead(const std::filesystem::path& path, const Context& context) {
  context.report("reading the head", 0);
  COIF_ASSIGN(PolygonMesh mesh, loadPolygonMesh(path));
  LoadedHead head{nullptr, path, 0};
  COIF_ASSIGN(head.hash, fileHash(path));
  COIF_ASSIGN(Surface surface, Surface::create(std::move(mesh), context));
  head.surface = std::make_shared<const Surface>(std::move(surface));
  return head;
}

Evaluation::Evaluation(EvaluateOptions options) : impl_(std::make_unique<Impl>()) {
  impl_->options = std::move(options);
}
Evaluation::~Evaluation() = default;
Evaluation::Evaluation(Evaluation&&) noexcept = default;

Status Evaluation::Impl::loadHead(const Scene& scene, const Context& context) {
  if (!options.useHead) {
    head.reset();
    add("head", StageState::Skipped, "switched off: roots stay on the cage");
    return {};
  }
  const std::filesystem::path path = scene.headPath();
  if (head && headHeld && path.lexically_normal() == headPath.lexically_normal()) {
    add("head", StageState::Reused, "it was given", 0, meshBytes(head->mesh()));
    return {};
  }
  std::error_code unknown;
  const auto time = std::filesystem::last_write_time(path, unknown);
  if (head && path == headPath && time == headTime && !forced("head")) {
    add("head", StageState::Reused, "the same file", 0, meshBytes(head->mesh()));
    return {};
  }
  if (path.empty()) {
    return makeError(ErrorCode::NotFound, "the scene names no head; give it one or leave the head out",
                     "head.path", scene.file.string());
  }
  const Stopwatch watch;
  auto loaded = coif::loadHead(path, context);
  if (!loaded.ok()) {
    Error error = loaded.error();
    if (error.code == ErrorCode::NotFound) error.message = "the head that the scene refers to is not there";
    return inFile(error, path.string());
  }
  head = std::move(loaded->surface), headHash = loaded->hash;
  headPath = path;
  headTime = time;
  headHeld = false;
  StageReport& report =
      add("head", StageState::Ran, "strand roots lie on it", watch.seconds(), meshBytes(head->mesh()));
  report.notes.push_back(countText(head->mesh().faceCount(), "polygons"));
  if (scene.head.contentHash != 0 && scene.head.contentHash != headHash) {
    report.notes.push_back("the file changed since the hair mesh was laid on it");
  }
  return {};
}

Status Evaluation::Impl::check(const Scene& scene) {
  const std::uint64_t hash = meshHash(scene.hairMesh);
  if (checkedHash == hash && !forced("check")) {
    add("check", StageState::Reused, "the hair mesh did not change");
    return {};
  }
  const Stopwatch watch;
  const auto faults = checkInvariants(scene.hairMesh);
  if (!faults.empty()) {
    return makeError(ErrorCode::Degenerate, faults[0].name + ": " + faults[0].message, faults[0].element,
                     scene.file.string());
  }
  checkedHash = hash;
  add("check", StageState::Ran, "the hair mesh is new", watch.seconds());
  return {};
}

Status Evaluation::Impl::runPlace(const Scene& scene, const Context& context) {
  const std::uint64_t key = meshHash(scene.hairMesh);
  if (placeKey == key && !forced("place")) {
    add("place", StageState::Reused, "no vertex moved", 0, meshBytes(placed));
    return {};
  }
  if (scene.placedHash == key && !forced("place")) {
    placed = scene.hairMesh;
    placeKey = placedHash = key;
    add("place", StageState::Skipped, "nothing moved since the scene's last placement", 0, meshBytes(placed));
    return {};
  }
  const Stopwatch watch;
  context.report("placing internal vertices", 0);
  HairMesh mesh = scene.hairMesh;
  COIF_ASSIGN(placeReport, place(mesh, options.place, context));
  placed = std::move(mesh);
  placeKey = key;
  placedHash = meshHash(placed);
  StageReport& report =
      add("place", StageState::Ran, "the hair mesh is new or moved", watch.seconds(), meshBytes(placed));
  report.error = placeReport->error;
  report.notes.push_back(countText(placeReport->unknowns, "internal vertices, ") +
                         countText(std::size_t(placeReport->iterations), "iterations"));
  if (!placeReport->converged) report.notes.push_back("the solver stopped before it reached its tolerance");
  return {};
}

std::uint64_t Evaluation::Impl::strandsKeyOf(const Scene& scene) const {
  return hashStrands(scene.strands, placedHash, head ? hashCombine(1, headHash) : 0, scene.metersPerUnit);
}

Status Evaluation::Impl::growStrands(const Scene& scene, const Context& context) {
  const std::uint64_t key = strandsKeyOf(scene);
  if (strandsKey == key && !forced("strands")) {
    add("strands", StageState::Reused, "neither mesh, head nor settings changed", 0, grown.strands.bytes());
    return {};
  }
  const Stopwatch watch;
  context.report("growing strands", 0);
  strandsKey.reset();
  grown = {};
  COIF_ASSIGN(grown, grow(placed, growOptions(scene, head.get()), context));
  strandsKey = key;
  StageReport& report = add("strands", StageState::Ran, "mesh, head or settings are new", watch.seconds(),
                            grown.strands.bytes());
  report.error = grown.report.error;
  report.notes.push_back(countText(grown.strands.strandCount(), "strands, ") +
                         countText(grown.strands.pointCount(), "points"));
  if (grown.report.negativeWeights)
    report.notes.push_back(
        countText(grown.report.negativeWeights, "strands have negative weights (concave root faces)"));
  if (grown.report.barrenBundles)
    report.notes.push_back(countText(grown.report.barrenBundles, "bundles carry no strands"));
  if (grown.report.zeroLength)
    report.notes.push_back(countText(grown.report.zeroLength, "strands of no length left out"));
  return {};
}

Result<Evaluation::Impl::Skin> Evaluation::Impl::skinFor(const std::filesystem::path& output,
                                                         const Context& context) const {
  Skin skin;
  const std::string extension = output.extension().string();
  if (!head || !(extension == ".usd" || extension == ".usda" || extension == ".usdc")) return skin;
  auto binding = loadSkinBinding(headPath);
  if (!binding.ok()) {
    skin.notes.push_back("the head's binding to a skeleton is left out: " + binding.error().text());
    return skin;
  }
  if (!*binding) return skin;
  COIF_ASSIGN(skin.binding, skinHair(std::move(**binding), *head, placed, grown.strands, context));
  skin.notes.push_back("bound to the skeleton " + skin.binding->head.skeleton + ", as the head is");
  return skin;
}

void Evaluation::holdHead(LoadedHead head) {
  if (head.surface == nullptr) return;
  impl_->head = std::move(head.surface), impl_->headHash = head.hash;
  impl_->headPath = std::move(head.path);
  impl_->headHeld = true;
}

Result<const Surface*> Evaluation::head(const Scene& scene, const Context& context) {
  COIF_TRY(impl_->loadHead(scene, context));
  return static_cast<const Surface*>(impl_->head.get());
}

Result<const HairMesh*> Evaluation::placedMesh(const Scene& scene, const Context& context) {
  COIF_TRY(impl_->check(scene));
  COIF_TRY(impl_->runPlace(scene, context));
  return static_cast<const HairMesh*>(&impl_->placed);
}

Result<const StrandSet*> Evaluation::grownStrands(const Scene& scene, const Context& context) {
  COIF_TRY(impl_->loadHead(scene, context));
  COIF_TRY(impl_->check(scene));
  COIF_TRY(impl_->runPlace(scene, context));
  COIF_TRY(impl_->growStrands(scene, context));
  return static_cast<const StrandSet*>(&impl_->grown.strands);
}

Result<const StrandSet*> Evaluation::strands(const Scene& scene, const Context& context) {
  COIF_ASSIGN(const StrandSet* unstyled, grownStrands(scene, context));
  (void)unstyled;
  COIF_TRY(impl_->style(scene, context));
  return &impl_->strands();
}

Result<WriteReport> Evaluation::exportTo(const Scene& scene, const std::filesystem::path& path,
                                         StrandExport what, const Context& context) {
  const std::size_t before = impl_->reports.size();
  COIF_ASSIGN(const StrandSet* set, strands(scene, context));
  // A second file from the same strands repeats nothing, in the report neither.
  const auto idle = [](const StageReport& report) { return report.state != StageState::Ran; };
  if (before > 0 &&
      std::all_of(impl_->reports.begin() + std::ptrdiff_t(before), impl_->reports.end(), idle)) {
    impl_->reports.resize(before);
  }
  what.strands = set;
  what.hairMesh = &impl_->placed;
  what.head = impl_->head ? &impl_->head->mesh() : nullptr;
  what.color = scene.look.hairColor;
  const Stopwatch watch;
  COIF_ASSIGN(const Impl::Skin skin, impl_->skinFor(path, context));
  if (what.skin == nullptr && skin.binding) what.skin = &*skin.binding;
  context.report("writing " + path.filename().string(), 0);
  COIF_ASSIGN(const WriteReport written, saveStrands(what, path, context));
  StageReport& report = impl_->add("export", StageState::Ran, path.filename().string() + " was asked for",
                                   watch.seconds(), written.bytes);
  report.notes = written.notes;
  report.notes.insert(report.notes.end(), skin.notes.begin(), skin.notes.end());
  return written;
}

const std::vector<StageReport>& Evaluation::reports() const {
  return impl_->reports;
}
void Evaluation::clearReports() {
  impl_->reports.clear();
}
const GrowReport* Evaluation::growReport() const {
  return impl_->strandsKey ? &impl_->grown.report : nullptr;
}
const PlaceReport* Evaluation::placeReport() const {
  return impl_->placeReport ? &*impl_->placeReport : nullptr;
}

}  // namespace coif
