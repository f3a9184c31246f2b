#include "coif/base/lanes.h"

namespace coif {

int widestLanes() {
#if defined(__x86_64__)
  static const int widest = [] {
    __builtin_cpu_init();
    const bool wide = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                      __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw");
    return wide ? 16 : __builtin_cpu_supports("avx2") ? 8 : 4;
  }();
  return widest;
#else
  return 4;
#endif
}

}  // namespace coif
