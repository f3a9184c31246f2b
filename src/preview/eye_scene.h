#pragma once

#include "preview/hair_map.h"
#include "preview/passes.h"

namespace coif::preview {

/// What is drawn for the eye, and over what.
struct EyeScene {
  const Programs& programs;
  const StrandBuffers& strands;  ///< ribbons, or lines
  const HeadBuffers* head;       ///< may be null
  const HairMap* cameraMap;      ///< OccupancyOrdered: what lies in front, seen from the camera
  const FrameTargets& targets;
  const VertexArray& empty;
  const View& view;
  double layerSize = 0;  ///< DepthLayers: thickness of the first, > 0
};

}  // namespace coif::preview
