#include "coif/strands/density_grid.h"

#include <gtest/gtest.h>

#include <limits>
#include <numeric>

#include "coif/base/lanes.h"
#include "coif/base/random.h"
#include "strands/cell_walk.h"

namespace coif {
namespace {

Vec3 randomPoint(std::uint64_t i, double lo, double hi) {
  const CounterRandom random(3, i);
  return Vec3(lo + (hi - lo) * random.uniform(0), lo + (hi - lo) * random.uniform(1),
              lo + (hi - lo) * random.uniform(2));
}

TEST(ForEachCell, PiecesLieInTheirCellsAndCoverTheSegment) {
  for (std::uint64_t n = 0; n < 500; ++n) {
    Vec3 a = randomPoint(2 * n, -6, 6), b = randomPoint(2 * n + 1, -6, 6);
    if (n % 5 == 0) b.y() = a.y();                         // in a plane of cells
    if (n % 7 == 0) a = a.array().round(), b.z() = a.z();  // from a corner
    double end = 0;
    int cells = 0;
    forEachCell(a, b, [&](long i, long j, long k, double from, double to) {
      EXPECT_EQ(from, end);
      EXPECT_GE(to, from);
      const Vec3 middle = a + 0.5 * (from + to) * (b - a);
      const Vec3 inCell = middle - Vec3(double(i), double(j), double(k));
      EXPECT_GE(inCell.minCoeff(), -1e-12);
      EXPECT_LE(inCell.maxCoeff(), 1 + 1e-12);
      end = to;
      ++cells;
    });
    EXPECT_EQ(end, 1);
    int faces = 0;
    for (int d = 0; d < 3; ++d) faces += int(std::abs(std::floor(b[d]) - std::floor(a[d])));
    EXPECT_EQ(cells, faces + 1);
  }
}

StrandSet tangle(std::size_t count, std::uint64_t seed) {
  StrandSet set;
  for (std::size_t s = 0; s < count; ++s) {
    for (std::uint64_t p = 0; p < 6; ++p) {
      set.points.push_back(randomPoint(seed + 10 * s + p, -2, 1).cast<float>());
      set.widths.push_back(0.01f + 0.001f * float(p));
    }
    set.offsets.push_back(set.points.size());
  }
  return set;
}

double hairVolume(const StrandSet& set) {
  double volume = 0;
  for (std::size_t s = 0; s < set.strandCount(); ++s) {
    for (std::uint64_t p = set.offsets[s]; p + 1 < set.offsets[s + 1]; ++p) {
      const double u = double(set.widths[p]) * double(set.widths[p]),
                   v = double(set.widths[p + 1]) * double(set.widths[p + 1]);
      const double length = (set.points[p + 1].cast<double>() - set.points[p].cast<double>()).norm();
      volume += 3.14159265358979 / 4 * 0.5 * (u + v) * length;  // D² is linear along a segment
    }
  }
  return volume;
}

/// Hair in cells, below zero too, some of it left out: short steps and long ones, along axes and into
/// corners.
struct CellHair {
  std::vector<GridPoint> points;
  std::vector<std::uint64_t> offsets{0};

