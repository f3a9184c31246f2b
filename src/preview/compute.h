// Work on the device's memory outside of the drawing pipeline. What was asked for before is finished first,
// be it drawn or computed: OpenGL orders filling after a shader's writes only behind a barrier, and llvmpipe
// computes and fills at once while it has yet to shade what was drawn. The room's other files call none of
// OpenGL's own commands for this (a test looks), so that none forgets to wait.
#pragma once

#include <cstddef>
#include <cstdint>

#include "preview/gl_objects.h"

namespace coif::preview {

/// A buffer of that many bytes, undefined.
Buffer emptyBuffer(std::size_t bytes, GLbitfield flags = 0);
/// Fills a buffer of 32-bit numbers.
void fill(const Buffer& buffer, std::uint32_t value);
/// Puts bytes at the start of a buffer that may be written to.
void write(const Buffer& buffer, const void* data, std::size_t bytes);
void read(const Buffer& buffer, std::size_t from, void* data, std::size_t bytes);

/// Runs the bound program in `count` groups: gl_WorkGroupID.y counts whole rows of groups.
void dispatchGroups(std::size_t count);
/// The groups that dispatchGroups runs: rows are whole, so there may be a few more.
std::size_t groupsDispatched(std::size_t count);
/// In groups of 64.
void dispatchInvocations(std::size_t count);
/// A square of size² invocations, in groups of 8 × 8.
void dispatchSquare(int size);

}  // namespace coif::preview
