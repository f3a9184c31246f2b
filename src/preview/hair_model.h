// What the preview keeps of a head of hair: how its strands are made, not the strands.
//
// Either strands grown on a hair mesh, of which the GPU keeps weights and makes the points
// (shaders/synthesis.glsl), or strands that came as points. Both are sorted into locks: strands that share
// their number of samples. Within a lock strands keep the progressive order, so a prefix of the whole is a
// prefix of every lock.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coif/base/context.h"
#include "coif/base/result.h"
#include "coif/hairmesh/hair_mesh.h"
#include "coif/strands/catmull_rom.h"
#include "coif/strands/roots.h"
#include "coif/strands/strand_set.h"
#include "coif/strands/strand_style.h"

namespace coif::preview {

/// As shaders/synthesis.glsl has them.
struct Lock {
  std::uint32_t corners = 0, height = 0;  ///< 0, 0: strands that came as points
  std::uint32_t vertexStart = 0;          ///< into HairModel::bundleVertices
  std::uint32_t rootStart = 0;
};
struct Root {
  Vec3f position;  ///< where the strand starts
  float width;     ///< diameter there
  float tipWidth;
  std::uint32_t seed;
  std::uint32_t first, count;  ///< of its weights or points
};
static_assert(sizeof(Lock) == 16 && sizeof(Root) == 32);

/// What goes to the GPU once; sorted by lock.
struct HairUpload {
  std::vector<Root> roots;
  std::vector<float> weights;           ///< strands on a hair mesh
  std::vector<Eigen::Vector4f> points;  ///< strands that came as points: position, diameter
  std::vector<Eigen::Vector4f> colors;  ///< a strand, or a point; may be empty
  std::size_t bytes() const;
};

/// A few strands on the CPU, for what needs no more: light volumes, boxes, planning.
struct CoarseStrands {
  struct Point {
    Vec3f position;
    float width;  ///< widened, so that the few cover what all would
  };
  std::vector<Point> points;
  std::vector<std::uint32_t> starts{0};  ///< S + 1
  std::vector<float> longer;             ///< S: length of the strand over that of these few points
  Box box;                               ///< of the points
  double scale = 1;                      ///< by which widths were raised

  std::size_t strandCount() const { return starts.size() - 1; }
  std::span<const Point> strand(std::size_t s) const {
    return std::span(points).subspan(starts[s], starts[s + 1] - starts[s]);
  }
};

constexpr std::uint32_t kCoarsePoints = 13;  ///< of a coarse strand on a hair mesh

/// Some of the strands on a hair mesh, made again on the CPU when it moves.
struct SampledRoots {
  RootSet roots;  ///< ids: places in the set that was given
  std::vector<Vec3f> landings;
  std::vector<float> widths;  ///< root and tip in turn

  void add(const StrandSet& strands, std::size_t s, std::uint32_t bundle);
  void sort(std::size_t bundles);  ///< when all were added
};

/// What styling adds to some strands, and at which of a strand's points.
struct SampledStyle {
  std::vector<Vec3f> offsets;       ///< `points` a strand
  std::vector<float> reach, turns;  ///< a strand
  std::vector<float> widths;        ///< factors of the points, or none
  std::uint32_t points = 0;         ///< evenly from root to tip
};

/// Which of a strand's points is sample k of a few; as shaders/synthesis.glsl has it.
std::uint32_t pointTaken(std::uint32_t k, std::uint32_t samples, std::uint32_t points);
/// Of a polyline.
double lengthOf(std::span<const Vec3> points);

struct HairModel {
  /// The strands of a lock, as places in the progressive order of all strands kept; ascending.
  struct Members {
    std::vector<std::uint32_t> ranks;
    double restLift = 0, maxLift = 0;  ///< greatest distance from cage to head: at rest, and a bound for now
    bool finite = true;                ///< its vertices are
    float longer = 1;                  ///< as CoarseStrands has it, on average, where strands are styled
    std::uint32_t mostPoints = 0;      ///< of its strands, where they came as points or are styled
    std::vector<std::vector<Vec3>>
        examples;  ///< a few of its strands, where they came as points or are styled
  };
  bool synthesised = false, colored = false;
  bool moved = false;   ///< coarse strands and examples are of the mesh as it was before
  bool styled = false;  ///< what styling adds to strands on a hair mesh is on the GPU
  std::vector<Lock> locks;
  std::vector<Members> members;
  std::vector<std::uint32_t> bundleVertices;
  HairMesh mesh;           ///< as it is now
  std::vector<Vec3> rest;  ///< its vertices as they were when lifts were measured
  Knots knots = Knots::Uniform;
  std::uint32_t plainPoints = 0;   ///< a strand on a hair mesh, at full detail
  std::uint32_t styledPoints = 0;  ///< the same where it is styled
  std::size_t strands = 0;         ///< kept
  std::size_t dropped = 0;         ///< values not finite, too few points, or no such bundle
  std::size_t styledStrands = 0;   ///< those whose style fits there: a prefix
  double baseScale = 1;            ///< widths were raised by this for strands that did not fit
  CoarseStrands coarse;

  std::size_t hidden() const;  ///< strands of locks with a vertex that is not finite
  std::uint32_t fullPoints() const { return styled ? styledPoints : plainPoints; }
  /// The control points of a column, root first.
  std::vector<Vec3> column(const Lock& lock, std::uint32_t corner) const;
  std::vector<double> intervals(const Lock& lock) const;
  /// New positions, as many as before; follow() brings the coarse strands and the examples after.
  void move(std::span<const Vec3> positions);
  /// Coarse strands and examples of the mesh as it is now, if it moved since: once a picture, however often
  /// it moved.
  void follow(const Context& context);
  void sample(const Context& context);  ///< coarse strands and examples of a hair mesh, as it is now

  void finishCoarse();  ///< box and widths of the coarse strands

  // How coarse strands and examples are made of a hair mesh.
  SampledRoots coarseRoots, exampleRoots;
  SampledStyle coarseStyle, exampleStyle;
  std::vector<std::uint32_t>
      places;  ///< by strand as it was given: where it is in the sorted roots; kNone: dropped
};

struct PreparedHair {
  HairModel model;
  HairUpload upload;
};

/// Strands that grow() made on this mesh (they carry weights and bundle ids); their points say where they
/// start and how wide they are. Errors: InvalidArgument without weights or with weights of the wrong number.
Result<PreparedHair> prepareGrown(const HairMesh& mesh, const StrandSet& strands, Knots knots,
                                  const Context& context);

/// What goes to the GPU of a style of the strands that were given to prepareGrown. Starts with a vec4 a lock:
/// x: how many strands lie before its first. Then n vec4 a strand: offset and factor of the width; in place
/// of the first offset, which is none, reach and turn at the root. Only a prefix of the strands where
/// `maxPoints` do not hold all. Errors: InvalidArgument for a style of other strands, or of strands of
/// different numbers of points.
Result<std::vector<Eigen::Vector4f>> prepareStyle(HairModel& model, const StrandStyle& style,
                                                  std::size_t maxPoints, const Context& context);

/// Strands as points. At most `maxPoints` go to the GPU: a prefix, with the widths raised in its place.
Result<PreparedHair> prepareImported(const StrandSet& strands, std::size_t maxPoints, const Context& context);

}  // namespace coif::preview
