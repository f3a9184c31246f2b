// Distance, inside/outside and nearest-point queries on a head.
#pragma once

#include <array>
#include <memory>
#include <span>

#include "coif/base/context.h"
#include "coif/base/result.h"
#include "coif/scalp/polygon_mesh.h"

namespace coif {

/// The foot of a perpendicular: where on the surface, on which face, and how far.
struct SurfacePoint {
  Vec3 position = Vec3::Zero();
  Vec3 normal = Vec3::Zero();       ///< unit, interpolated from area-weighted vertex normals
  std::uint32_t face = kNone;       ///< polygon of the mesh
  std::uint32_t triangle = kNone;   ///< triangle of the mesh's fan triangulation
  Vec3 barycentric = Vec3::Zero();  ///< of the triangle
  double distance = 0;              ///< unsigned, mesh units
};

/// Immutable acceleration structure over the triangulated mesh. Thread-safe after construction.
/// Keeps a copy of the mesh. Faces that validate() would refuse are left out; with no face left every query
/// answers with face = kNone, an infinite distance and a winding number of 0. Accuracy: scaled to the
/// bounding box inside, so distances are good to about 1e-15 of its diagonal at any unit; winding numbers to
/// 2e-3 (dipole and quadrupole of far nodes; exact where triangles are near). Cost: build O(T log T); a query
/// O(log T).
class Surface {
 public:
  /// Triangulates faces (fan from the first corner; concave faces by ear clipping in the Newell plane).
  explicit Surface(const PolygonMesh& mesh);
  /// The same with progress, for large heads. Errors: Cancelled.
  static Result<Surface> create(PolygonMesh mesh, const Context& context);
  ~Surface();
  Surface(Surface&&) noexcept;
  Surface& operator=(Surface&&) noexcept;

  SurfacePoint nearest(const Vec3& point) const;
  /// First hit of the ray origin + t·direction with t in (0, maxT]; false when none. hit.distance =
  /// t·|direction|.
  bool intersect(const Vec3& origin, const Vec3& direction, double maxT, SurfacePoint& hit) const;
  /// Generalised winding number (Jacobson et al. 2013, fast evaluation Barill et al. 2018): about 1 inside, 0
  /// outside.
  double windingNumber(const Vec3& point) const;
  /// Unsigned distance, negative where the winding number exceeds one half.
  double signedDistance(const Vec3& point) const;
  /// UV at a surface point; false when the mesh has none.
  bool uv(const SurfacePoint& point, Vec2& uv) const;
  /// Batch form of windingNumber, threaded.
  void windingNumbers(const Context& context, std::span<const Vec3> points, std::span<double> out) const;

  /// The surface point of given barycentrics on a triangle < triangleCount(); its distance is 0.
  SurfacePoint at(std::uint32_t triangle, const Vec3& barycentric) const;
  std::size_t triangleCount() const;
  std::array<std::uint32_t, 3> triangleVertices(std::uint32_t triangle) const;
  std::uint32_t triangleFace(std::uint32_t triangle) const;  ///< the polygon it is part of

  const PolygonMesh& mesh() const;
  double size() const;  ///< bounding-box diagonal of all positions

 private:
  struct Impl;
  explicit Surface(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace coif
