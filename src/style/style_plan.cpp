#include "coif/style/style_plan.h"

#include <algorithm>
#include <cmath>
#include <new>

#include "coif/base/parallel.h"
#include "coif/base/report.h"
#include "style/kinds.h"
#include "style/locks.h"

namespace coif {
namespace {

using namespace style;

constexpr std::size_t kGrain = 256;
constexpr double kMetresPerCm = 0.01;

/// An operator that acts, made ready.
struct Active {
  const StyleOperator* op;
  RampCurve ramp;
  std::vector<double> mask;  // by vertex of the mesh
  std::uint32_t group;       // kNone: all
  std::unique_ptr<Effect> effect;
  Locks locks;
};

std::uint32_t groupNamed(const HairMesh& mesh, const std::string& name) {
  const auto names = mesh.groupNames();
  const auto found = std::ranges::find(names, name);
  return found == names.end() ? kNone : std::uint32_t(found - names.begin());
}

/// Why an operator cannot change anything; empty when it can.
std::string idleReason(const StyleOperator& op, const HairMesh& mesh) {
  if (op.amount == 0) return "its amount is 0";
  if (findStyleKind(op.kind)->usesRamp && !findStyleKind(op.kind)->changesWidth &&
      RampCurve(op.ramp).greatest() == 0)
    return "its ramp is 0 from root to tip";
  if (!op.mask.empty() && std::ranges::all_of(maskOf(op.mask, mesh), [](double v) { return v == 0; }))
    return "its mask is 0 everywhere";
  return {};
}

/// Why an operator is not run; empty when it is.
std::string leftOutReason(const StyleOperator& op, const HairMesh& mesh, const StrandSet& strands,
                          const StyleOptions& options) {
  const StyleKind& kind = *findStyleKind(op.kind);
  if (!op.enabled) return "it is switched off";
  if (kind.needsHead && options.head == nullptr) return "there is no head";
  if (kind.changesWidth && strands.widths.empty()) return "the strands have no widths";
  if (!op.group.empty()) {
    const std::uint32_t group = groupNamed(mesh, op.group);
    if (group == kNone) return "there is no group '" + op.group + "'";
    if (std::ranges::none_of(mesh.bundles(), [&](const Bundle& b) { return b.group == group; }))
      return "no hair is in the group '" + op.group + "'";
  }
  return options.runIdle ? std::string() : idleReason(op, mesh);
}

/// The stack at work: what is kept of each strand between operators that look at other strands.
class Styling {
 public:
  Styling(const HairMesh& mesh, const StrandSet& strands, Embedding embedding, bool runIdle)
      : mesh_(mesh),
        strands_(strands),
        embedding_(std::move(embedding)),
        faces_(rootFaceFrames(mesh)),
        runIdle_(runIdle),
        lockOf_(strands.strandCount(), kNone) {
    offsets.resize(strands.pointCount(), Vec3f::Zero());
    reach.resize(strands.strandCount(), 1.0f);
  }

  std::vector<Vec3f> offsets;
  std::vector<float> reach, widths;

  const Embedding& embedding() const { return embedding_; }

  void run(std::span<const Active> batch, const Context& context) {
    if (widths.empty() &&
        std::ranges::any_of(batch, [](const Active& a) { return findStyleKind(a.op->kind)->changesWidth; }))
      widths.assign(strands_.pointCount(), 1.0f);
    parallelFor(context, strands_.strandCount(), kGrain, [&](std::size_t begin, std::size_t end) {
      StrandCurve curve;
      StyledStrand strand;
      for (std::size_t s = begin; s < end; ++s) runOne(batch, s, curve, strand);
    });
  }

  /// Centres as they are now, and whose they are.
  void findLocks(Active& active, const Context& context) {
    LockChoice choice = chooseLocks(mesh_, embedding_, active.effect->lockCount(), active.group, context);
    active.locks.centreOf = std::move(choice.centreOf);
    active.locks.centres.resize(choice.centres.size());
    centreStrands_ = std::move(choice.centres);
    parallelFor(context, centreStrands_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      StrandCurve curve;
      StyledStrand strand;
      for (std::size_t c = begin; c < end; ++c) {
        load(centreStrands_[c], curve, strand);
        Locks::Centre& centre = active.locks.centres[c];
        centre.place = strand.place;
        for (std::size_t p = 0; p < strand.size(); ++p) {
          centre.points.push_back(strand.position(p)), centre.frames.push_back(strand.frame(p));
        }
        centre.arcs.assign(strand.arcs().begin(), strand.arcs().end());
      }
    });
  }

