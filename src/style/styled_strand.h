// One strand while operators work on it, and what they may know of it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coif/base/random.h"
#include "coif/strands/strand_style.h"
#include "coif/style/ramp.h"

namespace coif::style {

/// How much of an operator a strand takes: the operator's amount times the mask at its root, by the ramp.
struct Strength {
  double whole = 1;
  const RampCurve& ramp;
  double at(double fraction) const { return whole * ramp(fraction); }
};

/// Where a strand grows, in the embedding.
struct StrandPlace {
  std::uint64_t id = 0;
  Vec3 root = Vec3::Zero();     ///< on the root layer, centimetres, in the mesh's own axes (the third is up)
  Vec3 normal = Vec3::UnitZ();  ///< of the root face, in those axes
};

/// Centres that strands gather around, and which of them is each strand's.
struct Locks {
  struct Centre {
    StrandPlace place;
    std::vector<Vec3> points;   ///< styled, before the operator
    std::vector<Frame> frames;  ///< of the mesh's curve
    std::vector<double> arcs;   ///< along the mesh's curve
  };
  std::vector<Centre> centres;
  std::vector<std::uint32_t> centreOf;  ///< by strand; kNone: none in reach
};

class StyledStrand {
 public:
  // Who it is.
  std::size_t index = 0;
  StrandPlace place;
  StrandPlace lock;  ///< the centre's, once an operator gathered it; before: its own
  bool inLock = false;

  /// Starts from what is stored: offsets (n) and widths (n or none) of the curve's points.
  void load(const StrandCurve& curve, double reach, std::span<const Vec3f> offsets,
            std::span<const float> widths);

  std::size_t size() const { return base_.size(); }
  double reach() const { return reach_; }
  std::span<const Vec3> offsets() const { return offsets_; }  ///< normal, binormal, tangent
  std::span<const double> widths() const { return widths_; }
  std::span<const double> arcs() const { return arcs_; }  ///< along the mesh's curve, scene units
  double length() const { return arcs_.back(); }
  /// 0 at the root, 1 at the tip, by length.
  double fraction(std::size_t p) const;
  const Frame& frame(std::size_t p) const { return frames_[p]; }
  Vec3 position(std::size_t p) const { return base_[p] + frames_[p].inSpace(offsets_[p]); }
  /// Between points too.
  Vec3 positionAt(double at) const;

  // What operators do. The first point stays on the head.
  void addOffset(std::size_t p, double normal, double binormal) {
    if (p > 0) offsets_[p] += Vec3(normal, binormal, 0);
  }
  void moveTo(std::size_t p, const Vec3& position) {
    if (p > 0) offsets_[p] = frames_[p].inFrame(position - base_[p]);
  }
  void scaleWidth(std::size_t p, double factor) { widths_[p] *= factor; }
  /// Ends the strand at a place of [0, size() − 1], or beyond: then it goes straight on. Its points spread
  /// anew; offsets go with the hair.
  void endAt(double tip);
  /// Ends it so that the mesh's curve below is so long.
  void endAtArc(double arc);

 private:
  void spread();
  const StrandCurve* curve_ = nullptr;
  double reach_ = 1;
  std::vector<Vec3> base_, offsets_;
  std::vector<Frame> frames_;
  std::vector<double> arcs_, widths_;
};

}  // namespace coif::style
