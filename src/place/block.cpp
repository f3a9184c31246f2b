#include "place/block.h"

#include "coif/base/parallel.h"

namespace coif::placing {

namespace {
constexpr std::size_t kGrain = 4096;  // rows a task: below it a task costs more than it saves
}

void multiply(const Csr& matrix, const Block& x, Block& y, const Context& context) {
  const Eigen::Index columns = x.cols();
  parallelFor(context, matrix.rows(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      double* out = y.data() + row * std::size_t(columns);
      for (Eigen::Index c = 0; c < columns; ++c) out[c] = 0;
      for (std::size_t e = matrix.start[row]; e < matrix.start[row + 1]; ++e) {
        const double* in = x.data() + std::size_t(matrix.column[e]) * std::size_t(columns);
        for (Eigen::Index c = 0; c < columns; ++c) out[c] += matrix.value[e] * in[c];
      }
    }
  });
}

Sums dots(const Block& a, const Block& b, const Context& context) {
  const std::size_t rows = std::size_t(a.rows());
  std::vector<Sums> partial((rows + kGrain - 1) / kGrain);
  parallelFor(context, rows, kGrain, [&](std::size_t begin, std::size_t end) {
    Sums sum = Sums::Zero(a.cols());
    for (std::size_t row = begin; row < end; ++row) {
      sum += a.row(Eigen::Index(row)) * b.row(Eigen::Index(row));
    }
    partial[begin / kGrain] = sum;
  });
  Sums total = Sums::Zero(a.cols());
  for (const Sums& sum : partial) {
    if (sum.size() > 0) total += sum;  // empty only when cancelled
  }
  return total;
}

void addScaled(Block& y, const Block& x, const Sums& scale, const Context& context) {
  parallelFor(context, std::size_t(y.rows()), kGrain, [&](std::size_t begin, std::size_t end) {
    for (Eigen::Index row = Eigen::Index(begin); row < Eigen::Index(end); ++row)
      y.row(row) += x.row(row) * scale;
  });
}

void scaleAndAdd(Block& p, const Block& z, const Sums& scale, const Context& context) {
  parallelFor(context, std::size_t(p.rows()), kGrain, [&](std::size_t begin, std::size_t end) {
    for (Eigen::Index row = Eigen::Index(begin); row < Eigen::Index(end); ++row) {
      p.row(row) = z.row(row) + p.row(row) * scale;
    }
  });
}

}  // namespace coif::placing
