#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <vector>

#include "coif/base/parallel.h"
#include "coif/base/random.h"
#include "coif/base/result.h"

namespace coif {
namespace {

Result<int> half(int x) {
  if (x % 2 != 0)
    return makeError(ErrorCode::InvalidArgument, "the number is odd", "number " + std::to_string(x));
  return x / 2;
}

Result<int> quarter(int x) {
  COIF_ASSIGN(const int h, half(x));
  return half(h);
}

TEST(Result, ErrorsTravelWithTheirPlace) {
  EXPECT_EQ(quarter(12).value(), 3);
  const Result<int> bad = quarter(6);
  ASSERT_FALSE(bad.ok());
  EXPECT_EQ(inFile(bad.error(), "a.obj").text(), "a.obj: number 3: the number is odd");
  EXPECT_THROW((void)bad.value(), std::logic_error);
}

TEST(Parallel, EveryIndexOnceForAnyThreadCount) {
  for (int threads : {0, 1, 2, 5}) {
    Context context;
    context.threads = threads;
    std::vector<std::atomic<int>> hits(1000);
    parallelFor(context, hits.size(), 7, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) hits[i]++;
    });
    for (const auto& hit : hits) ASSERT_EQ(hit.load(), 1);
  }
}

TEST(Parallel, SumHasTheSameBitsForAnyThreadCount) {
  const auto sum = [](int threads) {
    Context context;
    context.threads = threads;
    return parallelSum(context, 100003, 64, [](std::size_t begin, std::size_t end) {
      double s = 0;
      for (std::size_t i = begin; i < end; ++i) s += std::sin(double(i)) * 1e-3;
      return s;
    });
  };
  EXPECT_EQ(sum(1), sum(2));
  EXPECT_EQ(sum(1), sum(7));
}

TEST(Random, UniformMomentsAndIndependenceOfStreams) {
  constexpr int n = 1 << 18;
  const CounterRandom a(7, 0), b(7, 1);
  double mean = 0, square = 0, cross = 0;
  for (int i = 0; i < n; ++i) {
    const double x = a.uniform(i) - 0.5, y = b.uniform(i) - 0.5;
    mean += x, square += x * x, cross += x * y;
  }
  // Five standard deviations of each estimator: 1/sqrt(12n), 1/sqrt(180n), 1/(12 sqrt(n)).
  EXPECT_NEAR(mean / n, 0, 5 / std::sqrt(12.0 * n));
  EXPECT_NEAR(square / n, 1.0 / 12, 5 / std::sqrt(180.0 * n));
  EXPECT_NEAR(cross / n, 0, 5 / (12 * std::sqrt(double(n))));
}

}  // namespace
}  // namespace coif
