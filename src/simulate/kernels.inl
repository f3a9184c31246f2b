// The kernels, compiled once for each instruction set: COIF_KERNELS names the table. All is in an unnamed
// namespace, so that no function built for a newer processor can be linked in elsewhere.
#include <cmath>

#include "simulate/lane_block.h"

namespace coif::lanes {

extern const Kernels COIF_KERNELS;

namespace {
#include "simulate/lane_math.h"

#include "simulate/newton_system.h"

#include "simulate/step_objective.h"

#include "simulate/direct_kernel.h"
#include "simulate/projecting_kernel.h"
}  // namespace

const Kernels COIF_KERNELS = {runDirect<double, kDoubleLanes>, runOverveld<double, kDoubleLanes>,
                              runXpbd<double, kDoubleLanes>,   runDirect<float, kFloatLanes>,
                              runOverveld<float, kFloatLanes>, runXpbd<float, kFloatLanes>,
                              COIF_KERNELS_NAME};

}  // namespace coif::lanes
