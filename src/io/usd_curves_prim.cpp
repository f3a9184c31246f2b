// The strands of one BasisCurves prim.
#include <Eigen/LU>
#include <cmath>
#include <cstring>
#include <unordered_map>
#include <utility>

#include "usd_curves.h"
#include "usd_walk.h"

namespace coif::io::usd {
namespace {

/// The curves of one prim: which are kept, and how their vertices become strand points.
struct Layout {
  CurveKind kind;
  std::vector<std::uint32_t> sizes;           ///< control vertices of each curve
  std::vector<std::uint64_t> firstVertex{0};  ///< curves + 1
  std::vector<std::uint64_t> firstVarying{0};
  std::vector<std::uint32_t> kept;
  std::unordered_map<std::uint32_t, std::vector<Tap>> taps;  ///< by size; looked up, never walked
  std::vector<std::uint64_t> offsets{0};                     ///< of the strands
};

class CurvesImport {
 public:
  CurvesImport(const Placed& placed, MemoryBudget& budget)
      : placed_(placed), prim_(*placed.prim), budget_(budget) {}

  /// The prim's strands; none when it has no points.
  Result<StrandSet> read() {
    COIF_TRY(arrange());
    if (layout_.kept.empty()) return std::move(set_);
    set_.offsets = layout_.offsets;
    COIF_TRY(points());
    COIF_TRY(widths());
    COIF_TRY(colors());
    perStrand();
    weights();
    return std::move(set_);
  }

  std::vector<std::string> notes;

 private:
  std::string_view text(const char* name) const {
    const Value* value = prim_.value(name);
    return value == nullptr ? std::string_view() : value->text();
  }

  void note(const std::string& what) { notes.push_back(placed_.path + ": " + what); }

  Status arrange() {
    layout_.kind = curveKind(text("type"), text("basis"), text("wrap"));
    const Value* counts = prim_.value("curveVertexCounts");
    const Value* points = prim_.value("points");
    if (counts == nullptr || points == nullptr) {
      note("no points or no counts; left out.");
      return {};
    }
    if (points->type.components != 3) return makeError(ErrorCode::Malformed, "points are not triples");
    COIF_TRY(budget_.take(counts->array.count, 40));
    if (layout_.kind.basis == Basis::Unknown) {
      note("curves of basis '" + std::string(text("basis")) + "' are not read; left out.");
      return {};
    }
    std::size_t invalid = 0, surplus = 0;
    for (const std::int64_t count : numbers<std::int64_t>(*counts)) {
      if (count < 0 || std::uint64_t(count) > points->array.count - layout_.firstVertex.back()) {
        return makeError(ErrorCode::Malformed, "curveVertexCounts do not add up to the points");
      }
      COIF_TRY(addCurve(std::uint32_t(count), invalid, surplus));
    }
    if (layout_.firstVertex.back() != points->array.count) {
      return makeError(ErrorCode::Malformed, "curveVertexCounts do not add up to the points");
    }
    if (invalid > 0)
      note(std::to_string(invalid) + " curves have too few vertices for their kind; left out.");
    if (surplus > 0)
      note(std::to_string(surplus) +
           " Bezier curves have surplus vertices at their ends; those are dropped.");
    if (!layout_.kind.plain() && !layout_.kept.empty()) noteConversion();
    return {};
  }

  void noteConversion() {
    const CurveKind kind = layout_.kind;
    if (kind.basis == Basis::Bspline) note("B-splines became strands through their knots and mid-segments.");
    if (kind.basis == Basis::Bezier) note("Bezier curves became strands through three points a segment.");
    if (kind.basis == Basis::CatmullRom && kind.wrap == Wrap::Open) {
      note("Catmull-Rom curves became strands through the vertices they pass through.");
    }
    if (kind.wrap == Wrap::Periodic) note("Closed curves became strands that end at their root.");
  }

  Status addCurve(std::uint32_t size, std::size_t& invalid, std::size_t& surplus) {
    const auto curve = std::uint32_t(layout_.sizes.size());
    layout_.sizes.push_back(size);
    layout_.firstVertex.push_back(layout_.firstVertex.back() + size);
    layout_.firstVarying.push_back(layout_.firstVarying.back() + varyingCount(layout_.kind, size));
    if (varyingCount(layout_.kind, size) == 0) {
      ++invalid;
      return {};
    }
    const CurveKind kind = layout_.kind;
    surplus += kind.basis == Basis::Bezier && kind.wrap != Wrap::Periodic && (size - 1) % 3 != 0;
    std::uint64_t points = size;
    if (!kind.plain()) {
      const auto [at, isNew] = layout_.taps.try_emplace(size);
      if (isNew) {
        COIF_TRY(budget_.take(2 * std::uint64_t(size) + 4, sizeof(Tap)));
        at->second = curveTaps(kind, size);
      }
      points = at->second.size();
    }
    COIF_TRY(budget_.take(points, sizeof(Vec3f)));
    layout_.kept.push_back(curve);
    layout_.offsets.push_back(layout_.offsets.back() + points);
    return {};
  }

