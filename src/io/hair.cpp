// cyHair `.hair`, both ways: a 128-byte header, then the arrays that its flags name. All little-endian.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "io/scan.h"

namespace coif::io {
namespace {

static_assert(std::endian::native == std::endian::little, "the arrays are read and written as they lie");

enum HairFlag : std::uint32_t { kSegments = 1, kPoints = 2, kThickness = 4, kTransparency = 8, kColor = 16 };

struct HairHeader {
  char magic[4] = {'H', 'A', 'I', 'R'};
  std::uint32_t strands = 0;
  std::uint32_t points = 0;
  std::uint32_t flags = 0;
  std::uint32_t defaultSegments = 0;
  float defaultThickness = 0;
  float defaultTransparency = 0;
  float defaultColor[3] = {};
  char information[88] = {};
};
static_assert(sizeof(HairHeader) == 128);

constexpr std::uint64_t kMaxSegments = 65535;

std::string strandPlace(std::uint64_t s) {
  return "strand " + std::to_string(s);
}

class HairReader {
 public:
  HairReader(Bytes bytes, const std::filesystem::path& path)
      : bytes_(bytes), path_(path), budget_(bytes.size()) {}
  Result<StrandSet> read();

 private:
  Status readHeader();
  Status checkSize() const;
  Status readOffsets();
  template <class T>
  Status readArray(std::vector<T>& out);
  Status readArrays();
  Status fillDefaults();
  Status checkNumbers() const;
  void dropSinglePoints();
  bool has(HairFlag flag) const { return (header_.flags & flag) != 0; }
  Error fail(ErrorCode code, const std::string& message, const std::string& place = {}) const {
    return makeError(code, message, place, path_.string());
  }

