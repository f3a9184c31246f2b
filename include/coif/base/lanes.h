// Vectors of 4, 8 or 16 floats for the few inner loops that ask for them: one source, compiled once a width.
//
// A kernel is a template over the width W, always inlined into a function with a COIF_TARGET that the
// processor of widestLanes() has. Arithmetic is IEEE's, without contraction, so that every width gives the
// same bytes where it adds in the same order.
#pragma once

#include <cstring>

#if defined(__x86_64__)
#define COIF_TARGET_16_LANES [[gnu::target("avx512f,avx512dq,avx512vl,avx512bw")]]
#define COIF_TARGET_8_LANES [[gnu::target("avx2")]]
#endif

namespace coif {

template <int W>
struct Lanes {
  typedef float Float __attribute__((vector_size(4 * W)));
  typedef int Int __attribute__((vector_size(4 * W)));
};

/// Reads and writes at any address.
template <class Vector, class Element>
[[gnu::always_inline]] inline void loadLanes(Vector& out, const Element* from) {
  std::memcpy(&out, from, sizeof(Vector));
}
template <class Vector, class Element>
[[gnu::always_inline]] inline void storeLanes(Element* to, const Vector& value) {
  std::memcpy(to, &value, sizeof(Vector));
}

/// What this processor is best at: 16 (AVX-512), 8 (AVX2) or 4.
int widestLanes();

}  // namespace coif