  /// Values of `width` numbers at every strand point, from whatever interpolation fits their number; empty
  /// when none does. A stated interpolation goes first.
  std::vector<float> atPoints(std::vector<float> values, std::string_view stated, std::size_t width) {
    const std::uint64_t count = values.size() / width;
    const std::uint64_t vertices = layout_.firstVertex.back(), varying = layout_.firstVarying.back();
    auto is = [&](std::string_view name, std::uint64_t size) {
      return count == size && (stated == name || stated.empty());
    };
    if (is("vertex", vertices)) return fromVertices(std::move(values), width);
    if (is("varying", varying)) return fromVarying(values, width);
    if (is("uniform", layout_.sizes.size())) return fromCurves(values, width);
    if (count == 1) return repeated(values, width);
    // Layers that state another interpolation than they hold (a common export fault) are read by their
    // number.
    if (count == vertices) return fromVertices(std::move(values), width);
    if (count == layout_.sizes.size()) return fromCurves(values, width);
    return {};
  }

  std::vector<float> fromVertices(std::vector<float> values, std::size_t width) {
    if (layout_.kind.plain() && layout_.kept.size() == layout_.sizes.size()) return values;
    std::vector<float> out(layout_.offsets.back() * width);
    for (std::size_t s = 0; s < layout_.kept.size(); ++s) {
      const std::uint32_t curve = layout_.kept[s];
      const float* in = values.data() + layout_.firstVertex[curve] * width;
      float* to = out.data() + layout_.offsets[s] * width;
      if (layout_.kind.plain()) {
        std::copy(in, in + layout_.sizes[curve] * width, to);
        continue;
      }
      for (const Tap& tap : layout_.taps.at(layout_.sizes[curve])) {
        for (std::size_t c = 0; c < width; ++c, ++to) {
          double sum = 0;
          for (std::size_t i = 0; i < 4; ++i) {
            if (tap.weight[i] != 0) sum += double(tap.weight[i]) * double(in[tap.vertex[i] * width + c]);
          }
          *to = float(sum);
        }
      }
    }
    return out;
  }

  std::vector<float> fromVarying(const std::vector<float>& values, std::size_t width) {
    std::vector<float> out;
    out.reserve(layout_.offsets.back() * width);
    for (const std::uint32_t curve : layout_.kept) {
      const std::uint64_t first = layout_.firstVarying[curve];
      const std::uint64_t knots = layout_.firstVarying[curve + 1] - first;
      const auto taps = layout_.kind.plain() ? curveTaps(layout_.kind, layout_.sizes[curve])
                                             : layout_.taps.at(layout_.sizes[curve]);
      for (const Tap& tap : taps) {
        for (std::size_t c = 0; c < width; ++c) {
          const float a = values[(first + tap.knot) * width + c];
          const float b = values[(first + (tap.knot + 1) % knots) * width + c];
          out.push_back(tap.t == 0 ? a : a + (b - a) * tap.t);
        }
      }
    }
    return out;
  }

  std::vector<float> fromCurves(const std::vector<float>& values, std::size_t width) {
    std::vector<float> out;
    out.reserve(layout_.offsets.back() * width);
    for (std::size_t s = 0; s < layout_.kept.size(); ++s) {
      const auto first = values.begin() + std::ptrdiff_t(layout_.kept[s] * width);
      for (std::uint64_t i = layout_.offsets[s]; i < layout_.offsets[s + 1]; ++i) {
        out.insert(out.end(), first, first + std::ptrdiff_t(width));
      }
    }
    return out;
  }

  std::vector<float> repeated(const std::vector<float>& values, std::size_t width) {
    std::vector<float> out;
    out.reserve(layout_.offsets.back() * width);
    for (std::uint64_t i = 0; i < layout_.offsets.back(); ++i)
      out.insert(out.end(), values.begin(), values.end());
    return out;
  }

  static std::vector<Vec3f> triples(const std::vector<float>& values) {
    std::vector<Vec3f> out(values.size() / 3);
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
    return out;
  }

  Status points() {
    set_.points = triples(fromVertices(numbers<float>(*prim_.value("points")), 3));
    const Eigen::Matrix4d& m = placed_.worldFromPrim;
    if (m.isIdentity(0)) return {};  // the same bits
    for (Vec3f& p : set_.points) {
      p = (m.topLeftCorner<3, 3>() * p.cast<double>() + m.topRightCorner<3, 1>()).cast<float>();
    }
    return {};
  }

