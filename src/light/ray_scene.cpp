#include "light/ray_scene.h"

#ifndef COIF_WITH_EMBREE

namespace coif::light {

struct RayScene::Impl {};
RayScene::RayScene(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;
RayScene::~RayScene() = default;
Result<RayScene> RayScene::build(const StrandSet*, const PolygonMesh*) {
  return makeError(ErrorCode::Unsupported, "this build has no ray tracing: it was made without Embree");
}
RayHit RayScene::closest(const RayStart&, const Vec3&) const {
  return {};
}
bool RayScene::blocked(const RayStart&, const Vec3&, double) const {
  return false;
}
bool RayScene::all(const RayStart&, const Vec3&, double, std::vector<StrandMeeting>&) const {
  return false;
}
std::size_t RayScene::strandsDropped() const {
  return 0;
}

}  // namespace coif::light

#else

#include <embree3/rtcore.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "coif/scalp/triangulation.h"

namespace coif::light {
namespace {

constexpr unsigned kStrands = 0, kHead = 1;  // Embree's geometry ids
constexpr float kLargest = 1e15f;            // of a coordinate: Embree's floats stay far from overflow
// Embree itself ignores ribbons nearer than two radii; rays start farther back, so that it never does.
constexpr double kStepBackRadii = 2.5;

struct Release {
  void operator()(RTCDeviceTy* device) const { rtcReleaseDevice(device); }
  void operator()(RTCSceneTy* scene) const { rtcReleaseScene(scene); }
  void operator()(RTCGeometryTy* geometry) const { rtcReleaseGeometry(geometry); }
};
template <class T>
using Owned = std::unique_ptr<T, Release>;

struct CurvePoint {
  float x, y, z, radius;
  Vec3 position() const { return {x, y, z}; }
};

template <class T>
std::span<T> newBuffer(RTCGeometryTy* geometry, RTCBufferType type, RTCFormat format, std::size_t stride,
                       std::size_t count) {
  auto* data = static_cast<T*>(rtcSetNewGeometryBuffer(geometry, type, 0, format, stride, count));
  return {data, data ? count : 0};
}

}  // namespace

struct RayScene::Impl {
  Owned<RTCDeviceTy> device;
  Owned<RTCSceneTy> scene;  // released before its device
  std::span<const CurvePoint> points;
  std::span<const std::uint32_t> firstPoint;  // of each segment
  std::vector<std::uint32_t> strandOf;        // of each segment
  std::vector<std::uint64_t> offsets;         // of the strands
  Triangulation triangulation;
  std::vector<std::array<std::uint32_t, 3> > triangles;  // vertices
  std::vector<Vec3> positions, normals;                  // of the head
  double stepBack = 0;
  std::size_t dropped = 0;

  Status addStrands(const StrandSet& strands);
  Status addHead(const PolygonMesh& head);

