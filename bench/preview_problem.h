// Hair for the benches of the preview: 20 by 20 bundles of 10 layers, seen from the side.
#pragma once

#include "bench/bench.h"
#include "coif/preview/session.h"

namespace coif {

HairMesh previewProblemMesh(const BenchOptions& options);

/// Lights that stay in the scene while the camera moves, the key turned a little.
Lights fixedLights(int turn = 0);

/// Strands of 32 points on the mesh, their points made on the GPU, with camera and lights set. `width`: of a
/// strand, in the mesh's units.
PreviewSession previewProblem(Preview& preview, const HairMesh& mesh, std::size_t strands, double aspect,
                              const BenchOptions& options, double width = 4e-4);

}  // namespace coif
