#if defined(__x86_64__)
#define COIF_KERNELS kKernelsAvx512
#define COIF_KERNELS_NAME "AVX-512"
#include "simulate/kernels.inl"
#endif
