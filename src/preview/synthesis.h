// Strands on the GPU: what they are made from, and the points of a plan.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "preview/compute.h"
#include "preview/detail.h"
#include "preview/hair_model.h"
#include "preview/program.h"

namespace coif::preview {

/// Where strands come from: roots, weights and topology, uploaded once, and the vertices of the hair mesh.
class HairBuffers {
 public:
  HairBuffers(const HairModel& model, const HairUpload& upload);
  /// Uploads the mesh's vertices; says how many bytes.
  std::size_t move(const HairModel& model);
  /// Uploads what prepareStyle made; says how many bytes.
  std::size_t setStyle(std::span<const Eigen::Vector4f> style);
  std::size_t bytes() const { return bytes_; }  ///< of what was uploaded by the constructor
  void bindForColumns() const;
  void bindForPoints(const HairModel& model) const;

 private:
  std::size_t bytes_ = 0;
  Buffer locks_, bundleVertices_, vertices_, roots_, weights_, points_, colors_, style_;
};

enum class Topology { Ribbons, Lines, Segments };

/// The points and strips of a plan, made on the GPU.
class StrandBuffers {
 public:
  explicit StrandBuffers(const HairModel& model, const HairBuffers& hair, const Programs& programs,
                         DetailPlan plan, Topology topology);
  /// Makes the points again, after the mesh moved.
  void make(const HairModel& model, const HairBuffers& hair, const Programs& programs) const;
  /// All strips, with the bound program. Vertex v is side v & 1 of point v >> 1 of a ribbon, or point v of a
  /// line, or end v & 1 of the segment that ends in point v >> 1.
  void draw() const;
  /// One invocation of the bound program a point, batch after batch: points at binding 0, their light at
  /// binding 4 (not of segments), their number at location 0.
  void dispatchPoints() const;
  void bindPoints() const { bindBatch(0); }  ///< of the first batch, at binding 0
  Topology topology() const { return topology_; }
  const DetailPlan& plan() const { return plan_; }
  std::size_t bytes() const { return bytes_; }  ///< of points and indices
  /// Segments walked or drawn since it was last asked.
  std::uint64_t takeWalked() const { return std::exchange(walked_, 0); }

  struct Point {
    Vec3f position;
    float width;
    Vec3f tangent, color;
    float along;
    std::uint32_t seed;
  };
  /// For tests and exports: all points, share by share.
  std::vector<Point> readBack() const;

 private:
  /// Uniforms of the bound program that makes points.
  void describe(const HairModel& model) const;
  void makeColumns(const HairModel& model, const HairBuffers& hair, const Programs& programs) const;

  void bindBatch(std::size_t batch) const;
  GLsizei indexCount(const Batch& batch) const;

  DetailPlan plan_;
  mutable std::uint64_t walked_ = 0;
  Topology topology_ = Topology::Ribbons;
  std::size_t bytes_ = 0;
  std::vector<std::size_t> pointOffsets_, indexOffsets_;  ///< of batches, in points and indices
  Buffer shares_, parameters_, columns_, points_, shades_, indices_;
  VertexArray array_;
};

/// Most points a batch may have with this driver.
std::size_t mostBatchPoints();
/// Most points of strands that came as points, with this driver.
std::size_t mostRawPoints();

}  // namespace coif::preview