  Bytes bytes_;
  const std::filesystem::path& path_;
  MemoryBudget budget_;
  HairHeader header_;
  std::size_t at_ = sizeof(HairHeader);
  StrandSet set_;
};

Status HairReader::readHeader() {
  if (bytes_.size() < 4 || std::memcmp(bytes_.data(), "HAIR", 4) != 0) {
    return fail(ErrorCode::Malformed, "not a cyHair file: it does not begin with HAIR", "byte 0");
  }
  if (bytes_.size() < sizeof header_) return fail(ErrorCode::Malformed, "the header of 128 bytes ends early");
  std::memcpy(&header_, bytes_.data(), sizeof header_);
  if (!has(kPoints)) return fail(ErrorCode::Malformed, "the flags name no array of points", "byte 12");
  if (header_.strands == 0) return fail(ErrorCode::Degenerate, "the file holds no strand", "byte 4");
  const auto end = std::find(std::begin(header_.information), std::end(header_.information), '\0');
  set_.information.assign(std::begin(header_.information), end);
  return {};
}

/// Everything the header promises must be there before anything is allocated for it.
Status HairReader::checkSize() const {
  const std::uint64_t perPoint =
      12u + (has(kThickness) ? 4u : 0u) + (has(kTransparency) ? 4u : 0u) + (has(kColor) ? 12u : 0u);
  const std::uint64_t needed =
      sizeof(HairHeader) + (has(kSegments) ? 2ull * header_.strands : 0ull) + perPoint * header_.points;
  if (needed > bytes_.size()) {
    return fail(ErrorCode::Malformed, "the header promises " + std::to_string(header_.strands) +
                                          " strands and " + std::to_string(header_.points) + " points in " +
                                          std::to_string(needed) + " bytes, but the file has " +
                                          std::to_string(bytes_.size()));
  }
  return {};
}

Status HairReader::readOffsets() {
  COIF_TRY(budget_.reserve(set_.offsets, std::uint64_t(header_.strands) + 1));
  std::uint64_t total = 0;
  for (std::uint64_t s = 0; s < header_.strands; ++s) {
    std::uint64_t segments = header_.defaultSegments;
    if (has(kSegments)) {
      std::uint16_t stored = 0;
      std::memcpy(&stored, bytes_.data() + at_, 2);
      at_ += 2;
      segments = stored;
    }
    total += segments + 1;
    if (total > header_.points) {
      return fail(ErrorCode::Malformed,
                  "the strands need more points than the header's " + std::to_string(header_.points),
                  strandPlace(s));
    }
    set_.offsets.push_back(total);
  }
  if (total != header_.points) {
    return fail(ErrorCode::Malformed, "the strands use " + std::to_string(total) +
                                          " points, the header states " + std::to_string(header_.points));
  }
  return {};
}

template <class T>
Status HairReader::readArray(std::vector<T>& out) {
  COIF_TRY(budget_.take(header_.points, sizeof(T)));
  out.resize(header_.points);
  std::memcpy(static_cast<void*>(out.data()), bytes_.data() + at_, out.size() * sizeof(T));
  at_ += out.size() * sizeof(T);
  return {};
}

Status HairReader::readArrays() {
  COIF_TRY(readArray(set_.points));
  if (has(kThickness)) COIF_TRY(readArray(set_.widths));
  if (has(kTransparency)) COIF_TRY(readArray(set_.transparencies));
  if (has(kColor)) COIF_TRY(readArray(set_.colors));
  return {};
}

/// A default that says something becomes an array, so that it is not lost; a thickness or transparency of 0
/// says nothing, and every file states some default colour.
Status HairReader::fillDefaults() {
  const auto fill = [&](HairFlag flag, float value, std::vector<float>& out, const char* what) -> Status {
    if (has(flag) || value == 0) return {};
    if (!std::isfinite(value) || value < 0) {
      return fail(ErrorCode::Degenerate, std::string("the default ") + what + " is negative or not finite");
    }
    COIF_TRY(budget_.take(header_.points, sizeof(float)));
    out.assign(header_.points, value);
    return {};
  };
  COIF_TRY(fill(kThickness, header_.defaultThickness, set_.widths, "thickness"));
  COIF_TRY(fill(kTransparency, header_.defaultTransparency, set_.transparencies, "transparency"));
  if (!has(kColor)) {
    const auto* c = header_.defaultColor;
    set_.notes.push_back("The header's default colour (" + std::to_string(c[0]) + ", " +
                         std::to_string(c[1]) + ", " + std::to_string(c[2]) + ") is left out.");
  }
  return {};
}

Status HairReader::checkNumbers() const {
  for (std::uint64_t s = 0; s + 1 < set_.offsets.size(); ++s) {
    for (std::uint64_t p = set_.offsets[s]; p < set_.offsets[s + 1]; ++p) {
      const bool pointOk = set_.points[p].allFinite();
      const bool restOk = (set_.widths.empty() || (std::isfinite(set_.widths[p]) && set_.widths[p] >= 0)) &&
                          (set_.transparencies.empty() || std::isfinite(set_.transparencies[p])) &&
                          (set_.colors.empty() || set_.colors[p].allFinite());
      if (pointOk && restOk) continue;
      return fail(ErrorCode::Degenerate,
                  pointOk ? "a thickness is negative, or a thickness, transparency or colour is not finite"
                          : "a position is not finite",
                  strandPlace(s) + ", point " + std::to_string(p - set_.offsets[s]));
    }
  }
  return {};
}

/// A strand of one point has no length and no direction; nothing later can use it.
void HairReader::dropSinglePoints() {
  const std::size_t before = set_.strandCount();
  std::size_t strands = 0, points = 0;
  for (std::size_t s = 0; s < before; ++s) {
    const std::size_t begin = set_.offsets[s], end = set_.offsets[s + 1];
    if (end - begin < 2) continue;
    const auto move = [&](auto& values) {
      if (!values.empty())
        std::copy(values.begin() + long(begin), values.begin() + long(end), values.begin() + long(points));
    };
    move(set_.points);
    move(set_.widths);
    move(set_.transparencies);
    move(set_.colors);
    points += end - begin;
    set_.offsets[++strands] = points;
  }
  if (strands == before) return;
  const auto shrink = [&](auto& values) {
    if (!values.empty()) values.resize(points);
  };
  shrink(set_.points);
  shrink(set_.widths);
  shrink(set_.transparencies);
  shrink(set_.colors);
  set_.offsets.resize(strands + 1);
  set_.notes.push_back(std::to_string(before - strands) + " strands of a single point are left out.");
}

Result<StrandSet> HairReader::read() {
  COIF_TRY(readHeader());
  COIF_TRY(checkSize());
  COIF_TRY(readOffsets());
  COIF_TRY(readArrays());
  if (at_ < bytes_.size()) {
    set_.notes.push_back(std::to_string(bytes_.size() - at_) + " bytes after the last array are left out.");
  }
  COIF_TRY(fillDefaults());
  COIF_TRY(checkNumbers());
  dropSinglePoints();
  if (set_.strandCount() == 0) return fail(ErrorCode::Degenerate, "no strand has two points");
  return std::move(set_);
}

/// The one value of the array, bit for bit; false when it has several or none.
bool uniformValue(std::span<const float> values, float& value) {
  if (values.empty()) return false;
  value = values[0];
  return std::all_of(values.begin(), values.end(), [&](float v) {
    return std::bit_cast<std::uint32_t>(v) == std::bit_cast<std::uint32_t>(value);
  });
}

Status checkStrandLengths(const StrandSet& set, const std::filesystem::path& path) {
  constexpr std::uint64_t kMaxCount = 0xffffffffu;
  if (set.strandCount() > kMaxCount || set.pointCount() > kMaxCount) {
    return makeError(ErrorCode::TooLarge, ".hair counts strands and points in 32 bits", {}, path.string());
  }
  for (std::size_t s = 0; s < set.strandCount(); ++s) {
    const std::uint64_t points = set.offsets[s + 1] - set.offsets[s];
    if (points == 0) {
      return makeError(ErrorCode::InvalidArgument, ".hair cannot hold a strand without points",
                       strandPlace(s), path.string());
    }
    if (points > kMaxSegments + 1) {
      return makeError(ErrorCode::TooLarge,
                       "the strand has " + std::to_string(points) + " points; .hair holds 65536 at most",
                       strandPlace(s), path.string());
    }
  }
  return {};
}

/// What the format has no place for, a sentence each.
std::vector<std::string> lostBy(const StrandExport& what) {
  const StrandSet& set = *what.strands;
  std::vector<std::string> notes{".hair states no unit and no up axis."};
  std::string lost;
  const std::pair<bool, const char*> parts[] = {{!set.ids.empty(), "ids"},
                                                {!set.rootFaces.empty(), "root faces"},
                                                {!set.weights.empty(), "root weights"},
                                                {!set.rootUvs.empty(), "root UVs"},
                                                {!set.groups.empty(), "groups"},
                                                {!set.guides.empty(), "guide flags"},
                                                {what.hairMesh != nullptr, "the hair mesh"},
                                                {what.head != nullptr, "the head"},
                                                {!what.frames.empty(), "animation"}};
  for (const auto& [there, name] : parts) {
    if (there) lost += (lost.empty() ? "" : ", ") + std::string(name);
  }
  if (!lost.empty()) notes.push_back(".hair has no place for: " + lost + ".");
  return notes;
}

}  // namespace

Result<StrandSet> readHair(Bytes bytes, const std::filesystem::path& path) {
  return HairReader(bytes, path).read();
}

Result<WriteReport> writeHair(const StrandExport& what, const std::filesystem::path& path,
                              const Context& context) {
  const StrandSet& set = *what.strands;
  COIF_TRY(checkStrandLengths(set, path));
  WriteReport report{0, lostBy(what)};

  HairHeader header;
  header.strands = std::uint32_t(set.strandCount());
  header.points = std::uint32_t(set.pointCount());
  header.flags = kPoints;
  const std::uint64_t firstSegments = set.offsets[1] - 1;
  bool sameSegments = true;
  for (std::size_t s = 0; s < set.strandCount(); ++s) {
    sameSegments = sameSegments && set.offsets[s + 1] - set.offsets[s] - 1 == firstSegments;
  }
  if (sameSegments) {
    header.defaultSegments = std::uint32_t(firstSegments);
  } else {
    header.flags |= kSegments;
  }
  if (set.widths.empty()) {
    header.defaultThickness = float(kUsualHairWidth / set.metersPerUnit);
    report.notes.push_back(
        "The strands have no widths: the default thickness is that of a usual hair, 70 micrometres.");
  } else if (!uniformValue(set.widths, header.defaultThickness)) {
    header.flags |= kThickness;
  }
  if (!set.transparencies.empty() && !uniformValue(set.transparencies, header.defaultTransparency)) {
    header.flags |= kTransparency;
  }
  if (!set.colors.empty()) header.flags |= kColor;
  for (int i = 0; i < 3; ++i) header.defaultColor[i] = what.color[i];
  const std::size_t textBytes = std::min(set.information.size(), sizeof header.information - 1);
  std::copy_n(set.information.begin(), textBytes, header.information);
  if (textBytes < set.information.size()) report.notes.push_back("The information text is cut to 87 bytes.");

  COIF_ASSIGN(SafeFile file, SafeFile::create(path));
  file.write(std::as_bytes(std::span(&header, 1)));
  if (!sameSegments) {
    for (std::size_t s = 0; s < set.strandCount(); ++s) {
      const auto segments = std::uint16_t(set.offsets[s + 1] - set.offsets[s] - 1);
      file.write(std::as_bytes(std::span(&segments, 1)));
    }
  }
  file.writeArray(std::span<const Vec3f>(set.points));
  if (header.flags & kThickness) file.writeArray(std::span<const float>(set.widths));
  if (header.flags & kTransparency) file.writeArray(std::span<const float>(set.transparencies));
  if (header.flags & kColor) file.writeArray(std::span<const Vec3f>(set.colors));
  if (context.cancelled())
    return makeError(ErrorCode::Cancelled, "stopped before the file was replaced", {}, path.string());
  report.bytes = file.position();
  COIF_TRY(file.commit());
  return report;
}

}  // namespace coif::io