 private:
  void load(std::size_t s, StrandCurve& curve, StyledStrand& strand) const {
    const std::size_t begin = strands_.offsets[s], size = strands_.offsets[s + 1] - begin;
    const auto points = strands_.strand(s);
    curve.load(points, rootFrame(faces_[embedding_.bundles[s]], points, embedding_.rootTurns[s]));
    strand.index = s;
    strand.place = embedding_.places[s];
    strand.inLock = lockOf_[s] != kNone;
    strand.lock = strand.inLock ? embedding_.places[lockOf_[s]] : strand.place;
    const std::span<const float> widthsOf =
        widths.empty() ? std::span<const float>() : std::span<const float>(widths).subspan(begin, size);
    strand.load(curve, double(reach[s]), std::span(offsets).subspan(begin, size), widthsOf);
  }

  void runOne(std::span<const Active> batch, std::size_t s, StrandCurve& curve, StyledStrand& strand) {
    const std::size_t begin = strands_.offsets[s];
    if (strands_.offsets[s + 1] == begin) return;
    load(s, curve, strand);
    const std::uint64_t lockBefore = strand.inLock ? strand.lock.id : ~std::uint64_t{0};
    const std::uint32_t bundle = embedding_.bundles[s];
    for (const Active& active : batch) {
      if (active.group != kNone && mesh_.bundles()[bundle].group != active.group) continue;
      const double mask = active.mask.empty() ? 1 : atRoot(mesh_, strands_, bundle, s, active.mask);
      const Strength strength{active.op->amount * mask, active.ramp};
      if (strength.whole == 0 && !runIdle_) continue;
      active.effect->run(strand, strength, &active.locks);
    }
    if (strand.inLock && strand.lock.id != lockBefore)
      lockOf_[s] = centreStrands_[batch.front().locks.centreOf[s]];
    reach[s] = float(strand.reach());
    for (std::size_t p = 0; p < strand.size(); ++p) offsets[begin + p] = strand.offsets()[p].cast<float>();
    if (widths.empty()) return;
    for (std::size_t p = 0; p < strand.size(); ++p) widths[begin + p] = float(strand.widths()[p]);
  }

  const HairMesh& mesh_;
  const StrandSet& strands_;
  Embedding embedding_;
  std::vector<Frame> faces_;
  bool runIdle_;
  std::vector<std::uint32_t> lockOf_, centreStrands_;  // strand indices
};

Result<std::vector<Active>> activate(const HairMesh& mesh, const StrandSet& strands,
                                     std::span<const StyleOperator> stack, const StyleOptions& options,
                                     double cm, StyleReport& report) {
  COIF_TRY(validate(stack));
  std::vector<Active> out;
  for (const StyleOperator& op : stack) {
    const std::string leftOut = leftOutReason(op, mesh, strands, options);
    report.operators.push_back({op.name, leftOut.empty(), leftOut});
    if (!leftOut.empty()) continue;
    Active& active = out.emplace_back();
    active.op = &op;
    active.ramp = RampCurve(op.ramp);
    if (!op.mask.empty()) active.mask = maskOf(op.mask, mesh);
    active.group = op.group.empty() ? kNone : groupNamed(mesh, op.group);
    const Vec3 up = strands.upAxis == UpAxis::Z ? Vec3::UnitZ() : Vec3::UnitY();
    active.effect = findKind(op.kind)->make({op, cm, up, options.head});
  }
  return out;
}

Error cancelled() {
  return makeError(ErrorCode::Cancelled, "stopped while styling");
}

bool finite(std::span<const Vec3f> offsets) {
  return std::ranges::all_of(offsets, [](const Vec3f& o) { return o.allFinite(); });
}

}  // namespace

