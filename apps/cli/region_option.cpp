#include "region_option.h"

#include <charconv>
#include <cmath>

namespace coif::cli {

namespace {

std::vector<std::string> splitAt(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  while (true) {
    const std::size_t end = text.find(separator, begin);
    parts.push_back(text.substr(begin, end - begin));
    if (end == std::string::npos) return parts;
    begin = end + 1;
  }
}

Error badValue(const std::string& text, const std::string& wanted) {
  return makeError(ErrorCode::InvalidArgument, "'" + text + "' is not " + wanted);
}

template <class T>
bool parseWhole(const std::string& text, T& value) {
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  return code == std::errc() && end == text.data() + text.size();
}

}  // namespace

Result<std::vector<double>> numbers(const std::string& text, std::size_t count) {
  std::vector<double> out;
  for (const std::string& part : splitAt(text, ',')) {
    double value = 0;
    if (!parseWhole(part, value) || !std::isfinite(value)) return badValue(part, "a number");
    out.push_back(value);
  }
  if (out.size() != count) return badValue(text, std::to_string(count) + " numbers with commas between them");
  return out;
}

namespace {

Result<std::vector<std::uint32_t>> faceList(const std::string& text, std::size_t faceCount) {
  std::vector<std::uint32_t> out;
  for (const std::string& part : splitAt(text, ',')) {
    const auto ends = splitAt(part, '-');
    std::uint32_t first = 0, last = 0;
    if (ends.size() > 2 || !parseWhole(ends.front(), first) || !parseWhole(ends.back(), last) ||
        last < first) {
      return badValue(part, "a face number or a range such as 10-20");
    }
    if (last >= faceCount)
      return badValue(part, "within the mesh, which has " + std::to_string(faceCount) + " faces");
    for (std::uint32_t face = first; face <= last; ++face) out.push_back(face);
  }
  return out;
}

}  // namespace

Result<Region> regionFromText(const std::string& text, const Surface& head, const CapOptions& cap) {
  const PolygonMesh& mesh = head.mesh();
  const std::size_t colon = text.find(':');
  const std::string kind = text.substr(0, colon);
  const std::string rest = colon == std::string::npos ? "" : text.substr(colon + 1);
  if (kind == "auto" && colon == std::string::npos) return automaticCap(head, cap);
  if (kind == "all" && colon == std::string::npos) return regionOfAll(mesh);
  if (kind == "group") return regionOfGroups(mesh, splitAt(rest, ','));
  if (kind == "faces") {
    COIF_ASSIGN(const auto faces, faceList(rest, mesh.faceCount()));
    return regionOfFaces(mesh, faces);
  }
  if (kind == "half-space") {
    COIF_ASSIGN(const auto v, numbers(rest, 6));
    return regionOfHalfSpace(mesh, Vec3(v[0], v[1], v[2]), Vec3(v[3], v[4], v[5]));
  }
  if (kind == "sphere") {
    COIF_ASSIGN(const auto v, numbers(rest, 4));
    return regionOfSphere(mesh, Vec3(v[0], v[1], v[2]), v[3]);
  }
  if (kind == "geodesic") {
    COIF_ASSIGN(const auto v, numbers(rest, 4));
    return regionOfGeodesicDisc(head, Vec3(v[0], v[1], v[2]), v[3]);
  }
  if (kind == "shell") {
    std::uint32_t shell = 0;
    if (!parseWhole(rest, shell)) return badValue(rest, "the number of a shell");
    return regionOfShell(mesh, shell);
  }
  return badValue(text, std::string("a region: ") + kRegionHelp);
}

}  // namespace coif::cli
