// What a simulation did not have to compute.
#pragma once

#include "coif/simulate/simulation.h"

namespace coif::simulate {

/// Chains none of whose joints has stiffness.
std::size_t limpTrees(const ChainSet& chains);
std::vector<LeftOut> leftOut(const DynamicsSettings& settings, const SimulationReport& report);

}  // namespace coif::simulate
