#include "bench/preview_problem.h"

#include "bench/place_problem.h"
#include "coif/strands/grow.h"

namespace coif {

HairMesh previewProblemMesh(const BenchOptions& options) {
  return placeProblemMesh({20, 10, PlaceKind::Uniform}, options.seed);
}

Lights fixedLights(int turn) {
  Lights lights;
  lights.followCamera = false;
  lights.key.direction += Vec3(0.05 * turn, 0, 0);
  return lights;
}

PreviewSession previewProblem(Preview& preview, const HairMesh& mesh, std::size_t strands, double aspect,
                              const BenchOptions& options, double width) {
  GrowOptions grow;
  grow.count = strands;
  grow.points = 2;  // the GPU makes the 32
  grow.seed = options.seed;
  grow.width = width;
  const StrandSet roots = require(coif::grow(mesh, grow, options.context)).strands;
  PreviewSession session(preview);
  if (const Status set = session.setHair(mesh, roots, Knots::Uniform, 32, options.context); !set.ok())
    throw BenchFault{set.error()};
  std::vector<Vec3> positions;
  for (const HairVertex& v : mesh.vertices()) positions.push_back(v.position);
  session.setCamera(frameBox(bounds(positions), UpAxis::Z, 30, 20, aspect));
  session.setLights(fixedLights());
  return session;
}

}  // namespace coif
