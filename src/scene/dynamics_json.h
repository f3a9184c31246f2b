// Dynamics settings in a .coif file.
#pragma once

#include <nlohmann/json.hpp>

#include "coif/simulate/dynamics_settings.h"
#include "scene/json_reader.h"

namespace coif::scene {

nlohmann::ordered_json dynamicsJson(const DynamicsSettings& settings);
/// What is missing keeps its default; faults go to the reader.
DynamicsSettings readDynamics(JsonReader reader);

/// Names as the file, the command and Python have them, in the order of the enumerations.
inline constexpr const char* kMethodNames[] = {
    "van-overveld", "articulated-explicit", "articulated-implicit", "xpbd",
    "direct",       "direct-bdf2",          "energy-keeping"};
inline constexpr const char* kWindNames[] = {"none", "constant", "gusts", "fluid"};

}  // namespace coif::scene
