// Several right-hand sides at once: one row an unknown, one column a coordinate.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "coif/base/context.h"

namespace coif::placing {

using Block = Eigen::Array<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Sums = Eigen::Array<double, 1, Eigen::Dynamic>;  ///< one value a column

/// Symmetric sparse matrix, all entries stored, columns ascending in each row.
struct Csr {
  std::vector<std::size_t> start{0};  ///< rows + 1
  std::vector<std::uint32_t> column;
  std::vector<double> value;
  std::size_t rows() const { return start.size() - 1; }
};

/// y = A x, row by row: the same bits for any thread count.
void multiply(const Csr& matrix, const Block& x, Block& y, const Context& context);

/// Column-wise Σ a·b over fixed chunks added in order: the same bits for any thread count.
Sums dots(const Block& a, const Block& b, const Context& context);

/// y += x · diag(scale), and p = z + p · diag(scale).
void addScaled(Block& y, const Block& x, const Sums& scale, const Context& context);
void scaleAndAdd(Block& p, const Block& z, const Sums& scale, const Context& context);

}  // namespace coif::placing
