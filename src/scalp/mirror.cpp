#include "coif/scalp/mirror.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "coif/base/random.h"
#include "triangle_tree.h"

namespace coif {
namespace {

struct Samples {
  std::vector<Vec3> points;
  Vec3 centroid = Vec3::Zero();
  Mat3 covariance = Mat3::Zero();
};

/// `count` points, evenly spread by area (stratified along the triangles' running area); empty when there is
/// none.
Samples sample(const Surface& surface, std::span<const std::uint32_t> faces, int count) {
  std::vector<std::uint8_t> wanted(surface.mesh().faceCount(), faces.empty() ? 1 : 0);
  for (std::uint32_t f : faces)
    if (f < wanted.size()) wanted[f] = 1;
  const double unit = surface.size();
  std::vector<std::uint32_t> triangles;
  std::vector<double> running{0};
  for (std::uint32_t t = 0; t < surface.triangleCount(); ++t) {
    if (!wanted[surface.triangleFace(t)]) continue;
    const auto v = surface.triangleVertices(t);
    const auto& p = surface.mesh().positions;
    const double area = ((p[v[1]] - p[v[0]]) / unit).cross((p[v[2]] - p[v[0]]) / unit).norm();
    if (!(area > 0) || !std::isfinite(area)) continue;
    triangles.push_back(t);
    running.push_back(running.back() + area);
  }
  Samples out;
  if (triangles.empty()) return out;
  const CounterRandom random(0x6d6972726f72ULL);
  std::size_t k = 0;
  for (int i = 0; i < count; ++i) {
    const double target = (i + random.uniform(3 * std::uint64_t(i))) / count * running.back();
    while (k + 1 < triangles.size() && running[k + 1] <= target) ++k;
    double a = random.uniform(3 * std::uint64_t(i) + 1), b = random.uniform(3 * std::uint64_t(i) + 2);
    if (a + b > 1) a = 1 - a, b = 1 - b;
    out.points.push_back(surface.at(triangles[k], Vec3(1 - a - b, a, b)).position);
  }
  for (const Vec3& p : out.points) out.centroid += p / double(count);
  for (const Vec3& p : out.points) {
    const Vec3 d = (p - out.centroid) / unit;
    out.covariance += d * d.transpose() / double(count);
  }
  return out;
}

struct Match {
  Vec3 from, to;
  double distance = 0;
};

std::vector<Match> matches(const Surface& surface, const MirrorPlane& plane, std::span<const Vec3> points) {
  std::vector<Match> out;
  for (const Vec3& p : points) {
    const SurfacePoint s = surface.nearest(plane.reflect(p));
    out.push_back({p, s.position, s.distance});
  }
  return out;
}

double residual(const Surface& surface, const MirrorPlane& plane, std::span<const Vec3> points) {
  double sum = 0;
  for (const Match& m : matches(surface, plane, points)) sum += std::pow(m.distance / surface.size(), 2);
  return std::sqrt(sum / double(points.size()));
}

/// The reflection that best carries `from` to `to`: the least eigenvector of their cross-covariance.
MirrorPlane bestReflection(std::span<const Match> pairs, double unit, const MirrorPlane& fallback) {
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();
  for (const Match& x : pairs) {
    from += x.from / double(pairs.size());
    to += x.to / double(pairs.size());
  }
  Mat3 cross = Mat3::Zero();
  for (const Match& x : pairs) {
    const Vec3 a = (x.from - from) / unit, b = (x.to - to) / unit;
    cross += a * b.transpose() + b * a.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(cross);
  if (solver.info() != Eigen::Success || !cross.allFinite()) return fallback;
  MirrorPlane out;
  out.normal = solver.eigenvectors().col(0).normalized();
  if (out.normal.dot(fallback.normal) < 0) out.normal = -out.normal;
  out.point = 0.5 * (from + to);
  return out;
}

/// One round of closest points.
MirrorPlane refined(const Surface& surface, const MirrorPlane& plane, std::span<const Vec3> points) {
  std::vector<Match> m = matches(surface, plane, points);
  std::stable_sort(m.begin(), m.end(),
                   [](const Match& a, const Match& b) { return a.distance < b.distance; });
  m.resize(std::max<std::size_t>(3, m.size() * 4 / 5));
  return bestReflection(m, surface.size(), plane);
}

/// Modelled heads are symmetric vertex by vertex: then the pairs give the plane to rounding. Else `plane` as
/// it was.
MirrorPlane pairedVertices(const Surface& surface, std::span<const std::uint32_t> faces,
                           const MirrorPlane& plane) {
  const PolygonMesh& mesh = surface.mesh();
  std::vector<std::uint8_t> used(mesh.vertexCount(), 0);
  const auto use = [&](std::size_t f) {
    for (std::uint32_t v : mesh.face(f)) used[v] = mesh.positions[v].allFinite();
  };
  if (faces.empty())
    for (std::size_t f = 0; f < mesh.faceCount(); ++f) use(f);
  for (std::uint32_t f : faces) use(f);
  const double unit = surface.size();
  const Vec3 origin = plane.point;
  std::vector<TriangleTree::Triangle> points;
  for (std::size_t v = 0; v < used.size(); ++v)
    if (used[v]) {
      const Vec3 p = (mesh.positions[v] - origin) / unit;
      points.push_back({p, p, p});
    }
  if (points.size() < 4) return plane;
  const TriangleTree tree(points);
  MirrorPlane best{Vec3::Zero(), plane.normal, 0, false};
  const std::size_t stride = 1 + points.size() / 20000;
  for (double reach : {3e-3, 1e-4, 1e-6, 1e-6}) {
    std::vector<Match> pairs;
    std::size_t asked = 0;
    for (std::size_t i = 0; i < points.size(); i += stride, ++asked) {
      const auto hit = tree.nearest(best.reflect(points[i][0]));
      if (hit.distance < reach) pairs.push_back({points[i][0], points[hit.triangle][0], hit.distance});
    }
    if (pairs.size() < std::max<std::size_t>(4, asked * 4 / 5)) return plane;
    best = bestReflection(pairs, 1, best);
  }
  best.point = origin + unit * best.point;
  // Files keep six digits: a plane that close to an axis plane is meant to be one.
  for (int k = 0; k < 3; ++k) {
    if (std::abs(std::abs(best.normal[k]) - 1) > 1e-12) continue;
    best.normal = std::copysign(1.0, best.normal[k]) * Vec3::Unit(k);
    if (std::abs(best.point[k]) < 1e-6 * unit) best.point[k] = 0;
  }
  return best;
}

std::vector<Vec3> candidates(const Samples& samples, const MirrorOptions& options) {
  std::vector<Vec3> all{Vec3::UnitX(), Vec3::UnitZ()};
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(samples.covariance);
  if (solver.info() == Eigen::Success)
    for (int k = 0; k < 3; ++k) all.push_back(solver.eigenvectors().col(k).normalized());
  all.push_back(Vec3::UnitY());
  if (options.contains)
    std::erase_if(all, [&](const Vec3& n) { return std::abs(n.dot(options.contains->normalized())) > 0.5; });
  return all;
}

}  // namespace

Result<MirrorPlane> findMirrorPlane(const Surface& surface, std::span<const std::uint32_t> faces,
                                    const MirrorOptions& options) {
  if (options.contains && (!options.contains->allFinite() || !(options.contains->norm() > 0)))
    return makeError(ErrorCode::InvalidArgument, "The direction in the mirror plane must not be zero.");
  const Samples fine = sample(surface, faces, std::max(16, options.samples));
  const Samples coarse = sample(surface, faces, std::max(16, options.samples / 4));
  if (fine.points.empty() || !(surface.size() > 0) || !std::isfinite(surface.size()))
    return makeError(ErrorCode::Degenerate, "A mesh without area has no mirror plane.");
  MirrorPlane best;
  double bestScore = 0;
  bool any = false;
  for (const Vec3& normal : candidates(fine, options)) {
    MirrorPlane plane{fine.centroid, normal, 0, false};
    for (int i = 0; i < 8; ++i) plane = refined(surface, plane, coarse.points);
    if (options.contains && std::abs(plane.normal.dot(options.contains->normalized())) > 0.5) continue;
    const double score = residual(surface, plane, coarse.points);
    // 1e-7: two exact mirrors differ by rounding alone.
    if (any && score >= 0.9 * bestScore - 1e-7) continue;
    any = true;
    best = plane;
    bestScore = score;
  }
  if (!any) return makeError(ErrorCode::Degenerate, "No mirror plane holds the given direction.");
  for (int i = 0; i < 30; ++i) {
    const MirrorPlane next = refined(surface, best, fine.points);
    const double change =
        (next.normal - best.normal).norm() + std::abs(next.side(best.point)) / surface.size();
    best = next;
    if (change < 1e-7) break;
  }
  best = pairedVertices(surface, faces, best);
  best.residual = residual(surface, best, fine.points);
  best.accepted = best.residual <= options.threshold;
  return best;
}

Result<MirrorPlane> givenMirrorPlane(const Surface& surface, const Vec3& point, const Vec3& normal,
                                     std::span<const std::uint32_t> faces) {
  if (!point.allFinite() || !normal.allFinite() || !(normal.norm() > 0))
    return makeError(ErrorCode::InvalidArgument,
                     "A mirror plane needs a finite point and a normal of some length.");
  const Samples samples = sample(surface, faces, 1200);
  if (samples.points.empty())
    return makeError(ErrorCode::Degenerate, "A mesh without area has no mirror plane.");
  MirrorPlane plane{point, normal.normalized(), 0, true};
  plane.residual = residual(surface, plane, samples.points);
  return plane;
}

}  // namespace coif