Result<StylePlan> StylePlan::create(const HairMesh& mesh, const StrandSet& strands,
                                    std::span<const StyleOperator> stack, const StyleOptions& options,
                                    const Context& context) try {
  const Stopwatch watch;
  StylePlan plan;
  plan.report_.pointsWanted = coif::pointsWanted(stack, mesh, strands.metersPerUnit);
  const double cm = kMetresPerCm / strands.metersPerUnit;
  COIF_ASSIGN(std::vector<Active> active, activate(mesh, strands, stack, options, cm, plan.report_));
  if (active.empty() || strands.pointCount() == 0) return plan;
  COIF_ASSIGN(Embedding embedding, embed(mesh, strands, cm, context));
  Styling styling(mesh, strands, std::move(embedding), options.runIdle);
  for (std::size_t done = 0; done < active.size();) {
    context.report("styling", double(done) / double(active.size()));
    if (active[done].effect->lockCount() > 0) styling.findLocks(active[done], context);
    std::size_t end = done + 1;  // up to the next one that looks at other strands
    while (end < active.size() && active[end].effect->lockCount() == 0) ++end;
    styling.run(std::span(active).subspan(done, end - done), context);
    active[done].locks = {};
    done = end;
    if (context.cancelled()) return cancelled();
  }
  if (!finite(styling.offsets))
    return makeError(ErrorCode::Degenerate, "the style moves hair to where numbers end; use smaller lengths");
  plan.strandOffsets_ = strands.offsets, plan.ids_ = strands.ids;
  plan.offsets_ = std::move(styling.offsets), plan.reach_ = std::move(styling.reach);
  plan.widths_ = std::move(styling.widths), plan.rootTurns_ = styling.embedding().rootTurns;
  plan.report_.seconds = watch.seconds();
  return plan;
} catch (const std::bad_alloc&) {
  return makeError(ErrorCode::TooLarge,
                   std::to_string(strands.pointCount()) + " points do not fit into memory with their style");
}

Status StylePlan::apply(const HairMesh& mesh, StrandSet& strands, const Context& context) const {
  if (changesNothing()) return {};
  if (strands.offsets != strandOffsets_ || strands.ids != ids_ || strands.rootFaces.size() != ids_.size() ||
      strands.weightOffsets.size() != ids_.size() + 1 ||
      (!widths_.empty() && strands.widths.size() != widths_.size()))
    return makeError(ErrorCode::InvalidArgument, "the style was planned for other strands");
  COIF_ASSIGN(const std::vector<std::uint32_t> bundles, bundlesOf(mesh, strands));
  const std::vector<Frame> faces = rootFaceFrames(mesh);
  parallelFor(context, strands.strandCount(), kGrain, [&](std::size_t begin, std::size_t end) {
    StrandCurve curve;
    for (std::size_t s = begin; s < end; ++s) {
      const auto points = strands.strand(s);
      if (points.empty()) continue;
      curve.load(points, rootFrame(faces[bundles[s]], points, rootTurns_[s]));
      for (std::size_t p = 0; p < curve.size(); ++p) {
        const std::size_t at = strands.offsets[s] + p;
        const double place = double(p) * double(reach_[s]);
        strands.points[at] = styledPoint(curve, place, offsets_[at].cast<double>()).cast<float>();
        if (!widths_.empty()) strands.widths[at] *= widths_[at];
      }
    }
  });
  if (context.cancelled()) return cancelled();
  return {};
}

std::uint64_t StylePlan::bytes() const {
  return strandOffsets_.size() * 8 + ids_.size() * 8 + offsets_.size() * sizeof(Vec3f) +
         (reach_.size() + widths_.size() + rootTurns_.size()) * sizeof(float);
}

Result<StyleReport> applyStyle(const HairMesh& mesh, StrandSet& strands, std::span<const StyleOperator> stack,
                               const StyleOptions& options, const Context& context) {
  COIF_ASSIGN(const StylePlan plan, StylePlan::create(mesh, strands, stack, options, context));
  COIF_TRY(plan.apply(mesh, strands, context));
  return plan.report();
}

std::uint32_t pointsWanted(std::span<const StyleOperator> stack, const HairMesh& mesh, double metersPerUnit) {
  constexpr double kMost = 1000;
  double waves = 0;  // points a centimetre
  for (const StyleOperator& op : stack) {
    const StyleKind* kind = findStyleKind(op.kind);
    if (kind == nullptr || !(kind->pointsPerWave > 0) || !op.enabled || op.amount == 0) continue;
    waves = std::max(waves, kind->pointsPerWave / parameterOf(op, "wavelength"));
  }
  double longest = 0;
  for (const Bundle& bundle : mesh.bundles()) {
    double length = 0;  // mean of its columns
    for (std::uint32_t k = 1; k <= bundle.height(); ++k) {
      for (std::uint32_t i = 0; i < bundle.corners; ++i)
        length += (mesh.position(bundle.face(k)[i]) - mesh.position(bundle.face(k - 1)[i])).norm();
    }
    longest = std::max(longest, length / bundle.corners);
  }
  const double cm = longest * metersPerUnit / kMetresPerCm;
  return waves > 0 ? std::uint32_t(std::min(std::ceil(waves * cm) + 1, kMost)) : 0;
}

}  // namespace coif
