// Chains for measuring and testing dynamics.
#pragma once

#include <cstddef>

#include "coif/simulate/chain.h"
#include "coif/simulate/solver.h"

namespace coif {

/// One chain of equal links from the origin along `direction`; every node weighs `mass`.
ChainSet straightChain(std::size_t links, double length, const Vec3& direction, double mass = 1,
                       double kappa = 0);

/// The same trees `count` times over, without lateral springs.
ChainSet repeated(const ChainSet& one, std::size_t count);

}  // namespace coif