  StrandMeeting meeting(std::uint32_t segment, double along, double distance, const Vec3& origin,
                        const Vec3& direction) const;
  // Whether a segment at this distance is still the fibre that the ray leaves.
  bool leaving(std::uint32_t segment, double distance, const Vec3& direction) const;
};

namespace {

// One query, as the filter sees it.
struct Query {
  RTCIntersectContext embree;  // first: the filter gets a pointer to it
  const RayScene::Impl* scene;
  const RayStart* start;
  Vec3 direction;
  std::vector<StrandMeeting>* meetings = nullptr;  // collects and goes on
  double headDistance = std::numeric_limits<double>::infinity();
};

void filter(const RTCFilterFunctionNArguments* args) {
  Query& query = *reinterpret_cast<Query*>(args->context);
  const auto& ray = *reinterpret_cast<const RTCRay*>(args->ray);
  const auto& hit = *reinterpret_cast<const RTCHit*>(args->hit);
  if (args->N != 1 || args->valid[0] == 0) return;
  const double distance = double(ray.tfar) - query.scene->stepBack;
  bool accepted = true;
  if (hit.geomID == kHead) {
    accepted = hit.primID != query.start->triangle;
    if (accepted && query.meetings) query.headDistance = std::min(query.headDistance, distance);
  } else {
    accepted = query.scene->strandOf[hit.primID] != query.start->strand ||
               !query.scene->leaving(hit.primID, distance, query.direction);
    if (accepted && query.meetings) {
      query.meetings->push_back(
          query.scene->meeting(hit.primID, double(hit.u), distance, query.start->origin, query.direction));
    }
  }
  if (!accepted || query.meetings) args->valid[0] = 0;
}

Query makeQuery(const RayScene::Impl& scene, const RayStart& start, const Vec3& direction) {
  Query query{{}, &scene, &start, direction};
  rtcInitIntersectContext(&query.embree);
  query.embree.filter = filter;
  return query;
}

RTCRay makeRay(const RayScene::Impl& scene, const Vec3& origin, const Vec3& direction, double distance) {
  const Vec3 from = origin - scene.stepBack * direction;
  RTCRay ray{};
  ray.org_x = float(from.x()), ray.org_y = float(from.y()), ray.org_z = float(from.z());
  ray.dir_x = float(direction.x()), ray.dir_y = float(direction.y()), ray.dir_z = float(direction.z());
  ray.tnear = float(scene.stepBack);
  ray.tfar = float(scene.stepBack + distance);
  ray.mask = ~0u;
  return ray;
}

bool usable(const StrandSet& strands, std::size_t s) {
  if (!drawable(strands, s)) return false;
  const auto points = strands.strand(s);
  bool moves = false;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].cwiseAbs().maxCoeff() > kLargest) return false;
    if (widthAt(strands, strands.offsets[s] + i) > kLargest) return false;
    moves = moves || points[i] != points[0];
  }
  return moves;
}

}  // namespace

Status RayScene::Impl::addStrands(const StrandSet& strands) {
  COIF_TRY(validate(strands, false));
  if (strands.pointCount() >= kNone) {
    return makeError(ErrorCode::TooLarge, "ray tracing takes fewer than 2^32 strand points");
  }
  offsets = strands.offsets;
  std::vector<std::uint32_t> first;
  std::vector<bool> kept(strands.strandCount());
  for (std::size_t s = 0; s < strands.strandCount(); ++s) {
    kept[s] = usable(strands, s);
    dropped += kept[s] ? 0 : 1;
    if (!kept[s]) continue;
    for (std::uint64_t p = offsets[s]; p + 1 < offsets[s + 1]; ++p) {
      if (strands.points[p] == strands.points[p + 1]) continue;
      if (!(widthAt(strands, p) > 0) && !(widthAt(strands, p + 1) > 0)) continue;  // nothing to meet
      first.push_back(std::uint32_t(p));
      strandOf.push_back(std::uint32_t(s));
    }
  }
  if (first.empty()) return {};
  const Owned<RTCGeometryTy> geometry(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_FLAT_LINEAR_CURVE));
  const auto vertices = newBuffer<CurvePoint>(geometry.get(), RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4,
                                              sizeof(CurvePoint), strands.pointCount());
  const auto indices = newBuffer<std::uint32_t>(geometry.get(), RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT,
                                                sizeof(std::uint32_t), first.size());
  if (vertices.empty() || indices.empty()) {
    return makeError(ErrorCode::TooLarge, "there is not enough memory to ray trace the strands");
  }
  float widest = 0;
  for (std::size_t s = 0; s < strands.strandCount(); ++s) {
    for (std::uint64_t p = offsets[s]; p < offsets[s + 1]; ++p) {
      const Vec3f at = kept[s] ? strands.points[p] : Vec3f::Zero();
      vertices[p] = {at.x(), at.y(), at.z(), kept[s] ? 0.5f * widthAt(strands, p) : 0};
      widest = std::max(widest, vertices[p].radius);
    }
  }
  std::copy(first.begin(), first.end(), indices.begin());
  stepBack = kStepBackRadii * double(widest);
  points = vertices;
  firstPoint = indices;
  rtcCommitGeometry(geometry.get());
  rtcAttachGeometryByID(scene.get(), geometry.get(), kStrands);
  return {};
}

