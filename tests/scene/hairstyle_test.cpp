#include "coif/scene/hairstyle.h"

#include <gtest/gtest.h>

#include "coif/hairmesh/invariants.h"
#include "coif/scalp/example_head.h"

namespace coif {
namespace {

struct Mannequin {
  Surface head{makeExampleHead()};
  Region region = automaticCap(head).value();

  Cage cage(std::string_view style) const {
    CageOptions options;
    options.count = int(suggestedCageCount(style));
    return buildCage(head.mesh(), head, region, options).value();
  }
};

TEST(Hairstyle, EveryStyleIsASmallSoundMeshOutsideTheHead) {
  const Mannequin mannequin;
  for (const std::string_view style : hairstyleNames()) {
    const Cage cage = mannequin.cage(style);
    const auto made = modelHairstyle(style, cage, mannequin.head);
    ASSERT_TRUE(made.ok()) << style << ": " << made.error().text();
    EXPECT_TRUE(checkInvariants(made->mesh).empty()) << style;
    EXPECT_LE(made->mesh.vertices().size(), 1500u) << style;
    for (const HairVertex& vertex : made->mesh.vertices()) {
      if (vertex.layer > 0) {
        ASSERT_GT(mannequin.head.signedDistance(vertex.position), 0) << style;
      }
    }
    for (const Bundle& bundle : made->mesh.bundles()) EXPECT_GE(bundle.height(), 1u) << style;
  }
}

TEST(Hairstyle, PartedStylesAreSymmetric) {
  const Mannequin mannequin;
  for (const std::string_view style : {"bob", "long", "mohawk"}) {
    const Cage cage = mannequin.cage(style);
    const auto made = modelHairstyle(style, cage, mannequin.head);
    ASSERT_TRUE(made.ok()) << style;
    // An inner vertex may be pinned to its guide on one side and left up to 0.015 head heights from it on the other.
    const double tolerance = 0.015 * cage.frame.height;
    double worst = 0;
    for (const HairVertex& vertex : made->mesh.vertices()) {
      const Vec3 mirrored = cage.mirror->reflect(vertex.position);
      double nearest = 1e300;
      for (const HairVertex& other : made->mesh.vertices()) {
        if (other.layer == vertex.layer) nearest = std::min(nearest, (other.position - mirrored).norm());
      }
      worst = std::max(worst, nearest);
    }
    EXPECT_LE(worst, tolerance) << style << ", in head heights: " << worst / cage.frame.height;
  }
}

TEST(Hairstyle, UnknownStylesAndEmptyCagesAreRefused) {
  const Mannequin mannequin;
  const auto unknown = modelHairstyle("beehive", mannequin.cage("bob"), mannequin.head);
  ASSERT_FALSE(unknown.ok());
  EXPECT_NE(unknown.error().text().find("beehive"), std::string::npos);
  EXPECT_FALSE(modelHairstyle("bob", Cage{}, mannequin.head).ok());
}

}  // namespace
}  // namespace coif
