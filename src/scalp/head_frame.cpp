#include "coif/scalp/head_frame.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace coif {
namespace {

constexpr int kLevels = 1000;

/// Horizontal cross-section: reach along the profile on the mirror plane, and to the sides.
struct Level {
  double front = -std::numeric_limits<double>::infinity();  ///< greatest reach along `axis` on the plane
  double back = std::numeric_limits<double>::infinity();
  double left = 0, right = 0;  ///< greatest reach to either side, >= 0
  bool cut() const { return front >= back; }
  double depth() const { return front - back; }
  double width() const { return 0.5 * (left + right); }
};

/// Cross-sections of a shell at even steps below its crown.
class Profile {
 public:
  Profile(const Surface& surface, std::span<const std::uint32_t> faces, const Vec3& up,
          const MirrorPlane& plane)
      : up_(up), axis_(up.cross(plane.normal).normalized()), plane_(plane) {
    std::vector<std::uint8_t> wanted(surface.mesh().faceCount(), 0);
    for (std::uint32_t f : faces) wanted[f] = 1;
    for (std::uint32_t t = 0; t < surface.triangleCount(); ++t) {
      if (!wanted[surface.triangleFace(t)]) continue;
      std::array<Vec3, 3> p;
      const auto v = surface.triangleVertices(t);
      for (std::size_t k = 0; k < 3; ++k) p[k] = surface.mesh().positions[v[k]];
      triangles_.push_back(p);
    }
    crown_ = -std::numeric_limits<double>::infinity();
    double bottom = -crown_;
    for (const auto& t : triangles_)
      for (const Vec3& p : t) {
        crown_ = std::max(crown_, p.dot(up_));
        bottom = std::min(bottom, p.dot(up_));
      }
    step_ = (crown_ - bottom) / kLevels;
    levels_.resize(kLevels);
    if (step_ > 0 && std::isfinite(step_))
      for (const auto& t : triangles_) add(t);
  }

  bool usable() const { return step_ > 0 && std::isfinite(step_); }
  double crown() const { return crown_; }
  double reach() const { return step_ * kLevels; }  ///< crown to the lowest point
  double along(const Vec3& p) const { return axis_.dot(p - plane_.point); }
  const Vec3& axis() const { return axis_; }
  /// The section nearest to `below` the crown that cuts the plane at all.
  const Level& at(double below) const {
    const int i = std::clamp(int(below / step_), 0, kLevels - 1);
    for (int d = 0; d < kLevels; ++d)
      for (int j : {i - d, i + d})
        if (j >= 0 && j < kLevels && levels_[std::size_t(j)].cut()) return levels_[std::size_t(j)];
    return levels_[std::size_t(i)];
  }

 private:
  double height(int level) const { return crown_ - (level + 0.5) * step_; }

  void add(const std::array<Vec3, 3>& t) {
    double lo = t[0].dot(up_), hi = lo;
    for (const Vec3& p : t) lo = std::min(lo, p.dot(up_)), hi = std::max(hi, p.dot(up_));
    const int first = std::max(0, int((crown_ - hi) / step_ - 0.5));
    const int last = std::min(kLevels - 1, int((crown_ - lo) / step_ + 0.5));
    for (int i = first; i <= last; ++i) slice(t, i);
  }

  void slice(const std::array<Vec3, 3>& t, int i) {
    Vec3 ends[3];
    int count = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &a = t[k], &b = t[(k + 1) % 3];
      const double ha = a.dot(up_) - height(i), hb = b.dot(up_) - height(i);
      if ((ha < 0) != (hb < 0)) ends[count++] = a + ha / (ha - hb) * (b - a);
    }
    if (count < 2) return;
    Level& level = levels_[std::size_t(i)];
    const double sa = plane_.side(ends[0]), sb = plane_.side(ends[1]);
    level.right = std::max({level.right, sa, sb});
    level.left = std::max({level.left, -sa, -sb});
    if ((sa < 0) == (sb < 0)) return;
    const double x = along(ends[0] + sa / (sa - sb) * (ends[1] - ends[0]));
    level.front = std::max(level.front, x);
    level.back = std::min(level.back, x);
  }

  Vec3 up_, axis_;
  MirrorPlane plane_;
  std::vector<std::array<Vec3, 3>> triangles_;
  std::vector<Level> levels_;
  double crown_ = 0, step_ = 0;
};