Status RayScene::Impl::addHead(const PolygonMesh& head) {
  COIF_TRY(validate(head));
  positions = head.positions;
  normals = vertexNormals(head);
  for (const auto& corners : triangulate(head).triangles) {
    triangles.push_back({head.corners[corners[0]], head.corners[corners[1]], head.corners[corners[2]]});
  }
  for (const Vec3& p : positions) {
    if (p.cwiseAbs().maxCoeff() > double(kLargest)) {
      return makeError(ErrorCode::Degenerate, "a position of the head lies beyond 1e15");
    }
  }
  if (triangles.empty()) return {};
  const Owned<RTCGeometryTy> geometry(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
  const auto vertices = newBuffer<Vec3f>(geometry.get(), RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3,
                                         sizeof(Vec3f), positions.size());
  const auto indices = newBuffer<std::array<std::uint32_t, 3> >(
      geometry.get(), RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, sizeof(triangles[0]), triangles.size());
  if (vertices.empty() || indices.empty()) {
    return makeError(ErrorCode::TooLarge, "there is not enough memory to ray trace the head");
  }
  for (std::size_t v = 0; v < positions.size(); ++v) vertices[v] = positions[v].cast<float>();
  std::copy(triangles.begin(), triangles.end(), indices.begin());
  rtcCommitGeometry(geometry.get());
  rtcAttachGeometryByID(scene.get(), geometry.get(), kHead);
  return {};
}

StrandMeeting RayScene::Impl::meeting(std::uint32_t segment, double along, double distance,
                                      const Vec3& origin, const Vec3& direction) const {
  const std::uint32_t first = firstPoint[segment];
  const CurvePoint &a = points[first], &b = points[first + 1];
  StrandMeeting m;
  m.strand = strandOf[segment];
  m.segment = std::uint32_t(first - offsets[m.strand]);
  m.along = std::clamp(along, 0.0, 1.0);
  m.distance = distance;
  m.tangent = (b.position() - a.position()).normalized();
  m.radius = (1 - m.along) * double(a.radius) + m.along * double(b.radius);
  // The signed distance between the ray's line and the axis: along T × d, d = −ω_o (see fibre.h for the
  // sign).
  const Vec3 across = m.tangent.cross(direction);
  const double cosTheta = across.norm();
  if (cosTheta > 1e-9 && m.radius > 0) {
    m.h = std::clamp((origin - a.position()).dot(across) / (cosTheta * m.radius), -1.0, 1.0);
  }
  return m;
}

bool RayScene::Impl::leaving(std::uint32_t segment, double distance, const Vec3& direction) const {
  const std::uint32_t first = firstPoint[segment];
  const CurvePoint &a = points[first], &b = points[first + 1];
  const double radius = double(std::max(a.radius, b.radius));
  const double cosTheta = (b.position() - a.position()).normalized().cross(direction).norm();
  return distance < radius * std::min(2 / std::max(cosTheta, 1e-9), 50.0);
}

RayScene::RayScene(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;
RayScene::~RayScene() = default;

Result<RayScene> RayScene::build(const StrandSet* strands, const PolygonMesh* head) {
  auto impl = std::make_unique<Impl>();
  impl->device.reset(rtcNewDevice("threads=1"));  // equal hits (joints) do not depend on the threads then
  if (!impl->device) return makeError(ErrorCode::Unsupported, "Embree does not start on this machine");
  impl->scene.reset(rtcNewScene(impl->device.get()));
  rtcSetSceneFlags(impl->scene.get(),
                   RTCSceneFlags(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
  if (strands) COIF_TRY(impl->addStrands(*strands));
  if (head) COIF_TRY(impl->addHead(*head));
  rtcCommitScene(impl->scene.get());
  if (rtcGetDeviceError(impl->device.get()) != RTC_ERROR_NONE) {
    return makeError(ErrorCode::TooLarge, "Embree could not build its tree: out of memory?");
  }
  return RayScene(std::move(impl));
}

RayHit RayScene::closest(const RayStart& start, const Vec3& direction) const {
  Query query = makeQuery(*impl_, start, direction);
  RTCRayHit ray{};
  ray.ray = makeRay(*impl_, start.origin, direction, std::numeric_limits<double>::infinity());
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(impl_->scene.get(), &query.embree, &ray);
  RayHit hit;
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return hit;
  hit.distance = double(ray.ray.tfar) - impl_->stepBack;
  if (ray.hit.geomID == kStrands) {
    hit.kind = RayHit::Kind::Strand;
    hit.strand = impl_->meeting(ray.hit.primID, double(ray.hit.u), hit.distance, start.origin, direction);
    return hit;
  }
  hit.kind = RayHit::Kind::Head;
  hit.triangle = ray.hit.primID;
  const auto& [a, b, c] = impl_->triangles[hit.triangle];
  const auto& at = impl_->positions;
  hit.faceNormal = (at[b] - at[a]).cross(at[c] - at[a]).stableNormalized();
  const double u = double(ray.hit.u), v = double(ray.hit.v);
  const auto& n = impl_->normals;
  hit.smoothNormal = ((1 - u - v) * n[a] + u * n[b] + v * n[c]).stableNormalized();
  if (!(hit.smoothNormal.dot(hit.faceNormal) > 0)) hit.smoothNormal = hit.faceNormal;
  return hit;
}

bool RayScene::blocked(const RayStart& start, const Vec3& direction, double distance) const {
  Query query = makeQuery(*impl_, start, direction);
  RTCRay ray = makeRay(*impl_, start.origin, direction, distance);
  rtcOccluded1(impl_->scene.get(), &query.embree, &ray);
  return ray.tfar < 0;
}

bool RayScene::all(const RayStart& start, const Vec3& direction, double distance,
                   std::vector<StrandMeeting>& meetings) const {
  meetings.clear();
  Query query = makeQuery(*impl_, start, direction);
  query.meetings = &meetings;
  RTCRay ray = makeRay(*impl_, start.origin, direction, distance);
  rtcOccluded1(impl_->scene.get(), &query.embree, &ray);
  std::erase_if(meetings, [&](const StrandMeeting& m) { return m.distance > query.headDistance; });
  std::sort(meetings.begin(), meetings.end(), [](const StrandMeeting& a, const StrandMeeting& b) {
    return std::tie(a.distance, a.strand, a.segment) < std::tie(b.distance, b.strand, b.segment);
  });
  // Neighbouring segments both meet a ray at their joint: the nearer one stands for the strand until the ray
  // has left it.
  std::size_t kept = 0;
  for (std::size_t i = 0; i < meetings.size(); ++i) {
    bool again = false;
    for (std::size_t j = kept; j-- > 0 && !again;) {
      const StrandMeeting& former = meetings[j];
      if (meetings[i].distance - former.distance > 50 * former.radius) break;
      const double cosTheta = former.tangent.cross(direction).norm();
      again = former.strand == meetings[i].strand &&
              meetings[i].distance - former.distance < 2 * former.radius / std::max(cosTheta, 1e-9);
    }
    if (!again) meetings[kept++] = meetings[i];
  }
  meetings.resize(kept);
  return query.headDistance < std::numeric_limits<double>::infinity();
}

std::size_t RayScene::strandsDropped() const {
  return impl_->dropped;
}

}  // namespace coif::light

#endif
