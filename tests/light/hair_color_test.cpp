#include "coif/light/hair_color.h"

#include <gtest/gtest.h>

#include <cmath>

namespace coif {
namespace {

TEST(HairColor, AlbedoComesBack) {
  for (const double roughness : {0.0, 0.3, 1.0}) {
    const Vec3 albedo(0.05, 0.4, 0.9);
    EXPECT_LT((albedoFromAbsorption(absorptionFromAlbedo(albedo, roughness), roughness) - albedo).norm(),
              1e-12);
  }
  EXPECT_EQ(absorptionFromAlbedo(Vec3::Ones(), 0.3), Vec3::Zero());
}

TEST(HairColor, MelaninAddsUp) {
  const Vec3 both = absorptionFromMelanin({2, 3});
  EXPECT_LT((both - absorptionFromMelanin({2, 0}) - absorptionFromMelanin({0, 3})).norm(), 1e-12);
  EXPECT_LT((absorptionFromMelanin({1, 0}) - Vec3(0.419, 0.697, 1.37)).norm(), 1e-12);  // d'Eon et al. 2011
  EXPECT_EQ(absorptionFromMelanin({-1, std::nan("")}), Vec3::Zero());
}

TEST(HairColor, PresetsAreInOrder) {
  const auto albedo = [](HairColor color) { return albedoFromAbsorption(absorptionOf(color), 0.3); };
  EXPECT_LT(albedo(HairColor::Black).maxCoeff(), 0.06);
  EXPECT_LT(albedo(HairColor::Black).sum(), albedo(HairColor::Brown).sum());
  EXPECT_LT(albedo(HairColor::Brown).sum(), albedo(HairColor::Blond).sum());
  const Vec3 red = albedo(HairColor::Red), grey = albedo(HairColor::Grey), dyed = albedo(HairColor::Dyed);
  EXPECT_GT(red.x(), 2 * red.z());
  EXPECT_EQ(grey.x(), grey.z());
  EXPECT_GT(dyed.z(), dyed.x());
}

TEST(HairColor, BrokenInputIsHeld) {
  const Vec3 out = absorptionFromAlbedo(Vec3(std::nan(""), -1, 5), std::nan(""));
  EXPECT_TRUE(out.allFinite());
  EXPECT_EQ(out.z(), 0);
  EXPECT_EQ(albedoFromAbsorption(Vec3(std::nan(""), -1, 0), 0.3), Vec3::Ones());
}

}  // namespace
}  // namespace coif
