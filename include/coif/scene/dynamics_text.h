// Dynamics settings by the names that the .coif file, the command and scripts have for them.
#pragma once

#include <string>
#include <vector>

#include "coif/base/result.h"
#include "coif/simulate/dynamics_settings.h"

namespace coif {

/// In the order of the enumerations.
inline constexpr const char* kMethodNames[] = {
    "van-overveld", "articulated-explicit", "articulated-implicit", "xpbd",
    "direct",       "direct-bdf2",          "energy-keeping"};
inline constexpr const char* kWindNames[] = {"none", "constant", "gusts", "fluid"};
inline constexpr const char* kPrecisionNames[] = {"double", "single"};

/// Those that setDynamics() takes: all but the capsules.
std::vector<std::string> dynamicsNames();

/// Sets one by name: "droop" to "0.5", "solver" to "xpbd", "windVelocity" to "1,0,0", "collide" to "0".
/// Errors: InvalidArgument for a name that there is not (with those there are) or a value that does not suit;
/// the settings are then unchanged.
Status setDynamics(DynamicsSettings& settings, const std::string& name, const std::string& value);

}  // namespace coif
