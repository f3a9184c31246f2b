#include "strands/deposit_lanes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "coif/base/lanes.h"

namespace coif {
namespace {

constexpr int kBatch = 16, kStage = 128;  // segments: walked together, prepared together
constexpr int kQuad = 4;
constexpr float kNever = 2;  // beyond the end of a segment, 1

/// Segments in cells from the task's origin: where they begin and go, where they meet the next face along
/// each axis and how far the faces lie apart, as fractions of the segment.
struct Stage {
  alignas(64) float at[3][kStage + kQuad], ends[kStage + kQuad];  // points and their weights
  alignas(64) float begin[3][kStage], delta[3][kStage], next[3][kStage], stride[3][kStage];
  alignas(64) float weight[kStage], growth[kStage];  // weight × length, half its change
  alignas(64) int faces[kStage], live[kStage];       // live: −1, or 0 where there is no segment
};

using Quad = Lanes<4>::Float;

/// Four points into four of their x, y, z and weights.
[[gnu::always_inline]] inline void transpose(const Quad (&p)[4], float* x, float* y, float* z, float* w) {
  const Quad a = __builtin_shufflevector(p[0], p[1], 0, 4, 1, 5),
             b = __builtin_shufflevector(p[2], p[3], 0, 4, 1, 5);
  const Quad c = __builtin_shufflevector(p[0], p[1], 2, 6, 3, 7),
             d = __builtin_shufflevector(p[2], p[3], 2, 6, 3, 7);
  storeLanes(x, Quad(__builtin_shufflevector(a, b, 0, 1, 4, 5)));
  storeLanes(y, Quad(__builtin_shufflevector(a, b, 2, 3, 6, 7)));
  storeLanes(z, Quad(__builtin_shufflevector(c, d, 0, 1, 4, 5)));
  storeLanes(w, Quad(__builtin_shufflevector(c, d, 2, 3, 6, 7)));
}

/// `count` segments from `points` on.
[[gnu::always_inline]] inline int prepare(const DepositTask& task, const GridPoint* points, int count,
                                          Stage& s) {
  const int padded = (count + kBatch - 1) / kBatch * kBatch;
  for (int l = 0; l <= count; l += kQuad) {
    Quad four[kQuad];
    for (int q = 0; q < kQuad; ++q) loadLanes(four[q], &points[l + q].x);
    transpose(four, s.at[0] + l, s.at[1] + l, s.at[2] + l, s.ends + l);
  }
  for (int l = count; l < padded; ++l) {
    for (int d = 0; d < 3; ++d) s.at[d][l] = s.at[d][l + 1] = task.origin[d] + 1;
    s.ends[l] = s.ends[l + 1] = -0.0f;
  }
  for (int l = 0; l < padded; ++l) {
    s.live[l] = ~(std::bit_cast<std::int32_t>(s.ends[l]) >> 31);
    s.faces[l] = 0;
  }
  for (int d = 0; d < 3; ++d) {
    const float* at = s.at[d];
    float *begin = s.begin[d], *delta = s.delta[d], *next = s.next[d], *stride = s.stride[d];
    const float origin = task.origin[d];
    for (int l = 0; l < padded; ++l) {
      const float a = at[l] - origin, b = at[l + 1] - origin;
      const int faces = (int(b) - int(a)) & s.live[l];
      const float perDelta = 1 / (b - a);
      const float face = float(int(a) + (faces > 0));
      next[l] = faces != 0 ? (face - a) * perDelta : kNever;
      stride[l] = faces != 0 ? std::abs(perDelta) : kNever;
      begin[l] = a, delta[l] = b - a;
      s.faces[l] += std::abs(faces);
    }
  }
  const float along = task.acrossLast ? 0 : 1;
  for (int l = 0; l < padded; ++l) {
    const float x = s.delta[0][l], y = s.delta[1][l], z = along * s.delta[2][l];
    const float length = s.live[l] != 0 ? std::sqrt(x * x + y * y + z * z) : 0.0f;
    const float from = std::abs(s.ends[l]), to = std::abs(s.ends[l + 1]);
    s.growth[l] = 0.5f * (to - from) * length;
    s.weight[l] = from * length;
  }
  return padded;
}

/// Pieces of a batch's segments and their cells, step by step, kBatch each.
struct Pieces {
  std::vector<int> cells;
  std::vector<float> lengths;
};

/// Lanes [first, first + W) of a batch that begins at `batch`: one piece of each lane a step, up to the next
/// face of any axis. The number of faces is known beforehand, so rounding can displace a crossing but never
/// lose one.
template <int W>
[[gnu::always_inline]] inline void walk(const DepositTask& task, const Stage& s, int batch, int lane,
                                        int steps, Pieces& out) {
  using Float = typename Lanes<W>::Float;
  using Int = typename Lanes<W>::Int;
  constexpr int kRows = GridDeposit::kSlabRows;
  const int log2 = task.log2Size, size = 1 << log2, mask = size - 1, layer = kRows << log2;
  const int columns =
      (mask * layer) | mask;  // an address without its row; what i carries lands in the row's bits
  const int rows = mask << log2, inSlab = (kRows - 1) << log2, slab = task.rowBegin << log2;
  const int first = batch + lane;
  Float next[3], stride[3], weight, growth;
  Int faces, cell[3], step[3];
  for (int d = 0; d < 3; ++d) {
    Float begin, delta;
    loadLanes(begin, &s.begin[d][first]);
    loadLanes(delta, &s.delta[d][first]);
    loadLanes(next[d], &s.next[d][first]);
    loadLanes(stride[d], &s.stride[d][first]);
    cell[d] = __builtin_convertvector(begin, Int) & mask;
    const int one = d == 2 ? layer : d == 1 ? size : 1;
    step[d] = delta < 0.0f ? Int{} + mask * one : Int{} + one;  // −1 is n − 1 where addresses wrap
  }
  loadLanes(weight, &s.weight[first]);
  loadLanes(growth, &s.growth[first]);
  loadLanes(faces, &s.faces[first]);
  Int column = cell[0] | (cell[2] * layer), row = cell[1] << log2;
  const Float zero = Float{}, end = zero + 1.0f;
  const Int none = Int{};
  Float from = zero;
  int* cells = out.cells.data() + lane;
  float* lengths = out.lengths.data() + lane;
  for (int n = 0; n < steps; ++n, cells += kBatch, lengths += kBatch) {
    Float to = next[0] < next[1] ? next[0] : next[1];
    to = to < next[2] ? to : next[2];
    to = n < faces ? to : end;
    to = to < end ? to : end;  // and never before `from`: what lay there has moved on by its stride
    const Float piece = (weight + (from + to) * growth) * (to - from);
    storeLanes(cells, Int(column | (row & inSlab)));
    storeLanes(lengths, Float((row & ~inSlab) == slab ? piece : zero));
    const auto x = next[0] <= to, y = next[1] <= to, z = next[2] <= to;
    next[0] += x ? stride[0] : zero;
    next[1] += y ? stride[1] : zero;
    next[2] += z ? stride[2] : zero;
    column = (column + (x ? step[0] : none) + (z ? step[2] : none)) & columns;
    row = (row + (y ? step[1] : none)) & rows;
    from = to;
  }
}

void addPieces(float* to, const Pieces& pieces, int steps) {
  for (int k = 0; k < steps * kBatch; ++k) to[pieces.cells[std::size_t(k)]] += pieces.lengths[std::size_t(k)];
}

#if defined(__x86_64__)
/// The same without those of no length, of which there are many: other slabs' and ended segments'.
COIF_TARGET_16_LANES void addPieces16(float* to, Pieces& pieces, int steps) {
  int* const cells = pieces.cells.data();
  float* const lengths = pieces.lengths.data();
  int count = 0;  // what is kept moves forward, never beyond what is read
  for (int n = 0; n < steps; ++n) {
    const __m512i cell = _mm512_loadu_si512(cells + n * kBatch);
    const __m512 length = _mm512_loadu_ps(lengths + n * kBatch);
    const __mmask16 kept = _mm512_cmp_ps_mask(length, _mm512_setzero_ps(), _CMP_NEQ_OQ);
    _mm512_storeu_si512(cells + count, _mm512_maskz_compress_epi32(kept, cell));
    _mm512_storeu_ps(lengths + count, _mm512_maskz_compress_ps(kept, length));
    count += std::popcount(unsigned(kept));
  }
  for (int k = 0; k < count; ++k) to[cells[k]] += lengths[k];
}
#endif

template <int W>
[[gnu::always_inline]] inline void deposit(const DepositTask& task) {
  Stage stage;
  Pieces pieces;
  for (std::size_t first = 0; first < task.points.size(); first += kStage) {
    const int count = int(std::min(task.points.size() - first, std::size_t(kStage)));
    const int padded = prepare(task, task.points.data() + first, count, stage);
    for (int batch = 0; batch < padded; batch += kBatch) {
      const int steps = 1 + *std::max_element(stage.faces + batch, stage.faces + batch + kBatch);
      if (std::size_t(steps * kBatch) > pieces.cells.size()) {
        pieces.cells.resize(std::size_t(steps * kBatch));
        pieces.lengths.resize(pieces.cells.size());
      }
      for (int lane = 0; lane < kBatch; lane += W) walk<W>(task, stage, batch, lane, steps, pieces);
#if defined(__x86_64__)
      if constexpr (W == 16) addPieces16(task.cells, pieces, steps);
#endif
      if constexpr (W != 16) addPieces(task.cells, pieces, steps);
    }
  }
}

#if defined(__x86_64__)
COIF_TARGET_16_LANES void deposit16(const DepositTask& task) {
  deposit<16>(task);
}
COIF_TARGET_8_LANES void deposit8(const DepositTask& task) {
  deposit<8>(task);
}
#endif

}  // namespace

void depositSegments(const DepositTask& task, int lanes) {
#if defined(__x86_64__)
  if (lanes == 16) return deposit16(task);
  if (lanes == 8) return deposit8(task);
#endif
  (void)lanes;
  deposit<4>(task);
}

}  // namespace coif
