// Parallel loops over index ranges (oneTBB inside).
#pragma once

#include <cstddef>
#include <functional>

#include "coif/base/context.h"

namespace coif {

/// Calls body(begin, end) over [0, count) in chunks of at most `grain` indices, on context.threads threads.
/// Chunk boundaries depend on count and grain alone, so per-chunk results are the same for any thread count.
/// Stops handing out chunks once context.cancelled(). Exceptions of the body reach the caller.
void parallelFor(const Context& context, std::size_t count, std::size_t grain,
                 const std::function<void(std::size_t begin, std::size_t end)>& body);

/// Σ partial(begin, end) over fixed chunks, added pairwise in index order: the same bits for any thread
/// count.
double parallelSum(const Context& context, std::size_t count, std::size_t grain,
                   const std::function<double(std::size_t begin, std::size_t end)>& partial);

}  // namespace coif