  void into(GridDeposit& deposit) const {
    deposit.bin(offsets,
                [&](std::size_t begin, std::size_t end, std::span<GridPoint> out) {
                  std::copy(points.begin() + std::ptrdiff_t(offsets[begin]),
                            points.begin() + std::ptrdiff_t(offsets[end]), out.begin());
                },
                {});
  }
};

CellHair cellHair(std::size_t count, double reach) {
  CellHair hair;
  for (std::size_t s = 0; s < count; ++s) {
    for (std::uint64_t p = 0; p < 7; ++p) {
      Vec3 at = randomPoint(7 * s + p, -20, 20 - reach);
      if (p > 0 && s % 3 > 0) {  // on from the last point, a cell or so
        const GridPoint& last = hair.points.back();
        at = Vec3(last.x, last.y, last.z) + randomPoint(99 + 7 * s + p, -1.5, 1.5);
      }
      if (s % 5 == 0) at.y() = std::round(at.y());
      if (s % 11 == 0) at = at.array().round();
      const float weight = s % 17 == 3 && p == 2 ? -1.0f : 0.01f + 0.002f * float((s + p) % 7);
      hair.points.push_back({float(at.x()), float(at.y()), float(at.z()), weight});
    }
    hair.offsets.push_back(hair.points.size());
  }
  return hair;
}

TEST(GridDeposit, EqualsClippingOneSegmentAfterTheOtherInDouble) {
  constexpr int kLog2 = 6;
  constexpr long n = 1L << kLog2;
  const CellHair hair = cellHair(700, 0);
  for (const auto length : {GridDeposit::Length::Whole, GridDeposit::Length::AcrossLast}) {
    GridDeposit deposit(kLog2, length);
    hair.into(deposit);
    ASSERT_TRUE(deposit.fits());
    std::vector<double> expected(std::size_t(n * n * n), 0.0);
    const auto index = [&](long i, long j, long k) {
      const std::size_t slab = std::size_t(j & (n - 1)) / GridDeposit::kSlabRows;
      return slab * deposit.slabCells() + deposit.cellInSlab(i, j, k);
    };
    double whole = 0;
    for (std::size_t s = 0; s + 1 < hair.offsets.size(); ++s) {
      for (std::uint64_t p = hair.offsets[s]; p + 1 < hair.offsets[s + 1]; ++p) {
        const GridPoint &u = hair.points[p], &v = hair.points[p + 1];
        if (u.weight < 0 || v.weight < 0) continue;
        const Vec3 a(u.x, u.y, u.z), b(v.x, v.y, v.z);
        Vec3 d = b - a;
        if (length == GridDeposit::Length::AcrossLast) d.z() = 0;
        forEachCell(a, b, [&](long i, long j, long k, double from, double to) {
          const double weight = double(u.weight) + 0.5 * (from + to) * double(v.weight - u.weight);
          expected[index(i, j, k)] += weight * (to - from) * d.norm();
        });
        whole += 0.5 * double(u.weight + v.weight) * d.norm();
      }
    }
    std::vector<float> found(expected.size());
    double sum = 0;
    for (int slab = 0; slab < deposit.slabCount(); ++slab) {
      deposit.add(slab,
                  std::span(found).subspan(std::size_t(slab) * deposit.slabCells(), deposit.slabCells()));
    }
    for (const float v : found) sum += double(v);
    EXPECT_NEAR(sum / whole, 1, 1e-6);  // rounding of a few thousand floats, up and down
    // Crossings are sums of at most 40 strides, each rounded by 2⁻²⁵ of a step up to 70 cells long that
    // weighs at most 0.024 a cell, of strides rounded themselves: 2.5e-6 a crossing, two of them a cell and
    // step.
    for (std::size_t c = 0; c < found.size(); ++c) ASSERT_NEAR(found[c], expected[c], 1e-5) << c;
  }
}

TEST(GridDeposit, SameBytesForAnyNumberOfLanesAndAgain) {
  const CellHair hair = cellHair(500, 0), other = cellHair(50, 10);
  GridDeposit deposit(6, GridDeposit::Length::AcrossLast);
  other.into(deposit);
  hair.into(deposit);  // nothing of the first is left
  std::vector<float> four(deposit.slabCells()), more(four.size());
  double sum = 0;
  for (int slab = 0; slab < deposit.slabCount(); ++slab) {
    std::ranges::fill(four, 0.0f);
    deposit.add(slab, four, 4);
    for (int lanes = 8; lanes <= widestLanes(); lanes *= 2) {
      std::ranges::fill(more, 0.0f);
      deposit.add(slab, more, lanes);
      ASSERT_EQ(four, more) << lanes;
    }
    if (!deposit.reaches(slab)) {
      EXPECT_EQ(std::ranges::count(four, 0.0f), std::ptrdiff_t(four.size()));
    }
    sum += std::accumulate(four.begin(), four.end(), 0.0);
  }
  EXPECT_GT(sum, 0);
}

TEST(HairVolume, SumsToTheVolumeOfTheHair) {
  const StrandSet set = tangle(200, 1);
  GridFrame frame;
  frame.cell = 0.11;
  frame.log2Size = 5;
  frame.gridFromWorld = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  const auto grid = depositHairVolume(set, frame, 0);
  ASSERT_FALSE(grid.ok());  // three units and their diagonal do not fit 3.5
  frame.cell = 0.2;
  const DensityGrid fine = depositHairVolume(set, frame, 0).value();
  const double sum = std::accumulate(fine.values.begin(), fine.values.end(), 0.0) * std::pow(frame.cell, 3);
  EXPECT_NEAR(sum / hairVolume(set), 1, 1e-5);  // floats, a few thousand of them
}

TEST(HairVolume, CellsHoldWhatDensePointsOnTheHairSay) {
  const StrandSet set = tangle(20, 77);
  GridFrame frame;
  frame.cell = 0.5;
  frame.log2Size = 3;
  frame.origin = Vec3(0.3, -0.2, 0.1);  // negative cells, which have to be floored before they wrap
  const DensityGrid grid = depositHairVolume(set, frame, 0).value();
  std::vector<double> expected(grid.values.size(), 0.0);
  constexpr int kSteps = 4000;
  for (std::size_t s = 0; s < set.strandCount(); ++s) {
    for (std::uint64_t p = set.offsets[s]; p + 1 < set.offsets[s + 1]; ++p) {
      const Vec3 a = set.points[p].cast<double>(), d = set.points[p + 1].cast<double>() - a;
      for (int i = 0; i < kSteps; ++i) {
        const double t = (i + 0.5) / kSteps;
        const Vec3 c = frame.cellsFromWorld(a + t * d);
        const double u = std::pow(double(set.widths[p]), 2), v = std::pow(double(set.widths[p + 1]), 2);
        expected[frame.index(long(std::floor(c.x())), long(std::floor(c.y())), long(std::floor(c.z())))] +=
            3.14159265358979 / 4 * (u + t * (v - u)) * d.norm() / kSteps / std::pow(frame.cell, 3);
      }
    }
  }
  const double largest = *std::ranges::max_element(expected);
  // A segment's end in a cell is off by half a step, 1/8000 of a length; a cell holds tens of them.
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(grid.values[i], expected[i], 1e-3 * largest);
}

TEST(HairVolume, SameBytesForAnyNumberOfThreads) {
  const StrandSet set = tangle(3000, 5);
  GridFrame frame;
  frame.cell = 0.1;
  frame.log2Size = 6;
  std::vector<std::vector<float>> values;
  for (const int threads : {1, 2, 5}) {
    Context context;
    context.threads = threads;
    values.push_back(depositHairVolume(set, frame, 0, context).value().values);
  }
  EXPECT_TRUE(values[0] == values[1] && values[0] == values[2]);
}

TEST(HairVolume, RefusesWhatDoesNotFitAndDropsWhatIsNoNumber) {
  StrandSet set = tangle(5, 9);
  GridFrame frame;
  frame.cell = 0.3;
  frame.log2Size = 4;
  const DensityGrid before = depositHairVolume(set, frame, 0).value();
  for (int p = 0; p < 3; ++p) {
    set.points.push_back(Vec3f(p == 1 ? std::numeric_limits<float>::quiet_NaN() : 0.1f * float(p), 0, 0));
    set.widths.push_back(0.01f);
  }
  set.offsets.push_back(set.points.size());
  DensityReport report;
  const DensityGrid after = depositHairVolume(set, frame, 0, {}, &report).value();
  EXPECT_EQ(report.droppedStrands, 1u);
  EXPECT_EQ(before.values, after.values);
  set.points[0] = Vec3f(1e9f, 0, 0);
  EXPECT_EQ(depositHairVolume(set, frame, 0).error().code, ErrorCode::TooLarge);
  frame.cell = 0;
  EXPECT_EQ(depositHairVolume(set, frame, 0).error().code, ErrorCode::InvalidArgument);
  frame.cell = 1;
  EXPECT_TRUE(depositHairVolume(StrandSet{}, frame, 0.1).ok());
}

}  // namespace
}  // namespace coif
