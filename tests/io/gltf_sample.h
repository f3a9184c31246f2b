// Strands, a head and a hair mesh that use everything an export can carry.
#pragma once

#include <array>
#include <cmath>

#include "coif/hairmesh/hair_mesh.h"
#include "coif/io/strand_io.h"

namespace coif::test {

/// Curled strands around a ring, of different lengths; only what every set has.
inline StrandSet plainStrands() {
  StrandSet set;
  set.metersPerUnit = 0.01;
  set.upAxis = UpAxis::Z;
  for (int s = 0; s < 30; ++s) {
    const double angle = 2 * M_PI * s / 30;
    for (int i = 0; i < 2 + s % 7; ++i) {
      const double r = 8 + 0.3 * std::sin(2.1 * i + s);
      set.points.emplace_back(
          Vec3(r * std::cos(angle + 0.05 * i), r * std::sin(angle), 12 - 1.1 * i).cast<float>());
    }
    set.offsets.push_back(set.points.size());
  }
  return set;
}

/// All optional arrays; three groups, of which one is empty; a strand of one point and one without length.
inline StrandSet fullStrands() {
  StrandSet set = plainStrands();
  set.points.emplace_back(1, 2, 3);
  set.offsets.push_back(set.points.size());
  for (int i = 0; i < 3; ++i) set.points.emplace_back(4, 5, 6);
  set.offsets.push_back(set.points.size());
  set.groupNames = {"front", "never used", "ba\"ck \xc3\xa4"};
  set.information = "line one\nline two";
  set.weightOffsets = {0};
  for (std::size_t s = 0; s < set.strandCount(); ++s) {
    set.ids.push_back(0xfedcba9876543210ull + s);
    set.rootFaces.push_back(std::uint32_t(4000000000u - s));
    set.rootUvs.emplace_back(float(s) / 31, 1.0f / float(s + 1));
    set.groups.push_back(s % 3 == 0 ? 2 : 0);
    set.guides.push_back(s % 5 == 0);
    for (std::size_t w = 0; w < 3 + s % 2; ++w) set.weights.push_back(1.0f / float(w + s + 1));
    set.weightOffsets.push_back(set.weights.size());
  }
  for (std::size_t p = 0; p < set.pointCount(); ++p) {
    set.widths.push_back(0.01f / float(p + 3));
    set.colors.emplace_back(0.1f, float(p % 10) / 10, 0.9f);
    set.transparencies.push_back(float(p % 4) / 4);
  }
  return set;
}

/// An open box from −1 to 1 of four quads, a fifth made of a quad beside one triangle; UVs are the x and z of
/// a corner.
inline PolygonMesh sampleHead() {
  PolygonMesh mesh;
  mesh.upAxis = UpAxis::Z;
  mesh.metersPerUnit = 0.01;
  for (int i = 0; i < 8; ++i) mesh.positions.emplace_back(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
  for (const std::array<std::uint32_t, 4>& quad :
       {std::array{0u, 2u, 3u, 1u}, {0u, 1u, 5u, 4u}, {1u, 3u, 7u, 5u}, {3u, 2u, 6u, 7u}, {2u, 0u, 4u, 6u}}) {
    mesh.addFace(quad);
  }
  mesh.addFace(std::array{4u, 5u, 7u});
  for (const std::uint32_t corner : mesh.corners) {
    const Vec3& p = mesh.positions[corner];
    mesh.cornerUvs.emplace_back((p.x() + 1) / 2, (p.z() + 1) / 2);
  }
  return mesh;
}

/// Two bundles side by side, the first one layer high, the second flat.
inline HairMesh sampleHairMesh() {
  std::vector<HairVertex> vertices;
  for (std::uint32_t i = 0; i < 10; ++i) {
    const bool upper = i >= 6;
    const std::uint32_t parent = upper ? i - 6 : kNone;
    const std::uint32_t column = upper ? i - 6 : i;
    vertices.push_back(
        {VertexId(i), Vec3(column / 2, column % 2, upper ? 1 : 0), parent, upper ? 1u : 0u, false});
  }
  std::vector<Bundle> bundles{{BundleId(0), 4, 0, {0, 2, 3, 1, 6, 8, 9, 7}},
                              {BundleId(1), 4, 0, {2, 4, 5, 3}}};
  auto mesh = HairMesh::fromParts(vertices, bundles, {}, {"hair"}, 10, 2);
  EXPECT_TRUE(mesh.ok()) << mesh.error().text();
  return mesh.ok() ? std::move(*mesh) : HairMesh();
}

}  // namespace coif::test
