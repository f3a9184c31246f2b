#include "place/preconditioner.h"

namespace coif::placing {

namespace {

class Identity final : public Preconditioner {
 public:
  void apply(const Block& r, Block& z, const Context&) const override { z = r; }
};

class Jacobi final : public Preconditioner {
 public:
  explicit Jacobi(const Csr& matrix) : inverse_(Eigen::Index(matrix.rows())) {
    for (std::size_t row = 0; row < matrix.rows(); ++row) {
      for (std::size_t e = matrix.start[row]; e < matrix.start[row + 1]; ++e) {
        if (matrix.column[e] == row) inverse_[Eigen::Index(row)] = 1 / matrix.value[e];
      }
    }
  }
  void apply(const Block& r, Block& z, const Context&) const override { z = r.colwise() * inverse_; }

 private:
  Eigen::ArrayXd inverse_;
};

}  // namespace

std::unique_ptr<Preconditioner> makeIdentity() {
  return std::make_unique<Identity>();
}
std::unique_ptr<Preconditioner> makeJacobi(const Csr& matrix) {
  return std::make_unique<Jacobi>(matrix);
}

}  // namespace coif::placing
