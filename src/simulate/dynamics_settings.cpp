#include "coif/simulate/dynamics_settings.h"

#include <cstdio>
#include <string>

namespace coif {

Status validate(const DynamicsSettings& s) {
  struct Range {
    const char* name;
    double value, lo, hi;
  };
  const Range ranges[] = {{"longestStep", s.longestStep, 1e-6, 10},
                          {"tolerance", s.tolerance, 0, 0.1},
                          {"sleepSpeed", s.sleepSpeed, 0, 1e3},
                          {"sleepSeconds", s.sleepSeconds, 1e-6, 1e3},
                          {"settleSeconds", s.settleSeconds, 0, 3600},
                          {"gravity", s.gravity, -1e4, 1e4},
                          {"droop", s.droop, 0, 1e6},
                          {"lateral", s.lateral, 0, 1e12},
                          {"drag", s.drag, 0, 1e6},
                          {"gustSpeed", s.gustSpeed, 0, 1e4},
                          {"gustSize", s.gustSize, 1e-6, 1e6},
                          {"gustSeconds", s.gustSeconds, 1e-6, 1e6},
                          {"wisps", double(s.wisps), 0, 10000},
                          {"guidePoints", double(s.guidePoints), 2, 256},
                          {"airCells", double(s.airCells), 4, 128},
                          {"shelter", s.shelter, 0, 1e9},
                          {"thickness", s.thickness, 0, 1e3},
                          {"contactStiffness", s.contactStiffness, 0, 1e12},
                          {"friction", s.friction, 0, 100},
                          {"repulsion", s.repulsion, 0, 1e4},
                          {"density", s.density, 0, 1e6},
                          {"cell", s.cell, 1e-6, 1e3},
                          {"hairFriction", s.hairFriction, 0, 1e6}};
  for (const Range& range : ranges) {
    if (range.value >= range.lo && range.value <= range.hi) continue;
    char wanted[64];
    std::snprintf(wanted, sizeof wanted, "a number from %g to %g is wanted here", range.lo, range.hi);
    return makeError(ErrorCode::InvalidArgument, wanted, range.name);
  }
  if (!(s.windVelocity.cwiseAbs().maxCoeff() <= 1e4))
    return makeError(ErrorCode::InvalidArgument, "the wind is not finite or faster than 10 000 m/s",
                     "windVelocity");
  for (std::size_t i = 0; i < s.capsules.size(); ++i) {
    const BodyCapsule& capsule = s.capsules[i];
    if (!capsule.a.allFinite() || !capsule.b.allFinite() || !(capsule.radius > 0 && capsule.radius < 1e12))
      return makeError(ErrorCode::InvalidArgument, "a capsule needs finite ends and a radius above 0",
                       "capsules[" + std::to_string(i) + "]");
  }
  if (s.capsules.size() > 60)
    return makeError(ErrorCode::InvalidArgument, "at most 60 capsules can be collided with", "capsules");
  return {};
}

}  // namespace coif
