// All fragments of every texel or pixel, sorted by depth (shaders/lists.glsl): counted, given room, written,
// sorted. The result does not depend on the order in which they come.
#pragma once

#include <cstdint>
#include <vector>

#include "preview/gl_objects.h"
#include "preview/program.h"

namespace coif::preview {

class FragmentLists {
 public:
  FragmentLists(int width, int height);
  /// Image unit 1: counts, zero at first. Draw with a program that counts, then call.
  void bindCounts() const;
  /// Makes room for what was counted, `entryBytes` each. Errors: TooLarge, also above `mostBytes`.
  Status makeRoom(std::size_t entryBytes, std::size_t mostBytes = SIZE_MAX);
  /// Image unit 1 and storage blocks 1 and 2, for writing and for look-ups.
  void bind() const;
  /// With lists_sort.comp's permutation.
  void sort(GLuint program) const;
  std::size_t entries() const { return entries_; }
  std::size_t bytes() const { return bytes_; }

 private:
  int width_ = 0, height_ = 0;
  std::size_t entries_ = 0, bytes_ = 0;
  Texture counts_;
  Buffer starts_, list_;
};

}  // namespace coif::preview
