// Dynamics settings in a .coif file.
#pragma once

#include <nlohmann/json.hpp>

#include "coif/scene/dynamics_text.h"
#include "scene/json_reader.h"

namespace coif::scene {

nlohmann::ordered_json dynamicsJson(const DynamicsSettings& settings);
/// What is missing keeps its default; faults go to the reader.
DynamicsSettings readDynamics(JsonReader reader);

}  // namespace coif::scene