  Result<std::vector<float>> primvarAtPoints(const std::string& name, std::size_t width) {
    std::vector<float> values = primvarNumbers(prim_, name, int(width));
    if (values.empty()) return values;
    COIF_TRY(budget_.take(layout_.offsets.back(), width * sizeof(float)));
    values = atPoints(std::move(values), interpolationOf(prim_, name), width);
    if (values.empty()) note("'" + name + "' fits neither points nor curves; left out.");
    return values;
  }

  Status widths() {
    COIF_ASSIGN(set_.widths,
                primvarAtPoints(prim_.value("widths") != nullptr ? "widths" : "primvars:widths", 1));
    const Eigen::Matrix3d turn = placed_.worldFromPrim.topLeftCorner<3, 3>();
    if (turn.isIdentity(0)) return {};
    const auto scale = float(std::cbrt(std::abs(turn.determinant())));
    for (float& width : set_.widths) width *= scale;
    return {};
  }

  Status colors() {
    COIF_ASSIGN(const std::vector<float> colors, primvarAtPoints("primvars:displayColor", 3));
    set_.colors = triples(colors);
    COIF_ASSIGN(set_.transparencies, primvarAtPoints("primvars:coif:transparency", 1));
    if (!set_.transparencies.empty()) return {};
    COIF_ASSIGN(set_.transparencies, primvarAtPoints("primvars:displayOpacity", 1));
    for (float& value : set_.transparencies) value = 1 - value;
    return {};
  }

  /// Integers, one a curve, of the curves that are kept; empty when they are not there or not one a curve.
  std::vector<std::int64_t> uniformIntegers(const char* name) {
    const Value* value = prim_.value(name);
    if (value == nullptr || value->type.components != 1 || value->array.count != layout_.sizes.size())
      return {};
    const std::vector<std::int64_t> all = numbers<std::int64_t>(*value);
    std::vector<std::int64_t> picked;
    picked.reserve(layout_.kept.size());
    for (const std::uint32_t curve : layout_.kept) picked.push_back(all[curve]);
    return picked;
  }

  template <class T>
  static std::vector<T> narrowed(const std::vector<std::int64_t>& values) {
    return std::vector<T>(values.begin(), values.end());
  }

  void perStrand() {
    std::vector<std::int64_t> ids = uniformIntegers("primvars:coif:id");
    if (ids.empty()) ids = uniformIntegers("primvars:groom_id");
    if (ids.empty()) ids = uniformIntegers("primvars:id");
    set_.ids = narrowed<std::uint64_t>(ids);
    set_.rootFaces = narrowed<std::uint32_t>(uniformIntegers("primvars:coif:rootFace"));
    set_.groups = narrowed<std::uint32_t>(uniformIntegers("primvars:groom_group_id"));
    for (const std::int64_t flag : uniformIntegers("primvars:groom_guide")) set_.guides.push_back(flag != 0);
    for (const char* name : {"primvars:st", "primvars:groom_root_uv", "primvars:surface_uv_coordinate"}) {
      if (set_.rootUvs.empty()) readRootUvs(name);
    }
  }

  void readRootUvs(const char* name) {
    const std::vector<float> values = primvarNumbers(prim_, name, 2);
    const bool perCurve = values.size() / 2 == layout_.sizes.size();
    const bool perVertex = !perCurve && values.size() / 2 == layout_.firstVertex.back();
    if (values.empty() || !(perCurve || perVertex)) return;
    for (const std::uint32_t curve : layout_.kept) {
      const std::uint64_t at = perCurve ? curve : layout_.firstVertex[curve];
      set_.rootUvs.emplace_back(values[2 * at], values[2 * at + 1]);
    }
  }

  void weights() {
    const std::vector<std::int64_t> counts = uniformIntegers("coif:rootWeightCounts");
    const Value* value = prim_.value("coif:rootWeights");
    if (counts.empty() || value == nullptr || counts.size() != layout_.sizes.size()) return;
    std::vector<float> all = numbers<float>(*value);
    std::vector<std::uint64_t> offsets{0};
    for (const std::int64_t count : counts) {
      if (count < 0 || std::uint64_t(count) > all.size() - offsets.back()) return;
      offsets.push_back(offsets.back() + std::uint64_t(count));
    }
    if (offsets.back() != all.size()) return;
    set_.weights = std::move(all);
    set_.weightOffsets = std::move(offsets);
  }

  const Placed& placed_;
  const Prim& prim_;
  MemoryBudget& budget_;
  Layout layout_;
  StrandSet set_;
};

}  // namespace

Result<StrandSet> readCurves(const Placed& placed, MemoryBudget& budget, std::vector<std::string>& notes) {
  CurvesImport import(placed, budget);
  auto strands = import.read();
  notes.insert(notes.end(), import.notes.begin(), import.notes.end());
  return strands;
}

}  // namespace coif::io::usd
