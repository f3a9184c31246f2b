#include "place/block.h"

#include <type_traits>

#include "coif/base/parallel.h"

namespace coif::placing {

namespace {

// Rows a task: about a tenth of a millisecond of work, so that a busy machine's late threads cost little.
constexpr std::size_t kProductGrain = 8192;
constexpr std::size_t kVectorGrain = 65536;

// Calls body with the number of columns as a constant for the two counts that occur (a drag, a position), so
// that the inner loops unroll.
template <class Body>
void withColumns(Eigen::Index columns, const Body& body) {
  if (columns == 1) return body(std::integral_constant<std::size_t, 1>{});
  if (columns == 3) return body(std::integral_constant<std::size_t, 3>{});
  body(std::size_t(columns));
}

}  // namespace

void multiply(const Csr& matrix, const Block& x, Block& y, const Context& context) {
  withColumns(x.cols(), [&](const auto m) {
    parallelFor(context, matrix.rows(), kProductGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = begin; row < end; ++row) {
        double* out = y.data() + row * m;
        for (std::size_t c = 0; c < m; ++c) out[c] = 0;
        for (std::size_t e = matrix.start[row]; e < matrix.start[row + 1]; ++e) {
          const double value = matrix.value[e];
          const double* in = x.data() + std::size_t(matrix.column[e]) * m;
          for (std::size_t c = 0; c < m; ++c) out[c] += value * in[c];
        }
      }
    });
  });
}

Sums dots(const Block& a, const Block& b, const Context& context) {
  const std::size_t rows = std::size_t(a.rows());
  std::vector<Sums> partial((rows + kVectorGrain - 1) / kVectorGrain);
  withColumns(a.cols(), [&](const auto m) {
    parallelFor(context, rows, kVectorGrain, [&](std::size_t begin, std::size_t end) {
      Sums sum = Sums::Zero(a.cols());
      for (std::size_t row = begin; row < end; ++row) {
        for (std::size_t c = 0; c < m; ++c)
          sum[Eigen::Index(c)] += a.data()[row * m + c] * b.data()[row * m + c];
      }
      partial[begin / kVectorGrain] = sum;
    });
  });
  Sums total = Sums::Zero(a.cols());
  for (const Sums& sum : partial) {
    if (sum.size() > 0) total += sum;  // empty only when cancelled
  }
  return total;
}

void addScaled(Block& y, const Block& x, const Sums& scale, const Context& context) {
  withColumns(y.cols(), [&](const auto m) {
    parallelFor(context, std::size_t(y.rows()), kVectorGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = begin; row < end; ++row) {
        for (std::size_t c = 0; c < m; ++c)
          y.data()[row * m + c] += x.data()[row * m + c] * scale[Eigen::Index(c)];
      }
    });
  });
}

void scaleAndAdd(Block& p, const Block& z, const Sums& scale, const Context& context) {
  withColumns(p.cols(), [&](const auto m) {
    parallelFor(context, std::size_t(p.rows()), kVectorGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = begin; row < end; ++row) {
        for (std::size_t c = 0; c < m; ++c) {
          double& out = p.data()[row * m + c];
          out = z.data()[row * m + c] + out * scale[Eigen::Index(c)];
        }
      }
    });
  });
}

}  // namespace coif::placing