/// Level below the crown where the skull's depth stops growing (brow to back), and that depth.
struct Skull {
  double below = 0, depth = 0, middle = 0;
};
Skull findSkull(const Profile& profile) {
  const double step = profile.reach() / kLevels;
  Skull skull;
  for (double h = step; h < profile.reach(); h += step) {
    const double depth = profile.at(h).depth();
    // A tenth of the depth lower it gains less than 2 %; not before the sections are as deep as they are low.
    if (!(depth > 0) || h < 0.2 * depth) continue;
    skull.below = std::min(h + 0.05 * depth, profile.reach());
    skull.depth = std::max(depth, profile.at(std::min(h + 0.1 * depth, profile.reach())).depth());
    if (profile.at(h + 0.1 * depth).depth() < 1.02 * depth) break;
  }
  const Level& level = profile.at(skull.below);
  skull.middle = 0.5 * (level.front + level.back);
  return skull;
}

/// Which side of the axis holds the face: +1 or −1, or 0 when both reach alike in the head's lower half.
int faceSide(const Profile& profile, const Skull& skull) {
  double sum = 0;
  int count = 0;
  for (double h = 0.6 * skull.depth; h < std::min(1.05 * skull.depth, profile.reach());
       h += 0.01 * skull.depth) {
    const Level& level = profile.at(h);
    if (!level.cut()) continue;
    sum += level.front + level.back - 2 * skull.middle;
    ++count;
  }
  // 4 % of the depth: a sphere gives 0, heads 10 % and more.
  if (count == 0 || std::abs(sum / count) < 0.04 * skull.depth) return 0;
  return sum > 0 ? 1 : -1;
}

/// H: the face recedes below three quarters of the brow's reach; 0 when it never does in 0.8 … 1.6 depths.
double findChin(const Profile& profile, const Skull& skull, int side) {
  for (double h = 0.8 * skull.depth; h < 1.6 * skull.depth; h += 0.005 * skull.depth) {
    if (h >= profile.reach()) return profile.reach();
    // The gap between open lips is no chin: look a little further down as well.
    double reach = 0;
    for (double d = 0; d < 0.1 * skull.depth && h + d < profile.reach(); d += 0.01 * skull.depth) {
      const Level& level = profile.at(h + d);
      reach = std::max(reach, side > 0 ? level.front - skull.middle : skull.middle - level.back);
    }
    if (reach < 0.75 * 0.5 * skull.depth) return h;
  }
  return 0;
}

void findEars(const Profile& profile, const Skull& skull, const Surface& surface,
              std::span<const std::uint32_t> faces, HeadFrame& frame) {
  double top = -1;
  frame.halfWidth = 0;
  for (double h = 0.2 * skull.depth; h < 0.75 * skull.depth; h += 0.01 * skull.depth) {
    const double width = profile.at(h).width();
    frame.halfWidth = std::max(frame.halfWidth, width);
    // A skull widens by less than 3.5 % in a step of 2 % of its depth; the upper edge of an ear is a jump.
    if (profile.at(h + 0.02 * skull.depth).width() > 1.045 * width) {
      top = h;
      break;
    }
  }
  if (top < 0) return;
  double front = 4, back = -4, elevation = -2;
  for (std::uint32_t f : faces)
    for (std::uint32_t v : surface.mesh().face(f)) {
      const Vec3& p = surface.mesh().positions[v];
      const double below = profile.crown() - p.dot(frame.up);
      if (below < top - 0.02 * skull.depth || below > top + 0.35 * skull.depth) continue;
      if (std::abs(frame.mirror.side(p)) < 1.03 * frame.halfWidth) continue;
      const Vec2 angles = frame.angles(p);
      front = std::min(front, std::abs(angles.x()));
      back = std::max(back, std::abs(angles.x()));
      elevation = std::max(elevation, angles.y());
    }
  // Shoulders or a fault when it spans more than a quarter turn.
  if (front > back || back - front > 1.6) return;
  frame.earsFound = true;
  frame.earFront = front;
  frame.earBack = back;
  frame.earTop = elevation;
}

std::vector<std::uint32_t> facesAbove(const Surface& surface, std::span<const std::uint32_t> faces,
                                      const Vec3& up, double limit) {
  std::vector<std::uint32_t> out;
  for (std::uint32_t f : faces)
    if (surface.mesh().positions[surface.mesh().face(f)[0]].dot(up) > limit) out.push_back(f);
  return out;
}

