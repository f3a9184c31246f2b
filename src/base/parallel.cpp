#include "coif/base/parallel.h"

#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <vector>

#ifdef __SANITIZE_THREAD__
#include <sanitizer/tsan_interface.h>
#endif

namespace coif {

namespace {

/// How chunks are handed over and back is oneTBB's own affair, which ThreadSanitizer does not see where the
/// system's library is built without it. Chunks stay unordered among each other: their races are reported.
#ifdef __SANITIZE_THREAD__
void give(void* token) {
  __tsan_release(token);
}
void take(void* token) {
  __tsan_acquire(token);
}
#else
void give(void*) {}
void take(void*) {}
#endif

}  // namespace

void parallelFor(const Context& context, std::size_t count, std::size_t grain,
                 const std::function<void(std::size_t, std::size_t)>& body) {
  if (count == 0) return;
  grain = std::max<std::size_t>(grain, 1);
  const std::size_t chunks = (count + grain - 1) / grain;
  const auto runChunk = [&](std::size_t chunk) {
    if (context.cancelled()) return;
    body(chunk * grain, std::min(count, (chunk + 1) * grain));
  };
  if (chunks == 1 || context.threads == 1) {
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) runChunk(chunk);
    return;
  }
  // Asked for more than there are, oneTBB says so on the error stream, and takes what there are.
  const int threads = context.threads > 0
                          ? std::min(context.threads, oneapi::tbb::info::default_concurrency())
                          : oneapi::tbb::task_arena::automatic;
  oneapi::tbb::task_arena arena(threads);
  static char out;  // not of this call: a chunk takes it before it may look at anything of this call's
  char back = 0;
  arena.execute([&] {
    const auto handed = [&](std::size_t chunk) {
      take(&out);
      runChunk(chunk);
      give(&back);
    };
    give(&out);
    oneapi::tbb::parallel_for(std::size_t{0}, chunks, handed);
  });
  take(&back);
}

double parallelSum(const Context& context, std::size_t count, std::size_t grain,
                   const std::function<double(std::size_t, std::size_t)>& partial) {
  if (count == 0) return 0;
  grain = std::max<std::size_t>(grain, 1);
  std::vector<double> sums((count + grain - 1) / grain, 0.0);
  parallelFor(context, count, grain,
              [&](std::size_t begin, std::size_t end) { sums[begin / grain] = partial(begin, end); });
  for (std::size_t width = 1; width < sums.size(); width *= 2) {
    for (std::size_t i = 0; i + width < sums.size(); i += 2 * width) sums[i] += sums[i + width];
  }
  return sums[0];
}

}  // namespace coif
