#include "simulate/root_motion.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

namespace coif::simulate {

namespace {

/// In scene units; further away floats overflow in what is made of the motion.
constexpr double kFarthest = 1e12;

bool within(const Vec3& p) {
  return p.allFinite() && p.cwiseAbs().maxCoeff() <= kFarthest;
}

Mat3 rotationOf(const Mat3& covariance) {
  if (covariance.isZero(0)) return Mat3::Identity();
  const Eigen::JacobiSVD<Mat3> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 flip = Mat3::Identity();
  flip(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  return svd.matrixU() * flip * svd.matrixV().transpose();
}

}  // namespace

RigidPose bestFit(std::span<const Vec3> from, std::span<const Vec3> to) {
  Vec3 a = Vec3::Zero(), b = Vec3::Zero();
  for (std::size_t i = 0; i < from.size(); ++i) {
    a += from[i] / double(from.size());
    b += to[i] / double(from.size());
  }
  Mat3 covariance = Mat3::Zero();
  for (std::size_t i = 0; i < from.size(); ++i) covariance += (to[i] - b) * (from[i] - a).transpose();
  RigidPose pose;
  pose.rotation = rotationOf(covariance);
  pose.position = b - pose.rotation * a;
  return pose;
}

Result<RootPath> RootPath::create(const HairMesh& mesh, const HeadMotion& motion) {
  if (!motion.poses.empty() && !motion.roots.empty())
    return makeError(ErrorCode::InvalidArgument,
                     "a head moves either as a whole or by its root vertices, and both are given");
  RootPath path;
  path.rootOf_.assign(mesh.vertices().size(), kNone);
  for (std::size_t v = 0; v < mesh.vertices().size(); ++v) {
    if (mesh.vertices()[v].layer != 0) continue;
    path.rootOf_[v] = std::uint32_t(path.rest_.size());
    path.rest_.push_back(mesh.vertices()[v].position);
  }
  for (std::size_t f = 0; f < motion.poses.size(); ++f) {
    const RigidPose& pose = motion.poses[f];
    const double off = (pose.rotation.transpose() * pose.rotation - Mat3::Identity()).cwiseAbs().maxCoeff();
    if (!(off < 1e-6) || !(pose.rotation.determinant() > 0))
      return makeError(ErrorCode::InvalidArgument, "the head's turn is no rotation",
                       "frame " + std::to_string(f));
    if (!within(pose.position))
      return makeError(ErrorCode::InvalidArgument, "the head is not finite or further than 1e12 units away",
                       "frame " + std::to_string(f));
  }
  for (std::size_t f = 0; f < motion.roots.size(); ++f) {
    const auto& roots = motion.roots[f];
    if (roots.size() != path.rest_.size() || !std::all_of(roots.begin(), roots.end(), within))
      return makeError(ErrorCode::InvalidArgument,
                       "a position within 1e12 units for each of the " + std::to_string(path.rest_.size()) +
                           " root vertices is wanted",
                       "frame " + std::to_string(f));
  }
  path.poses_ = motion.poses;
  path.roots_ = motion.roots;
  for (const auto& roots : motion.roots) path.poses_.push_back(bestFit(path.rest_, roots));
  if (path.poses_.empty()) path.poses_.emplace_back();
  if (path.roots_.empty()) return path;
  path.around_.resize(path.rest_.size());
  for (const Bundle& bundle : mesh.bundles()) {
    for (const std::uint32_t corner : bundle.face(0)) {
      for (const std::uint32_t other : bundle.face(0))
        if (other != corner) path.around_[path.rootOf_[corner]].push_back(path.rootOf_[other]);
    }
  }
  return path;
}

RigidPose RootPath::pose(double time) const {
  const double last = double(poses_.size() - 1);
  const double at = std::clamp(time, 0.0, last);
  const auto frame = std::size_t(at);
  if (frame + 1 >= poses_.size()) return poses_.back();
  return between(poses_[frame], poses_[frame + 1], at - double(frame));
}

Vec3 RootPath::where(std::uint32_t root, double time) const {
  const double at = std::clamp(time, 0.0, double(roots_.size() - 1));
  const auto frame = std::min(std::size_t(at), roots_.size() - 1);
  const auto next = std::min(frame + 1, roots_.size() - 1);
  const double t = at - double(frame);
  return (1 - t) * roots_[frame][root] + t * roots_[next][root];
}

void RootPath::point(std::span<const std::uint32_t> vertices, std::span<const double> weights,
                     const Vec3& rest, double time, Vec3& position, Mat3& turn) const {
  if (roots_.empty()) {
    const RigidPose head = pose(time);
    position = head.world(rest);
    turn = head.rotation;
    return;
  }
  std::vector<Vec3> from, to;
  Vec3 off = rest;
  position.setZero();
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const std::uint32_t r = rootOf_[vertices[k]];
    from.push_back(rest_[r]), to.push_back(where(r, time));
    off -= weights[k] * from.back(), position += weights[k] * to.back();
  }
  turn = bestFit(from, to).rotation;
  position += turn * off;
}

void RootPath::root(std::uint32_t vertex, double time, Vec3& position, Mat3& turn) const {
  const std::uint32_t r = rootOf_[vertex];
  if (roots_.empty()) {
    const RigidPose head = pose(time);
    position = head.world(rest_[r]);
    turn = head.rotation;
    return;
  }
  position = where(r, time);
  // The faces around it turn it; where they have no area of their own, the head as a whole does.
  Mat3 covariance = Mat3::Zero();
  for (const std::uint32_t other : around_[r])
    covariance += (where(other, time) - position) * (rest_[other] - rest_[r]).transpose();
  const Eigen::JacobiSVD<Mat3> svd(covariance);
  const auto& sizes = svd.singularValues();
  turn = sizes[1] > 1e-9 * sizes[0] && sizes[0] > 0 ? rotationOf(covariance) : pose(time).rotation;
}

}  // namespace coif::simulate
