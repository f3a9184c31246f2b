#include "style/embedding.h"

#include <cmath>

#include "coif/base/parallel.h"
#include "coif/scalp/polygon_mesh.h"

namespace coif::style {
namespace {

constexpr std::size_t kGrain = 1024;

/// The mesh's own axes: they turn and move with it as a whole.
struct Axes {
  Vec3 origin = Vec3::Zero();
  Frame frame;  // tangent: the mean normal of the root layer
};

std::vector<Vec3> rootCorners(const HairMesh& mesh, const Bundle& bundle) {
  std::vector<Vec3> corners;
  for (const std::uint32_t v : bundle.face(0)) corners.push_back(mesh.position(v));
  return corners;
}

Axes axesOf(const HairMesh& mesh, UpAxis upAxis) {
  Axes axes;
  Vec3 mean = Vec3::Zero();
  double area = 0, count = 0;
  for (const Bundle& bundle : mesh.bundles()) {
    const Vec3 normal = newellNormal(rootCorners(mesh, bundle));
    mean += normal, area += normal.norm();
  }
  for (const HairVertex& v : mesh.vertices()) {
    if (v.layer == 0) axes.origin += v.position, count += 1;
  }
  axes.origin /= std::max(count, 1.0);
  // A scalp that closes on itself has no mean normal: then the scene's up.
  const Vec3 up = mean.norm() > 1e-3 * area ? Vec3(mean)
                  : upAxis == UpAxis::Z     ? Vec3::UnitZ()
                                            : Vec3::UnitY();
  axes.frame.tangent = up.normalized();
  axes.frame.normal = axes.frame.tangent.unitOrthogonal();
  for (const HairVertex& v : mesh.vertices()) {
    if (v.layer > 0) continue;
    const Vec3 out = v.position - axes.origin, level = out - out.dot(axes.frame.tangent) * axes.frame.tangent;
    if (!(level.norm() > 0.1 * out.norm())) continue;
    axes.frame.normal = level.normalized();
    break;
  }
  axes.frame.binormal = axes.frame.tangent.cross(axes.frame.normal);
  return axes;
}

/// Angle from the face's frame to up × tangent: the same direction on both sides of a bundle's border.
float rootTurn(const Frame& face, std::span<const Vec3f> points, const Vec3& up) {
  const Vec3 tangent = firstTangent(points), across = up.cross(tangent);
  if (!(across.norm() > 1e-9)) return 0;
  const Frame frame = turnedTo(face, tangent);
  return float(std::atan2(across.dot(frame.binormal), across.dot(frame.normal)));
}

Error invalid(std::string why) {
  return makeError(ErrorCode::InvalidArgument, std::move(why));
}

}  // namespace

Result<std::vector<std::uint32_t>> bundlesOf(const HairMesh& mesh, const StrandSet& strands) {
  std::vector<std::uint32_t> bundles(strands.strandCount());
  for (std::size_t s = 0; s < bundles.size(); ++s) {
    bundles[s] = mesh.indexOf(BundleId(strands.rootFaces[s]));
    const bool fits = bundles[s] != kNone && strands.weightOffsets[s + 1] - strands.weightOffsets[s] ==
                                                 mesh.bundles()[bundles[s]].corners;
    if (!fits) return invalid("strand " + std::to_string(s) + " does not grow on this hair mesh");
  }
  return bundles;
}

Result<Embedding> embed(const HairMesh& mesh, const StrandSet& strands, double cm, const Context& context) {
  COIF_TRY(validate(strands, false));
  const std::size_t count = strands.strandCount();
  if (strands.ids.size() != count || strands.rootFaces.size() != count ||
      strands.weightOffsets.size() != count + 1)
    return invalid(
        "only strands with ids, root faces and weights can be styled, as they grow on a hair mesh");
  Embedding out;
  COIF_ASSIGN(out.bundles, bundlesOf(mesh, strands));
  out.places.resize(count), out.rootTurns.resize(count);
  const Axes axes = axesOf(mesh, strands.upAxis);
  const std::vector<Frame> faces = rootFaceFrames(mesh);
  parallelFor(context, count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const auto face = mesh.bundles()[out.bundles[s]].face(0);
      Vec3 root = -axes.origin;
      for (std::size_t i = 0; i < face.size(); ++i)
        root += double(strands.weights[strands.weightOffsets[s] + i]) * mesh.position(face[i]);
      const Frame& faceOf = faces[out.bundles[s]];
      out.places[s] = {strands.ids[s], axes.frame.inFrame(root) / cm, axes.frame.inFrame(faceOf.tangent)};
      out.rootTurns[s] = rootTurn(faceOf, strands.strand(s), axes.frame.tangent);
    }
  });
  return out;
}

double atRoot(const HairMesh& mesh, const StrandSet& strands, std::uint32_t bundle, std::size_t strand,
              std::span<const double> values) {
  const auto face = mesh.bundles()[bundle].face(0);
  double sum = 0;
  for (std::size_t i = 0; i < face.size(); ++i)
    sum += double(strands.weights[strands.weightOffsets[strand] + i]) * values[face[i]];
  return std::clamp(sum, 0.0, 1.0);  // weights of concave faces may be negative
}

}  // namespace coif::style
