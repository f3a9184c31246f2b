// Strands out of a USD layer: the curves of all prims, one after the other.
#include <utility>

#include "formats.h"
#include "usd_walk.h"

namespace coif::io {
namespace {

using namespace usd;

constexpr double kDefaultDiameterMeters =
    80e-6;                     // a human hair, where some prims say a width and others none
constexpr float kGrey = 0.5f;  // likewise for colours

/// Arrays that only some prims have are filled up for the others.
template <class T>
void join(std::vector<T>& all, std::vector<T>& part, std::size_t before, std::size_t count, const T& rest) {
  if (all.empty() && part.empty()) return;
  all.resize(before, rest);
  part.resize(count, rest);
  if (before == 0) {
    all = std::move(part);
    return;
  }
  all.insert(all.end(), part.begin(), part.end());
  part = {};
}

void append(StrandSet& all, StrandSet part, double metersPerUnit) {
  const std::size_t strands = all.strandCount(), points = all.pointCount();
  const std::size_t moreStrands = part.strandCount(), morePoints = part.pointCount();
  for (std::size_t s = 1; s <= moreStrands; ++s) all.offsets.push_back(points + part.offsets[s]);
  join(all.points, part.points, points, morePoints, Vec3f(Vec3f::Zero()));
  join(all.widths, part.widths, points, morePoints, float(kDefaultDiameterMeters / metersPerUnit));
  join(all.colors, part.colors, points, morePoints, Vec3f(Vec3f::Constant(kGrey)));
  join(all.transparencies, part.transparencies, points, morePoints, 0.f);
  join(all.rootFaces, part.rootFaces, strands, moreStrands, kNone);
  join(all.guides, part.guides, strands, moreStrands, std::uint8_t(0));
  join(all.rootUvs, part.rootUvs, strands, moreStrands, Vec2f(Vec2f::Zero()));
  join(all.groups, part.groups, strands, moreStrands, std::uint32_t(0));
  // Ids and weights are all there or not at all: made-up ones would be lies.
  const bool ids = all.ids.size() == strands && part.ids.size() == moreStrands;
  if (ids) {
    all.ids.insert(all.ids.end(), part.ids.begin(), part.ids.end());
  } else {
    all.ids.clear();
  }
  const bool weighted = (strands == 0 || !all.weightOffsets.empty()) && !part.weightOffsets.empty();
  if (!weighted) {
    all.weightOffsets.clear();
    all.weights.clear();
    return;
  }
  if (strands == 0) all.weightOffsets = {0};
  const std::uint64_t first = all.weights.size();
  for (std::size_t s = 1; s <= moreStrands; ++s) all.weightOffsets.push_back(first + part.weightOffsets[s]);
  all.weights.insert(all.weights.end(), part.weights.begin(), part.weights.end());
}

/// Group names that an export of ours wrote on its root; empty for other files.
std::vector<std::string> statedGroups(const Layer& layer) {
  for (const Prim& prim : layer.prims) {
    const Value* names = prim.value("coif:groupNames");
    if (names != nullptr && names->type.base == Base::String) return names->strings;
  }
  return {};
}

std::string statedInformation(const Layer& layer) {
  for (const Prim& prim : layer.prims) {
    const Value* information = prim.value("coif:information");
    if (information != nullptr) return std::string(information->text());
  }
  return {};
}

std::string shownName(const Prim& prim) {
  const Value* name = find(prim.metadata, "displayName");
  return name != nullptr && !name->text().empty() ? std::string(name->text()) : prim.name;
}

/// One group a prim, unless the file says groups by number and name.
class Groups {
 public:
  explicit Groups(const Layer& layer) : names_(statedGroups(layer)), stated_(!names_.empty()) {}

  void assign(const Prim& prim, StrandSet& part) {
    const bool numbered = part.groups.size() == part.strandCount();
    if (stated_) {
      if (!numbered) part.groups.clear();
      for (std::uint32_t& group : part.groups) group = group < names_.size() ? group : 0;
      return;
    }
    part.groups.assign(part.strandCount(), std::uint32_t(names_.size()));
    names_.push_back(shownName(prim));
  }

  void finish(StrandSet& all) {
    if (!stated_ && names_.size() == 1) all.groups.clear();  // one group needs no array
    all.groupNames = std::move(names_);
  }

 private:
  std::vector<std::string> names_;
  bool stated_;
};

Error inPrim(Error error, const std::string& path) {
  error.place = path + (error.place.empty() ? "" : " " + error.place);
  return error;
}

void describe(StrandSet& set, const Layer& layer, const std::vector<std::string>& notes) {
  set.information = statedInformation(layer);
  for (const std::string& note : notes) set.information += (set.information.empty() ? "" : "\n") + note;
}

Result<StrandSet> readStrands(Bytes bytes, MemoryBudget& budget) {
  COIF_ASSIGN(const Layer layer, readLayer(bytes, budget));
  std::vector<std::string> notes = layer.notes, walkNotes;
  COIF_ASSIGN(const std::vector<Placed> curves, placedPrims(layer, "BasisCurves", budget, walkNotes));
  notes.insert(notes.end(), walkNotes.begin(), walkNotes.end());
  if (curves.empty()) return makeError(ErrorCode::Unsupported, "the file holds no BasisCurves prim");
  StrandSet all;
  all.metersPerUnit = metersPerUnit(layer, 0.01);  // USD's own fallback
  all.upAxis = upAxis(layer);
  Groups groups(layer);
  std::string unusable;
  for (const Placed& placed : curves) {
    std::vector<std::string> said;
    auto part = readCurves(placed, budget, said);
    if (!part) return inPrim(part.error(), placed.path);
    notes.insert(notes.end(), said.begin(), said.end());
    if (part->strandCount() == 0 && !said.empty() && unusable.empty()) unusable = said.front();
    if (part->strandCount() == 0) continue;
    std::vector<std::uint32_t> numbers = std::exchange(part->groups, {});  // named only afterwards
    const Status valid = validate(*part);
    if (!valid) return inPrim(valid.error(), placed.path);
    part->groups = std::move(numbers);
    groups.assign(*placed.prim, *part);
    append(all, std::move(*part), all.metersPerUnit);
  }
  if (all.strandCount() == 0) {
    return makeError(ErrorCode::Degenerate,
                     "the file holds no strand" + (unusable.empty() ? "" : ": " + unusable));
  }
  groups.finish(all);
  describe(all, layer, notes);
  return all;
}

}  // namespace

Result<StrandSet> readUsdStrands(Bytes bytes, const std::filesystem::path& path) {
  MemoryBudget budget(bytes.size());
  auto strands = readStrands(bytes, budget);
  if (!strands) return inFile(strands.error(), path.string());
  return strands;
}

}  // namespace coif::io
