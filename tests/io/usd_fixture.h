// Strands with every array that a USD file can carry, and values that are hard to print.
#pragma once

#include <cmath>
#include <filesystem>
#include <limits>
#include <vector>

#include "coif/base/random.h"
#include "coif/io/strand_io.h"

namespace coif {

/// `count` strands of 2 to 9 points in three interleaved groups, all optional arrays filled.
inline StrandSet richStrands(std::size_t count) {
  StrandSet set;
  const CounterRandom random(7);
  set.groupNames = {"front hair", "\"back\"\\\xC3\xA9", "9 lives"};
  set.information = "Two lines\nand a \"quote\"";
  set.metersPerUnit = 0.01;
  set.upAxis = UpAxis::Z;
  set.weightOffsets = {0};
  for (std::size_t s = 0; s < count; ++s) {
    const CounterRandom r = random.child(s);
    const std::uint64_t size = 2 + r.below(0, 8);
    for (std::uint64_t i = 0; i < size; ++i) {
      auto number = [&](std::uint64_t c) { return float(r.uniform(10 + 8 * i + c) * 20 - 10); };
      set.points.emplace_back(number(0), number(1), number(2) * 1e-6f);
      set.widths.push_back(std::abs(number(3)) * 1e-3f);
      set.colors.emplace_back(std::abs(number(4)), 0.5f, 0.1f);
      set.transparencies.push_back(float(r.uniform(10 + 8 * i + 5)));
    }
    set.offsets.push_back(set.points.size());
    set.ids.push_back(r.bits(1));
    set.rootFaces.push_back(r.below(2, 100));
    set.rootUvs.emplace_back(float(r.uniform(3)), float(r.uniform(4)));
    set.groups.push_back(r.below(5, 3));
    set.guides.push_back(r.below(6, 10) == 0);
    const std::uint32_t corners = 3 + r.below(7, 3);
    for (std::uint32_t i = 0; i < corners; ++i) set.weights.push_back(float(r.uniform(100 + i)));
    set.weightOffsets.push_back(set.weights.size());
  }
  // Floats at the ends of the range, and some whose shortest decimals are hard.
  const float odd[] = {0.f,
                       -0.f,
                       std::numeric_limits<float>::denorm_min(),
                       std::numeric_limits<float>::min(),
                       std::numeric_limits<float>::max(),
                       0.1f,
                       16777216.f,
                       8.589973e9f,
                       1.f / 3};
  for (std::size_t i = 0; i < std::size(odd) && i < set.points.size(); ++i) set.points[i].x() = odd[i];
  set.points[4].x() = 1e30f;  // the extent adds a radius: keep it finite
  return set;
}

/// A cube in two groups, with UVs.
inline PolygonMesh groupedCube() {
  PolygonMesh mesh;
  for (int i = 0; i < 8; ++i) mesh.positions.emplace_back(i & 1, (i >> 1) & 1, (i >> 2) & 1);
  const std::uint32_t faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                     {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& face : faces) mesh.addFace(face);
  for (int c = 0; c < 24; ++c) mesh.cornerUvs.emplace_back(c / 32.0, 0.75);
  mesh.faceGroups = {0, 0, 1, 1, 1, 1};
  mesh.groupNames = {"scalp", "the rest"};
  return mesh;
}

/// A folder of this test's own, removed at the end.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(const std::string& name)
      : path_(std::filesystem::temp_directory_path() /
              ("coif_" + name + "_" + std::to_string(std::uintptr_t(this)))) {
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

}  // namespace coif
