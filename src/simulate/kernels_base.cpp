#define COIF_KERNELS kKernelsBase
#define COIF_KERNELS_NAME "baseline"
#include "simulate/kernels.inl"
