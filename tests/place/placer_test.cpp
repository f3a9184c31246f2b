// Placer: place() on a mesh that keeps its topology, without factoring again.
#include <gtest/gtest.h>

#include <random>

#include "coif/place/place.h"
#include "make_mesh.h"

namespace coif {
namespace {

/// The outer vertices of `mesh`, moved at random.
HairMesh moved(HairMesh mesh, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> by(-0.3, 0.3);
  const auto external = externalVertices(mesh);
  for (std::uint32_t v = 0; v < external.size(); ++v) {
    if (external[v]) mesh.setPosition(v, mesh.position(v) + Vec3(by(random), by(random), by(random)));
  }
  return mesh;
}

TEST(Placer, SameBytesAsPlace) {
  for (const bool mixed : {false, true}) {
    placetest::Columns columns = placetest::grid(6, 6, 5);
    if (mixed) placetest::mixHeights(columns, 6, 2, 7);
    const HairMesh mesh = placetest::build(columns, placetest::shaken(0.2, 3));
    const auto placer = Placer::create(mesh);
    ASSERT_TRUE(placer.ok()) << placer.error().text();
    for (unsigned seed : {1u, 2u, 3u}) {
      HairMesh once = moved(mesh, seed), again = once;
      ASSERT_TRUE(place(once).ok());
      ASSERT_TRUE(placer->place(again).ok());
      EXPECT_EQ(once, again);
    }
  }
}

TEST(Placer, RefusesOtherPinsAndTopology) {
  const HairMesh mesh = placetest::build(placetest::grid(4, 4, 3), placetest::shaken(0.1, 5));
  const auto placer = Placer::create(mesh);
  ASSERT_TRUE(placer.ok());
  HairMesh pinned = mesh;
  const auto external = externalVertices(mesh);
  for (std::uint32_t v = 0; v < external.size(); ++v) {
    if (!external[v]) pinned.setPinned(v, true);
  }
  const HairMesh before = pinned;
  EXPECT_FALSE(placer->fits(pinned));
  EXPECT_EQ(placer->place(pinned).error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(pinned, before);
  EXPECT_FALSE(placer->fits(placetest::build(placetest::grid(4, 4, 2), placetest::shaken(0, 5))));
}

}  // namespace
}  // namespace coif
