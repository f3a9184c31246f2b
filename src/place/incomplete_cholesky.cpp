#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>

#include "place/preconditioner.h"

namespace coif::placing {

namespace {

class Incomplete final : public Preconditioner {
 public:
  explicit Incomplete(const Csr& matrix) {
    const int n = int(matrix.rows());
    std::vector<Eigen::Triplet<double, int>> entries;
    entries.reserve(matrix.value.size());
    for (int row = 0; row < n; ++row) {
      for (std::size_t e = matrix.start[std::size_t(row)]; e < matrix.start[std::size_t(row) + 1]; ++e) {
        entries.emplace_back(row, int(matrix.column[e]), matrix.value[e]);
      }
    }
    Eigen::SparseMatrix<double> a(n, n);
    a.setFromTriplets(entries.begin(), entries.end());
    factor_.setInitialShift(1e-4);  // the first shift tried; it grows until the factor exists
    factor_.compute(a);
  }
  bool ok() const { return factor_.info() == Eigen::Success; }
  void apply(const Block& r, Block& z, const Context&) const override {
    z.resize(r.rows(), r.cols());
    for (Eigen::Index c = 0; c < r.cols(); ++c) z.col(c) = factor_.solve(r.col(c).matrix()).array();
  }

 private:
  Eigen::IncompleteCholesky<double, Eigen::Lower, Eigen::AMDOrdering<int>> factor_;
};

}  // namespace

std::unique_ptr<Preconditioner> makeIncompleteCholesky(const Csr& matrix) {
  auto factor = std::make_unique<Incomplete>(matrix);
  if (!factor->ok()) return nullptr;
  return factor;
}

}  // namespace coif::placing
