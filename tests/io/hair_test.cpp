#include <gtest/gtest.h>

#include <cstring>

#include "io/mesh_helpers.h"

namespace coif {
namespace {

using namespace test;

StrandSet sample() {
  StrandSet set;
  set.offsets = {0, 2, 5};
  set.points = {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {1, 2, 0.1f}};
  set.information = "made by a test";
  return set;
}

Result<WriteReport> save(const StrandSet& set, const std::filesystem::path& path) {
  StrandExport what;
  what.strands = &set;
  what.color = Vec3f(0.3f, 0.2f, 0.1f);
  return saveStrands(what, path);
}

/// Header fields by their byte, as the format's table has them.
struct Header {
  explicit Header(const std::string& bytes) { std::memcpy(field, bytes.data(), 40); }
  std::uint32_t u32(int byte) const { return field[byte / 4]; }
  float f32(int byte) const {
    float value;
    std::memcpy(&value, &field[byte / 4], 4);
    return value;
  }
  std::uint32_t field[10];
};

TEST(Hair, EveryArrayComesBack) {
  StrandSet set = sample();
  set.widths = {0.1f, 0.2f, 0.3f, 0.4f, 0.5f};
  set.transparencies = {0, 0.5f, 0, 1, 0};
  set.colors.assign(5, Vec3f(1, 0.5f, 0.25f));
  TempFolder folder;
  const auto report = save(set, folder / "a.hair");
  ASSERT_TRUE(report.ok()) << report.error().text();
  const std::string bytes = getFile(folder / "a.hair");
  EXPECT_EQ(report->bytes, bytes.size());
  EXPECT_EQ(bytes.size(), 128 + 2 * 2 + 5 * (12 + 4 + 4 + 12));
  EXPECT_EQ(bytes.substr(0, 4), "HAIR");
  EXPECT_EQ(Header(bytes).u32(12), 31u);
  EXPECT_STREQ(bytes.c_str() + 40, "made by a test");
  const auto back = loadStrands(folder / "a.hair");
  ASSERT_TRUE(back.ok()) << back.error().text();
  EXPECT_EQ(back->offsets, set.offsets);
  EXPECT_EQ(back->points, set.points);
  EXPECT_EQ(back->widths, set.widths);
  EXPECT_EQ(back->transparencies, set.transparencies);
  EXPECT_EQ(back->colors, set.colors);
  EXPECT_EQ(back->information, set.information);
}

TEST(Hair, OneValueForAllIsADefault) {
  StrandSet set = sample();
  set.offsets = {0, 5};
  set.widths.assign(5, 0.25f);
  set.transparencies.assign(5, 0.5f);
  TempFolder folder;
  ASSERT_TRUE(save(set, folder / "a.hair").ok());
  const std::string bytes = getFile(folder / "a.hair");
  EXPECT_EQ(bytes.size(), 128u + 5 * 12);
  EXPECT_EQ(Header(bytes).u32(12), 2u);
  EXPECT_EQ(Header(bytes).u32(16), 4u);
  EXPECT_EQ(Header(bytes).f32(20), 0.25f);
  EXPECT_EQ(Header(bytes).f32(24), 0.5f);
  EXPECT_EQ(Header(bytes).f32(28), 0.3f);
  const auto back = loadStrands(folder / "a.hair");
  ASSERT_TRUE(back.ok());
  EXPECT_EQ(back->widths, set.widths);
  EXPECT_EQ(back->transparencies, set.transparencies);
}

TEST(Hair, WithoutWidthsTheDefaultIsAUsualHair) {
  StrandSet set = sample();
  set.metersPerUnit = 0.01;
  TempFolder folder;
  const auto report = save(set, folder / "a.hair");
  ASSERT_TRUE(report.ok());
  EXPECT_FLOAT_EQ(Header(getFile(folder / "a.hair")).f32(20), 0.007f);  // 70 µm in centimetres
  EXPECT_TRUE(hasNote(report->notes, "70 micrometres"));
}

TEST(Hair, WhatItCannotHoldIsSaid) {
  StrandSet set = sample();
  set.ids = {1, 2};
  set.groups = {0, 0};
  set.groupNames = {"g"};
  set.information = std::string(100, 'i');
  TempFolder folder;
  const auto report = save(set, folder / "a.hair");
  ASSERT_TRUE(report.ok());
  EXPECT_TRUE(hasNote(report->notes, "ids, groups"));
  EXPECT_TRUE(hasNote(report->notes, "cut to 87"));
  EXPECT_EQ(loadStrands(folder / "a.hair")->information, std::string(87, 'i'));
}

TEST(Hair, ALongStrandIsTooLargeAndTheLongestIsNot) {
  StrandSet set;
  set.offsets = {0, 2, 65538};
  set.points.assign(65538, Vec3f(0, 0, 1));
  TempFolder folder;
  ASSERT_TRUE(save(set, folder / "a.hair").ok());
  EXPECT_EQ(loadStrands(folder / "a.hair")->offsets, set.offsets);
  set.offsets.back() = 65539;
  set.points.emplace_back(0, 0, 2);
  const auto tooLong = save(set, folder / "b.hair");
  ASSERT_FALSE(tooLong.ok());
  EXPECT_EQ(tooLong.error().code, ErrorCode::TooLarge);
  EXPECT_EQ(tooLong.error().place, "strand 1");
  EXPECT_FALSE(std::filesystem::exists(folder / "b.hair"));
}

TEST(Hair, InvalidStrandsAreNotWritten) {
  TempFolder folder;
  StrandSet set = sample();
  set.points[3].y() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(save(set, folder / "a.hair").ok());
  set = sample();
  set.offsets = {0, 0, 5};
  EXPECT_EQ(save(set, folder / "a.hair").error().place, "strand 0");
  EXPECT_EQ(save(StrandSet(), folder / "a.hair").error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(save(sample(), folder / "a.txt").error().code, ErrorCode::Unsupported);
  EXPECT_EQ(folder.entries(), 0u);
}

TEST(Hair, RealFilesRoundTripByteForByte) {
  for (const char* name : {"ponytail", "mohawk", "testhair"}) {
    const auto path = sharedData("strands/" + std::string(name) + ".hair");
    COIF_NEEDS(path);
    const auto set = loadStrands(path);
    ASSERT_TRUE(set.ok()) << set.error().text();
    TempFolder folder;
    // Their default colour is the one thing a StrandSet has no place for; save() above passes the same.
    ASSERT_TRUE(save(*set, folder / "a.hair").ok());
    EXPECT_TRUE(getFile(folder / "a.hair") == getFile(path)) << name;
  }
}

struct TortureCase {
  const char* name;
  bool ok;
  ErrorCode code;
  std::size_t strands;
};

TEST(Hair, TortureFilesLoadOrSayWhy) {
  COIF_NEEDS(sharedData("torture/hair"));
  const ErrorCode none{};
  const TortureCase cases[] = {{"ok_2x3", true, none, 2},
                               {"ok_all_arrays", true, none, 1},
                               {"ok_segments", true, none, 2},
                               {"all_points_equal", true, none, 1},
                               {"zero_segment_strand", true, none, 2},
                               {"bad_magic", false, ErrorCode::Malformed, 0},
                               {"empty", false, ErrorCode::Malformed, 0},
                               {"huge_counts", false, ErrorCode::Malformed, 0},
                               {"nan_points", false, ErrorCode::Degenerate, 0},
                               {"no_points_bit", false, ErrorCode::Malformed, 0},
                               {"seg_sum_too_big", false, ErrorCode::Malformed, 0},
                               {"truncated_points", false, ErrorCode::Malformed, 0}};
  for (const TortureCase& c : cases) {
    const auto set = loadStrands(sharedData("torture/hair/" + std::string(c.name) + ".hair"));
    ASSERT_EQ(set.ok(), c.ok) << c.name;
    if (!c.ok) {
      EXPECT_EQ(errorOf(set).code, c.code) << set.error().text();
    } else {
      EXPECT_EQ(set->strandCount(), c.strands) << c.name;
    }
  }
  const auto dropped = loadStrands(sharedData("torture/hair/zero_segment_strand.hair"));
  EXPECT_EQ(dropped->offsets, (std::vector<std::uint64_t>{0, 3, 6}));
  EXPECT_TRUE(hasNote(dropped->notes, "1 strands of a single point"));
  const auto nan = loadStrands(sharedData("torture/hair/nan_points.hair"));
  EXPECT_EQ(nan.error().place, "strand 0, point 1");
}

}  // namespace
}  // namespace coif