Result<MirrorPlane> planeOf(const Surface& surface, std::span<const std::uint32_t> faces, const Vec3& up,
                            const HeadOptions& options) {
  if (options.mirror) return givenMirrorPlane(surface, options.mirror->point, options.mirror->normal, faces);
  MirrorOptions mirror;
  mirror.contains = up;
  COIF_ASSIGN(MirrorPlane plane, findMirrorPlane(surface, faces, mirror));
  if (options.forward && std::abs(plane.normal.dot(options.forward->normalized())) > 0.5)
    return givenMirrorPlane(surface, plane.point, options.forward->cross(up), faces);
  return plane;
}

Status checkDirections(const HeadOptions& options, const Vec3& up) {
  if (!up.allFinite() || !(up.norm() > 0))
    return makeError(ErrorCode::InvalidArgument, "The up direction must not be zero.");
  if (options.forward && !(options.forward->cross(up).norm() > 1e-6 * options.forward->norm() * up.norm()))
    return makeError(ErrorCode::InvalidArgument, "The forward direction must not be zero or along up.");
  if (options.mirror &&
      !(options.mirror->normal.cross(up).norm() > 1e-6 * options.mirror->normal.norm() * up.norm()))
    return makeError(ErrorCode::InvalidArgument, "The mirror plane's normal must not be zero or along up.");
  return {};
}

}  // namespace

Vec2 HeadFrame::angles(const Vec3& point) const {
  const Vec3 d = point - centre;
  const double x = d.dot(right), y = d.dot(up), z = d.dot(forward);
  return {std::atan2(x, z), std::atan2(y, std::hypot(x, z))};
}

Result<HeadFrame> estimateHeadFrame(const Surface& surface, std::span<const std::uint32_t> shellFaces,
                                    const HeadOptions& options) {
  const bool yUp = surface.mesh().upAxis == UpAxis::Y;
  HeadFrame frame;
  frame.up = options.up.value_or(yUp ? Vec3::UnitY() : Vec3::UnitZ());
  COIF_TRY(checkDirections(options, frame.up));
  frame.up.normalize();
  COIF_ASSIGN(frame.mirror, planeOf(surface, shellFaces, frame.up, options));
  {
    // Again without neck and shoulders, which hang askew.
    const Profile rough(surface, shellFaces, frame.up, frame.mirror);
    if (!rough.usable()) return makeError(ErrorCode::Degenerate, "The shell has no height along up.");
    const Skull skull = findSkull(rough);
    const auto head = facesAbove(surface, shellFaces, frame.up, rough.crown() - 1.1 * skull.depth);
    if (!head.empty()) {
      COIF_ASSIGN(frame.mirror, planeOf(surface, head, frame.up, options));
    }
  }
  const Profile profile(surface, shellFaces, frame.up, frame.mirror);
  const Skull skull = findSkull(profile);
  if (!(skull.depth > 0)) return makeError(ErrorCode::Degenerate, "The mirror plane does not cut the head.");
  int side = faceSide(profile, skull);
  frame.faceFound = side != 0;
  const Vec3 convention = yUp ? Vec3::UnitZ() : Vec3(-Vec3::UnitY());
  if (options.forward) side = profile.axis().dot(*options.forward) < 0 ? -1 : 1;
  if (side == 0) side = profile.axis().dot(convention) < 0 ? -1 : 1;
  if (!frame.faceFound) frame.notes.push_back("No face was found on the profile: front is a convention.");

  frame.right = (double(side) * profile.axis()).cross(frame.up).normalized();
  frame.forward = frame.up.cross(frame.right);
  if (frame.mirror.normal.dot(frame.right) < 0) frame.mirror.normal = -frame.mirror.normal;
  frame.depth = skull.depth;
  const Vec3 foot = frame.mirror.point + skull.middle * profile.axis();
  frame.centre = foot + (profile.crown() - skull.below - foot.dot(frame.up)) * frame.up;
  // `up` may lean out of the plane a little; the centre must not.
  frame.centre -= frame.mirror.side(frame.centre) * frame.mirror.normal;
  frame.height = frame.faceFound ? findChin(profile, skull, side) : 0;
  if (frame.height == 0) {
    frame.height = std::min(1.1 * skull.depth, profile.reach());
    if (frame.faceFound)
      frame.notes.push_back("No chin was found: the head's height is taken from its depth.");
  }
  findEars(profile, skull, surface, shellFaces, frame);
  if (!frame.earsFound) frame.notes.push_back("No ears were found: their place is taken from proportions.");
  if (!frame.mirror.accepted) frame.notes.push_back("The head is not symmetric enough for a mirror plane.");
  return frame;
}

}  // namespace coif
