// A small scene with every feature of the document: two layers, a separated edge, a pinned vertex, two
// groups.
#pragma once

#include "coif/scene/scene.h"

namespace coif::test {

Scene sampleScene();

}  // namespace coif::test
