#include "coif/scalp/mirror.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "coif/base/random.h"

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

/// One round of closest points: the reflection that best carries `from` to `to`.
MirrorPlane refined(const Surface& surface, const MirrorPlane& plane, std::span<const Vec3> points) {
  std::vector<Match> m = matches(surface, plane, points);
  std::stable_sort(m.begin(), m.end(),
                   [](const Match& a, const Match& b) { return a.distance < b.distance; });
  m.resize(std::max<std::size_t>(3, m.size() * 4 / 5));
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();
  for (const Match& x : m) {
    from += x.from / double(m.size());
    to += x.to / double(m.size());
  }
  Mat3 cross = Mat3::Zero();
  for (const Match& x : m) {
    const Vec3 a = (x.from - from) / surface.size(), b = (x.to - to) / surface.size();
    cross += a * b.transpose() + b * a.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(cross);
  if (solver.info() != Eigen::Success || !cross.allFinite()) return plane;
  MirrorPlane out;
  out.normal = solver.eigenvectors().col(0).normalized();
  if (out.normal.dot(plane.normal) < 0) out.normal = -out.normal;
  out.point = 0.5 * (from + to);
  return out;
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
  for (int i = 0; i < 60; ++i) {
    const MirrorPlane next = refined(surface, best, fine.points);
    const double change =
        (next.normal - best.normal).norm() + std::abs(next.side(best.point)) / surface.size();
    best = next;
    if (change < 1e-10) break;
  }
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
