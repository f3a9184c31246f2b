// What stands before conjugate gradients: z = M⁻¹ r with M⁻¹ symmetric and positive on the solution space.
#pragma once

#include <memory>

#include "place/system.h"

namespace coif::placing {

class Preconditioner {
 public:
  virtual ~Preconditioner() = default;
  virtual void apply(const Block& r, Block& z, const Context& context) const = 0;
};

std::unique_ptr<Preconditioner> makeIdentity();
std::unique_ptr<Preconditioner> makeJacobi(const Csr& matrix);
/// Threshold incomplete LDLᵀ with diagonal compensation: exists for every placement matrix.
std::unique_ptr<Preconditioner> makeIncompleteCholesky(const Csr& matrix);

}  // namespace coif::placing
