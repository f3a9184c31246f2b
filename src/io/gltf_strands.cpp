// Strands back from a glTF that Coif wrote: points and attributes from the LINES primitives, the rest from
// the table.
#include <bit>
#include <cmath>
#include <cstring>

#include "io/gltf_document.h"
#include "io/gltf_strand_table.h"

namespace coif::io {
namespace {

static_assert(std::endian::native == std::endian::little, "the table is written and read as it lies");

constexpr int kTableVersion = 1;

/// Calls visit(name, bytes of one element, number of elements) for the arrays of the table, in their order.
template <class Visit>
void visitTable(const StrandSet& set, Visit visit) {
  const std::uint64_t s = set.strandCount();
  visit("pointCounts", 4, s);
  visit("ids", 8, set.ids.size());
  visit("groups", 4, set.groups.size());
  visit("rootFaces", 4, set.rootFaces.size());
  visit("weightCounts", 4, set.weightOffsets.empty() ? 0 : s);
  visit("weights", 4, set.weights.size());
  visit("guides", 1, set.guides.size());
}

void writeCounts(const std::vector<std::uint64_t>& offsets, const GltfBuilder::Sink& sink) {
  if (offsets.empty()) return;
  streamValues<std::uint32_t>(sink, offsets.size() - 1,
                              [&](std::uint64_t i) { return std::uint32_t(offsets[i + 1] - offsets[i]); });
}

/// Walks the table and takes arrays from it; `ok` turns false when it is shorter than described.
class TableReader {
 public:
  TableReader(Bytes bytes, const nlohmann::json& arrays, MemoryBudget& budget)
      : bytes_(bytes), arrays_(arrays), budget_(budget) {}

  template <class T>
  Status take(const char* name, std::uint64_t expected, std::vector<T>& out) {
    const auto entry = arrays_.is_object() ? arrays_.find(name) : arrays_.end();
    if (!arrays_.is_object() || entry == arrays_.end()) return {};
    if (!entry->is_number_unsigned()) return bad(name);
    const auto count = entry->get<std::uint64_t>();
    if (expected != kAny && count != expected) return bad(name);
    if (count > (bytes_.size() - at_) / sizeof(T)) return bad(name);
    COIF_TRY(budget_.take(count, sizeof(T)));
    out.resize(count);
    if (count > 0) std::memcpy(out.data(), bytes_.data() + at_, count * sizeof(T));
    at_ += count * sizeof(T);
    return {};
  }
  static constexpr std::uint64_t kAny = ~std::uint64_t{0};

 private:
  Error bad(const char* name) const {
    return makeError(ErrorCode::Malformed, std::string("the strand table's ") + name + " do not fit");
  }
  Bytes bytes_;
  const nlohmann::json& arrays_;
  MemoryBudget& budget_;
  std::size_t at_ = 0;
};

std::vector<std::uint64_t> offsetsFrom(const std::vector<std::uint32_t>& counts) {
  std::vector<std::uint64_t> offsets{0};
  offsets.reserve(counts.size() + 1);
  for (const std::uint32_t count : counts) offsets.push_back(offsets.back() + count);
  return offsets;
}

template <class T>
bool allFinite(const std::vector<T>& values) {
  const auto* numbers = reinterpret_cast<const float*>(values.data());
  return std::all_of(numbers, numbers + values.size() * sizeof(T) / sizeof(float),
                     [](float v) { return std::isfinite(v); });
}

class StrandReader {
 public:
  StrandReader(const GltfDocument& document, MemoryBudget& budget) : document_(document), budget_(budget) {}
  Result<StrandSet> read();

