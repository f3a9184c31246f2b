#include "simulate/lane_block.h"

namespace coif::lanes {

extern const Kernels kKernelsBase;
#if defined(__x86_64__)
extern const Kernels kKernelsAvx2, kKernelsAvx512;
#endif

const Kernels& bestKernels() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl"))
    return kKernelsAvx512;
  if (__builtin_cpu_supports("avx2")) return kKernelsAvx2;
#endif
  return kKernelsBase;
}

}  // namespace coif::lanes
