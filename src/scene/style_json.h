// A style's stack in the .coif file.
#pragma once

#include "coif/style/style_operator.h"
#include "scene/json_reader.h"

namespace coif::scene {

nlohmann::ordered_json stylesJson(const StyleStack& styles);
/// Of the document's "styles". The first fault is the reader's.
StyleStack readStyles(JsonReader& document);

}  // namespace coif::scene