 private:
  Status readDescription();
  Status readPoints();
  Status readTable();
  Status readUvs(int accessor);
  Result<std::uint64_t> number(const char* name, std::uint64_t limit) const;
  const GltfDocument& document_;
  MemoryBudget& budget_;
  nlohmann::json coif_;
  StrandSet set_;
  int uvAccessor_ = -1;
};

Result<std::uint64_t> StrandReader::number(const char* name, std::uint64_t limit) const {
  const auto entry = coif_.find(name);
  if (entry == coif_.end() || !entry->is_number_unsigned() || entry->get<std::uint64_t>() >= limit) {
    return makeError(ErrorCode::Malformed, std::string("asset.extras.coif has no valid ") + name);
  }
  return entry->get<std::uint64_t>();
}

Status StrandReader::readDescription() {
  const auto& asset = document_.json.at("asset");
  const auto extras = asset.find("extras");
  const bool ours = extras != asset.end() && extras->is_object() && extras->contains("coif") &&
                    extras->at("coif").is_object();
  if (!ours) return makeError(ErrorCode::Unsupported, "the glTF holds no strands that Coif wrote");
  coif_ = extras->at("coif");
  COIF_ASSIGN(const std::uint64_t version, number("version", 1000));
  if (version > kTableVersion)
    return makeError(ErrorCode::Unsupported, "the strands were written by a newer Coif");
  const auto unit = coif_.find("metersPerUnit");
  const double metersPerUnit = unit != coif_.end() && unit->is_number() ? unit->get<double>() : 0;
  if (!(metersPerUnit > 0) || !std::isfinite(metersPerUnit))
    return makeError(ErrorCode::Malformed, "metersPerUnit must be positive");
  set_.metersPerUnit = metersPerUnit;
  set_.upAxis = coif_.value("upAxis", "Y") == "Z" ? UpAxis::Z : UpAxis::Y;
  set_.information = coif_.value("information", "");
  const auto names = coif_.find("groupNames");
  if (names != coif_.end()) set_.groupNames = names->get<std::vector<std::string>>();
  return {};
}

Status StrandReader::readPoints() {
  COIF_ASSIGN(const std::uint64_t mesh, number("mesh", document_.model.meshes.size()));
  const auto& primitives = document_.model.meshes[mesh].primitives;
  if (primitives.empty()) return makeError(ErrorCode::Malformed, "the mesh of the strands is empty");
  const auto& attributes = primitives[0].attributes;
  const auto accessor = [&](const char* name) {
    const auto found = attributes.find(name);
    return found == attributes.end() ? -1 : found->second;
  };
  COIF_TRY(readAccessor(document_, accessor("POSITION"), budget_, set_.points));
  if (accessor("_RADIUS") >= 0) COIF_TRY(readAccessor(document_, accessor("_RADIUS"), budget_, set_.widths));
  for (float& width : set_.widths) width *= 2;
  for (const char* name : {"COLOR_0", "_COLOR"}) {
    if (accessor(name) >= 0) COIF_TRY(readAccessor(document_, accessor(name), budget_, set_.colors));
  }
  if (accessor("_TRANSPARENCY") >= 0) {
    COIF_TRY(readAccessor(document_, accessor("_TRANSPARENCY"), budget_, set_.transparencies));
  }
  uvAccessor_ = accessor("_ROOT_UV");
  return {};
}

Status StrandReader::readTable() {
  COIF_ASSIGN(const std::uint64_t view, number("bufferView", document_.model.bufferViews.size()));
  const tinygltf::BufferView& place = document_.model.bufferViews[view];
  const bool exists = place.buffer >= 0 && std::size_t(place.buffer) < document_.buffers.size();
  const Bytes buffer = exists ? document_.buffers[std::size_t(place.buffer)] : Bytes();
  if (place.byteOffset > buffer.size() || place.byteLength > buffer.size() - place.byteOffset) {
    return makeError(ErrorCode::Malformed, "the strand table exceeds its buffer");
  }
  const auto arrays = coif_.find("arrays");
  if (arrays == coif_.end()) return makeError(ErrorCode::Malformed, "asset.extras.coif has no arrays");
  COIF_ASSIGN(const std::uint64_t strands, number("strands", std::uint64_t{1} << 32));
  TableReader table(buffer.subspan(place.byteOffset, place.byteLength), *arrays, budget_);
  std::vector<std::uint32_t> counts, weightCounts;
  COIF_TRY(table.take("pointCounts", strands, counts));
  COIF_TRY(table.take("ids", strands, set_.ids));
  COIF_TRY(table.take("groups", strands, set_.groups));
  COIF_TRY(table.take("rootFaces", strands, set_.rootFaces));
  COIF_TRY(table.take("weightCounts", strands, weightCounts));
  COIF_TRY(table.take("weights", TableReader::kAny, set_.weights));
  COIF_TRY(table.take("guides", strands, set_.guides));
  COIF_TRY(budget_.take(counts.size() + weightCounts.size(), sizeof(std::uint64_t)));
  set_.offsets = offsetsFrom(counts);
  if (!weightCounts.empty()) set_.weightOffsets = offsetsFrom(weightCounts);
  if (set_.offsets.back() != set_.points.size()) {
    return makeError(ErrorCode::Malformed, "the strand table needs " + std::to_string(set_.offsets.back()) +
                                               " points, the file has " + std::to_string(set_.points.size()));
  }
  return {};
}

/// One value a strand, from its first point.
Status StrandReader::readUvs(int accessor) {
  std::vector<Vec2f> perPoint;
  COIF_TRY(readAccessor(document_, accessor, budget_, perPoint));
  if (perPoint.size() != set_.points.size())
    return makeError(ErrorCode::Malformed, "_ROOT_UV and POSITION differ in length");
  COIF_TRY(budget_.reserve(set_.rootUvs, set_.strandCount()));
  for (std::size_t s = 0; s < set_.strandCount(); ++s) {
    const bool empty = set_.offsets[s] == set_.offsets[s + 1];
    set_.rootUvs.push_back(empty ? Vec2f(0, 0) : perPoint[set_.offsets[s]]);
  }
  return {};
}

Result<StrandSet> StrandReader::read() {
  try {
    COIF_TRY(readDescription());
    COIF_TRY(readPoints());
    COIF_TRY(readTable());
    if (uvAccessor_ >= 0) COIF_TRY(readUvs(uvAccessor_));
  } catch (const nlohmann::json::exception&) {
    return makeError(ErrorCode::Malformed, "asset.extras.coif holds values of wrong types");
  }
  if (!allFinite(set_.colors) || !allFinite(set_.transparencies) || !allFinite(set_.rootUvs) ||
      !allFinite(set_.weights)) {
    return makeError(ErrorCode::Degenerate, "a colour, transparency, weight or UV is not finite");
  }
  const Status valid = validate(set_, false);
  if (!valid.ok()) return makeError(ErrorCode::Malformed, valid.error().message, valid.error().place);
  return std::move(set_);
}

}  // namespace

std::uint64_t strandTableBytes(const StrandSet& strands) {
  std::uint64_t bytes = 0;
  visitTable(strands, [&](const char*, std::uint64_t size, std::uint64_t count) { bytes += size * count; });
  return bytes;
}

void writeStrandTable(const StrandSet& set, const GltfBuilder::Sink& sink) {
  const auto whole = [&](const auto& values) { sink(std::as_bytes(std::span(values))); };
  writeCounts(set.offsets, sink);
  whole(set.ids);
  whole(set.groups);
  whole(set.rootFaces);
  writeCounts(set.weightOffsets, sink);
  whole(set.weights);
  whole(set.guides);
}

nlohmann::ordered_json describeStrandTable(const StrandSet& set) {
  nlohmann::ordered_json out{{"version", kTableVersion},
                             {"metersPerUnit", set.metersPerUnit},
                             {"upAxis", set.upAxis == UpAxis::Z ? "Z" : "Y"},
                             {"strands", set.strandCount()}};
  visitTable(set, [&](const char* name, std::uint64_t, std::uint64_t count) {
    if (count > 0) out["arrays"][name] = count;
  });
  if (!set.groupNames.empty()) out["groupNames"] = set.groupNames;
  if (!set.information.empty()) out["information"] = set.information;
  return out;
}

Result<StrandSet> readGltfStrands(Bytes bytes, const std::filesystem::path& path) {
  MemoryBudget budget(bytes.size());
  COIF_ASSIGN(const GltfDocument document, openGltf(bytes, path, budget));
  return StrandReader(document, budget).read();
}

}  // namespace coif::io
