#include "coif/strands/strand_set.h"

#include <gtest/gtest.h>

#include <limits>

namespace coif {
namespace {

StrandSet twoStrands() {
  StrandSet set;
  set.offsets = {0, 2, 5};
  set.points.assign(5, Vec3f(1, 2, 3));
  set.widths.assign(5, 0.1f);
  set.ids = {7, 8};
  set.groups = {0, 1};
  set.groupNames = {"front", "back"};
  set.weightOffsets = {0, 3, 7};
  set.weights.assign(7, 0.25f);
  return set;
}

TEST(StrandSet, AcceptsWholeAndEmptySets) {
  EXPECT_TRUE(validate(StrandSet{}).ok());
  EXPECT_TRUE(validate(twoStrands()).ok());
  EXPECT_EQ(twoStrands().strand(1).size(), 3u);
  EXPECT_EQ(twoStrands().bytes(), 3 * 8 + 5 * 12 + 5 * 4 + 2 * 8 + 2 * 4 + 3 * 8 + 7 * 4u);
}

void expectRefused(void (*spoil)(StrandSet&), const std::string& words) {
  StrandSet set = twoStrands();
  spoil(set);
  const Status status = validate(set);
  ASSERT_FALSE(status.ok()) << words;
  EXPECT_NE(status.error().text().find(words), std::string::npos) << status.error().text();
}

TEST(StrandSet, RefusesWhatDoesNotFitAndNamesIt) {
  expectRefused([](StrandSet& s) { s.offsets.clear(); }, "start with 0");
  expectRefused([](StrandSet& s) { s.offsets = {0, 6, 5}; }, "strand 1");
  expectRefused([](StrandSet& s) { s.offsets = {0, 2, 4}; }, "end at 4");
  expectRefused([](StrandSet& s) { s.widths.pop_back(); }, "widths has 4 elements, not 5");
  expectRefused([](StrandSet& s) { s.ids.push_back(9); }, "ids");
  expectRefused([](StrandSet& s) { s.groups[1] = 2; }, "strand 1");
  expectRefused([](StrandSet& s) { s.weights.pop_back(); }, "weight offsets");
  expectRefused([](StrandSet& s) { s.weightOffsets.clear(); }, "without weight offsets");
  expectRefused([](StrandSet& s) { s.points[3].y() = std::numeric_limits<float>::quiet_NaN(); },
                "strand 1, point 1");
  expectRefused([](StrandSet& s) { s.widths[0] = std::numeric_limits<float>::infinity(); },
                "strand 0, point 0");
}

TEST(StrandSet, MayHoldValuesThatAreNotFiniteOnRequest) {
  StrandSet set = twoStrands();
  set.points[0].x() = std::numeric_limits<float>::infinity();
  EXPECT_TRUE(validate(set, false).ok());
}

}  // namespace
}  // namespace coif
