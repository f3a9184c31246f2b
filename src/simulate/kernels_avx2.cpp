#if defined(__x86_64__)
#define COIF_KERNELS kKernelsAvx2
#define COIF_KERNELS_NAME "AVX2"
#include "simulate/kernels.inl"
#endif
