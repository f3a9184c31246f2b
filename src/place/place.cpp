#include "coif/place/place.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "place/solve.h"

namespace coif {

namespace {

using placing::Block;

// Largest coordinate whose differences and squares still fit a double with room for sums.
constexpr double kMaxCoordinate = 1e150;

Status checkPositions(const HairMesh& mesh) {
  for (std::size_t v = 0; v < mesh.vertices().size(); ++v) {
    const Vec3& p = mesh.vertices()[v].position;
    const std::string place = "vertex " + std::to_string(v);
    if (!p.allFinite()) return makeError(ErrorCode::Degenerate, "the position is not finite", place);
    if (p.cwiseAbs().maxCoeff() > kMaxCoordinate) {
      return makeError(ErrorCode::Degenerate, "the position is too far out to compute with", place);
    }
  }
  return {};
}

Block positionsOf(const HairMesh& mesh) {
  Block field(Eigen::Index(mesh.vertices().size()), 3);
  for (std::size_t v = 0; v < mesh.vertices().size(); ++v) {
    field.row(Eigen::Index(v)) = mesh.vertices()[v].position.transpose().array();
  }
  return field;
}

double diagonalOf(const Block& field) {
  if (field.rows() == 0) return 0;
  return (field.colwise().maxCoeff() - field.colwise().minCoeff()).matrix().norm();
}

// Distance by which storing a position may move it: half a spacing of doubles in each coordinate.
double storageError(const Block& field) {
  if (field.rows() == 0) return 0;
  const double largest = field.abs().maxCoeff();
  return 0.5 * std::sqrt(3.0) * (std::nextafter(largest, INFINITY) - largest);
}

}  // namespace

double placementEnergy(const HairMesh& mesh) {
  double energy = 0;
  for (const SideQuad& q : sideQuads(mesh)) {
    energy +=
        ((mesh.position(q.c) - mesh.position(q.a)) - (mesh.position(q.d) - mesh.position(q.b))).squaredNorm();
  }
  return energy;
}

struct Placer::Impl {
  explicit Impl(const HairMesh& mesh) : system(mesh), bundles(mesh.bundles().begin(), mesh.bundles().end()) {
    for (const HairVertex& v : mesh.vertices()) pinned.push_back(v.pinned);
  }
  placing::PlaceSystem system;
  PlaceOptions options;
  std::optional<placing::Prepared> prepared;  // none without unknowns
  // What the system was made from: faces fix parents, layers and splits.
  std::vector<Bundle> bundles;
  std::vector<bool> pinned;
};

Placer::Placer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Placer::~Placer() = default;
Placer::Placer(Placer&&) noexcept = default;
Placer& Placer::operator=(Placer&&) noexcept = default;

Result<Placer> Placer::create(const HairMesh& mesh, const PlaceOptions& options, const Context& context) {
  COIF_TRY(placing::checkOptions(options));
  auto impl = std::make_unique<Impl>(mesh);
  impl->options = options;
  if (impl->system.unknowns() > 0) {
    COIF_ASSIGN(placing::Prepared prepared, placing::prepare(mesh, impl->system, options, context));
    impl->prepared.emplace(std::move(prepared));
  }
  return Placer(std::move(impl));
}

bool Placer::fits(const HairMesh& mesh) const {
  const auto vertices = mesh.vertices();
  if (vertices.size() != impl_->pinned.size() || mesh.bundles().size() != impl_->bundles.size()) return false;
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    if (vertices[v].pinned != impl_->pinned[v]) return false;
  }
  return std::ranges::equal(mesh.bundles(), impl_->bundles, [](const Bundle& a, const Bundle& b) {
    return a.corners == b.corners && a.vertices == b.vertices;
  });
}

Result<PlaceReport> Placer::place(HairMesh& mesh, const Context& context) const {
  const Stopwatch watch;
  COIF_TRY(checkPositions(mesh));
  if (!fits(mesh))
    return makeError(ErrorCode::InvalidArgument, "the mesh has another topology or other pins");
  const placing::PlaceSystem& system = impl_->system;
  PlaceReport report;
  report.solver = impl_->options.solver;
  report.unknowns = system.unknowns();
  report.freeComponents = system.freeCount();
  report.energyBefore = report.energyAfter = placementEnergy(mesh);
  report.error = {0, "of the bounding-box diagonal", "no internal vertices"};
  if (report.unknowns == 0) {
    report.seconds = watch.seconds();
    return report;
  }

  const Block field = positionsOf(mesh);
  const double diagonal = diagonalOf(field);
  // A mesh that is one point is at rest: any positive target is met at once.
  const double target = diagonal > 0 ? impl_->options.tolerance * diagonal : 1.0;
  COIF_ASSIGN(placing::Solution solution, placing::solve(system, *impl_->prepared, system.strain(field),
                                                         target, impl_->options, context));
  system.pinMeans(mesh, field, solution.delta);
  for (std::size_t u = 0; u < system.unknowns(); ++u) {
    const std::uint32_t v = system.vertexOf(u);
    mesh.setPosition(v, mesh.position(v) + solution.delta.row(Eigen::Index(u)).matrix().transpose());
  }
  report.solver = solution.solver;
  report.iterations = solution.iterations;
  report.converged = solution.converged;
  report.condition = solution.condition;
  report.energyAfter = placementEnergy(mesh);
  report.error.value = diagonal > 0 ? (solution.bound + storageError(field)) / diagonal : 0;
  report.error.method =
      "proven bound from the true residual through the box inverse, plus the rounding of stored doubles";
  report.seconds = watch.seconds();
  return report;
}

Result<PlaceReport> place(HairMesh& mesh, const PlaceOptions& options, const Context& context) {
  const Stopwatch watch;
  COIF_TRY(checkPositions(mesh));
  COIF_ASSIGN(const Placer placer, Placer::create(mesh, options, context));
  COIF_ASSIGN(PlaceReport report, placer.place(mesh, context));
  report.seconds = watch.seconds();
  return report;
}

Result<std::vector<double>> dragResponse(const HairMesh& mesh, std::span<const std::uint32_t> selection,
                                         const PlaceOptions& options, const Context& context) {
  COIF_TRY(placing::checkOptions(options));
  const placing::PlaceSystem system(mesh);
  Block field = Block::Zero(Eigen::Index(mesh.vertices().size()), 1);
  for (const std::uint32_t v : selection) {
    const std::string place = "vertex " + std::to_string(v);
    if (v >= mesh.vertices().size())
      return makeError(ErrorCode::InvalidArgument, "there is no such vertex", place);
    if (!system.external(v))
      return makeError(ErrorCode::InvalidArgument, "an internal vertex cannot be dragged", place);
    field(v, 0) = 1;
  }
  std::vector<double> coefficients(field.data(), field.data() + field.size());
  if (system.unknowns() == 0 || selection.empty()) return coefficients;
  // Coefficients have no unit; the selection's own 1 takes the place of the bounding box.
  COIF_ASSIGN(const placing::Prepared prepared, placing::prepare(mesh, system, options, context));
  COIF_ASSIGN(placing::Solution solution,
              placing::solve(system, prepared, system.strain(field), options.tolerance, options, context));
  system.pinMeans(mesh, field, solution.delta);
  for (std::size_t u = 0; u < system.unknowns(); ++u) {
    coefficients[system.vertexOf(u)] = solution.delta(Eigen::Index(u), 0);
  }
  return coefficients;
}

}  // namespace coif
