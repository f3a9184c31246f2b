#include "strands/deposit_lanes.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "coif/base/lanes.h"

namespace coif {
namespace {

constexpr int kBatch = 16, kStage = 128;  // segments: walked together, prepared together
constexpr float kNever = 2;               // beyond the end of a segment, 1

/// Segments in cells from the task's origin: where they begin and go, where they meet the next face along
/// each axis and how far the faces lie apart, as fractions of the segment.
struct Stage {
  alignas(64) float begin[3][kStage], delta[3][kStage], next[3][kStage], stride[3][kStage];
  alignas(64) float weight[kStage], growth[kStage];  // weight × length, half its change
  alignas(64) int faces[kStage];
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

/// Runs, segment by segment.
class Segments {
 public:
  explicit Segments(std::span<const SegmentRun> runs) : runs_(runs) {}
  /// The next ones' first points, as many as there are and fit.
  int next(std::uint32_t (&out)[kStage]) {
    int count = 0;
    while (count < kStage && run_ < runs_.size()) {
      const SegmentRun run = runs_[run_];
      const std::uint32_t more = std::min(run.count - done_, std::uint32_t(kStage - count));
      for (std::uint32_t k = 0; k < more; ++k) out[count + int(k)] = run.first + done_ + k;
      count += int(more);
      done_ += more;
      if (done_ == run.count) ++run_, done_ = 0;
    }
    return count;
  }

 private:
  std::span<const SegmentRun> runs_;
  std::size_t run_ = 0;
  std::uint32_t done_ = 0;
};

[[gnu::always_inline]] inline int prepare(const DepositTask& task, const std::uint32_t (&segments)[kStage],
                                          int count, Stage& s) {
  const int padded = (count + kBatch - 1) / kBatch * kBatch;
  for (int l = 0; l < count; l += 4) {  // beyond the last one it is repeated, to be overwritten below
    Quad ends[2][4];
    for (int q = 0; q < 4; ++q) {
      const GridPoint* point = task.points.data() + segments[std::min(l + q, count - 1)];
      loadLanes(ends[0][q], &point[0].x);
      loadLanes(ends[1][q], &point[1].x);
    }
    transpose(ends[0], s.begin[0] + l, s.begin[1] + l, s.begin[2] + l, s.weight + l);
    transpose(ends[1], s.delta[0] + l, s.delta[1] + l, s.delta[2] + l, s.growth + l);
  }
  for (int l = count; l < padded; ++l) {
    for (int d = 0; d < 3; ++d) s.begin[d][l] = s.delta[d][l] = task.origin[d] + 1;
    s.weight[l] = s.growth[l] = 0;
  }
  for (int l = 0; l < padded; ++l) s.faces[l] = 0;
  for (int d = 0; d < 3; ++d) {
    float *begin = s.begin[d], *delta = s.delta[d], *next = s.next[d], *stride = s.stride[d];
    const float origin = task.origin[d];
    for (int l = 0; l < padded; ++l) {
      const float a = begin[l] - origin, b = delta[l] - origin;
      const int faces = int(b) - int(a);
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
    const float length = std::sqrt(x * x + y * y + z * z);
    s.growth[l] = 0.5f * (s.growth[l] - s.weight[l]) * length;
    s.weight[l] *= length;
  }
  return padded;
}

/// One piece of each lane a step, up to the next face of any axis. The number of faces is known beforehand,
/// so rounding can displace a crossing but never lose one.
template <int W>
[[gnu::always_inline]] inline void walk(const DepositTask& task, const Stage& s, int first,
                                        std::vector<int>& cells, std::vector<float>& pieces) {
  using Float = typename Lanes<W>::Float;
  using Int = typename Lanes<W>::Int;
  constexpr int kRows = GridDeposit::kSlabRows;
  const int log2 = task.log2Size, size = 1 << log2, mask = size - 1, layer = kRows << log2;
  const int columns =
      (mask * layer) | mask;  // an address without its row; what i carries lands in the row's bits
  Float next[3], stride[3], weight, growth;
  Int faces, cell[3], step[3];
  for (int d = 0; d < 3; ++d) {
    Float begin, delta;
    loadLanes(begin, &s.begin[d][first]);
    loadLanes(delta, &s.delta[d][first]);
    loadLanes(next[d], &s.next[d][first]);
    loadLanes(stride[d], &s.stride[d][first]);
    cell[d] = __builtin_convertvector(begin, Int) & mask;
    const int one = d == 2 ? layer : 1,
              back = d == 2 ? mask * layer : mask;  // −1 is n − 1 where addresses wrap
    step[d] = delta < 0.0f ? Int{} + back : Int{} + one;
  }
  loadLanes(weight, &s.weight[first]);
  loadLanes(growth, &s.growth[first]);
  loadLanes(faces, &s.faces[first]);
  const int steps = 1 + *std::max_element(s.faces + first, s.faces + first + W);
  if (std::size_t(steps * W) > cells.size()) {
    cells.resize(std::size_t(steps * W));
    pieces.resize(cells.size());
  }
  Int column = cell[0] | (cell[2] * layer), row = cell[1];
  const Float zero = Float{}, end = zero + 1.0f;
  const Int none = Int{};
  Float from = zero;
  for (int n = 0; n < steps; ++n) {
    Float to = next[0] < next[1] ? next[0] : next[1];
    to = to < next[2] ? to : next[2];
    to = n < faces ? to : end;
    to = to < end ? to : end;
    to = to > from ? to : from;
    const Float piece = (weight + (from + to) * growth) * (to - from);
    const Float inSlab = (row & ~(kRows - 1)) == task.rowBegin ? piece : zero;
    storeLanes(&cells[std::size_t(n * W)], Int(column | ((row & (kRows - 1)) << log2)));
    storeLanes(&pieces[std::size_t(n * W)], inSlab);
    const auto x = next[0] <= to, y = next[1] <= to, z = next[2] <= to;
    next[0] += x ? stride[0] : zero;
    next[1] += y ? stride[1] : zero;
    next[2] += z ? stride[2] : zero;
    column = (column + (x ? step[0] : none) + (z ? step[2] : none)) & columns;
    row = (row + (y ? step[1] : none)) & mask;
    from = to;
  }
  constexpr int kQuad = 4;  // the order of the sums is that of four lanes
  for (int quad = 0; quad < W; quad += kQuad) {
    const int* most = s.faces + first + quad;
    const int own = 1 + std::max(std::max(most[0], most[1]), std::max(most[2], most[3]));
    for (int at = quad; at < own * W; at += W) {
      for (int l = at; l < at + kQuad; ++l) task.cells[cells[std::size_t(l)]] += pieces[std::size_t(l)];
    }
  }
}

template <int W>
[[gnu::always_inline]] inline void deposit(const DepositTask& task) {
  Stage stage;
  std::vector<int> cells;
  std::vector<float> pieces;
  Segments segments(task.runs);
  std::uint32_t some[kStage];
  while (const int count = segments.next(some)) {
    const int padded = prepare(task, some, count, stage);
    for (int at = 0; at < padded; at += W) walk<W>(task, stage, at, cells, pieces);
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
