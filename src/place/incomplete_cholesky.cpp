#include <algorithm>
#include <cmath>

#include "place/preconditioner.h"

namespace coif::placing {

namespace {

// Entries below this fraction of √(d_i d_j) are dropped. From a few runs, not a scan.
constexpr double kDrop = 3e-3;

// A ≈ L D Lᵀ with unit lower L, column by column; a dropped entry's size goes to both its diagonals, which
// keeps every pivot positive for any positive definite matrix (Ajiz and Jennings 1984).
class Incomplete final : public Preconditioner {
 public:
  explicit Incomplete(const Csr& a) : diagonal_(a.rows(), 0.0) {
    const std::size_t n = a.rows();
    for (std::size_t j = 0; j < n; ++j) {
      for (std::size_t e = a.start[j]; e < a.start[j + 1]; ++e) {
        if (a.column[e] == j) diagonal_[j] = a.value[e];
      }
    }
    const std::vector<double> scale = diagonal_;  // the matrix's own diagonal: what "small" is measured by
    std::vector<double> work(n, 0);
    std::vector<std::uint32_t> pattern;
    std::vector<std::uint8_t> inPattern(n, 0);
    std::vector<std::size_t> next(n, 0);  // first entry of a column at or below the row in hand
    std::vector<std::uint32_t> head(n, kNone), link(n, kNone);
    for (std::uint32_t j = 0; j < n; ++j) {
      pattern.clear();
      const auto add = [&](std::uint32_t i, double value) {
        if (!inPattern[i]) pattern.push_back(i);
        inPattern[i] = 1;
        work[i] += value;
      };
      for (std::size_t e = a.start[j]; e < a.start[j + 1]; ++e) {
        if (a.column[e] > j) add(a.column[e], a.value[e]);
      }
      for (std::uint32_t k = head[j], following; k != kNone;
           k = following) {  // columns with an entry in row j
        following = link[k];
        const double factor = value_[next[k]] * diagonal_[k];
        for (std::size_t e = next[k] + 1; e < start_[k + 1]; ++e) add(row_[e], -factor * value_[e]);
        enlist(k, next[k] + 1, next, head, link);
      }
      std::ranges::sort(pattern);
      std::erase_if(pattern, [&](std::uint32_t i) {
        const bool drop = work[i] * work[i] < kDrop * kDrop * scale[i] * scale[j];
        if (drop) {
          const double ratio = std::sqrt(scale[j] / scale[i]);
          diagonal_[j] += std::abs(work[i]) * ratio;
          diagonal_[i] += std::abs(work[i]) / ratio;
          work[i] = 0;
          inPattern[i] = 0;
        }
        return drop;
      });
      // A free translation leaves its last pivot at rounding level: let that unknown stand still.
      if (!(diagonal_[j] > 1e-10 * scale[j])) diagonal_[j] = scale[j];
      for (const std::uint32_t i : pattern) {
        row_.push_back(i);
        value_.push_back(work[i] / diagonal_[j]);
        diagonal_[i] -= work[i] * work[i] / diagonal_[j];
        work[i] = 0;
        inPattern[i] = 0;
      }
      start_.push_back(row_.size());
      enlist(j, start_[j], next, head, link);
    }
  }

  void apply(const Block& r, Block& z, const Context&) const override {
    z = r;
    const Eigen::Index n = r.rows();
    for (Eigen::Index j = 0; j < n; ++j) {
      for (std::size_t e = start_[std::size_t(j)]; e < start_[std::size_t(j) + 1]; ++e) {
        z.row(row_[e]) -= value_[e] * z.row(j);
      }
    }
    for (Eigen::Index j = n - 1; j >= 0; --j) {
      z.row(j) /= diagonal_[std::size_t(j)];
      for (std::size_t e = start_[std::size_t(j)]; e < start_[std::size_t(j) + 1]; ++e) {
        z.row(j) -= value_[e] * z.row(row_[e]);
      }
    }
  }

 private:
  void enlist(std::uint32_t k, std::size_t entry, std::vector<std::size_t>& next,
              std::vector<std::uint32_t>& head, std::vector<std::uint32_t>& link) const {
    if (entry >= start_[k + 1]) return;
    next[k] = entry;
    link[k] = head[row_[entry]];
    head[row_[entry]] = k;
  }

  std::vector<std::size_t> start_{0};
  std::vector<std::uint32_t> row_;
  std::vector<double> value_, diagonal_;
};

}  // namespace

std::unique_ptr<Preconditioner> makeIncompleteCholesky(const Csr& matrix) {
  return std::make_unique<Incomplete>(matrix);
}

}  // namespace coif::placing
