// What the mesh readers share: walking text, reading numbers, naming faces, keeping to the memory limit.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "coif/base/result.h"
#include "coif/scalp/polygon_mesh.h"
#include "io/formats.h"

namespace coif::io {

/// The stated limit of every reader: the file's bytes and what is made of them.
inline constexpr std::uint64_t kMaxReaderBytes = std::uint64_t{1} << 31;

/// Allocates only what fits under the limit, so that a header cannot claim more.
class MemoryBudget {
 public:
  explicit MemoryBudget(std::uint64_t used) : used_(used) {}

  Status take(std::uint64_t count, std::uint64_t size);
  template <class T>
  Status reserve(std::vector<T>& values, std::uint64_t count) {
    COIF_TRY(take(count, sizeof(T)));
    values.reserve(count);
    return {};
  }

 private:
  std::uint64_t used_;
};

inline std::string_view asText(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// "line 12": the line that holds the byte. Counted only when an error needs it.
std::string linePlace(std::string_view text, std::size_t offset);

/// Walks text by words and lines without copying. Lines end with LF, CR or both.
class TextCursor {
 public:
  enum class Style {
    Plain,
    HashComments,   ///< '#' to the end of the line is blank (OFF)
    Continuations,  ///< a backslash before the line end is blank (OBJ)
  };
  explicit TextCursor(std::string_view text, Style style = Style::Plain, std::size_t offset = 0)
      : text_(text), style_(style), at_(offset) {}

  bool atEnd() const { return at_ >= text_.size(); }
  std::size_t offset() const { return at_; }
  std::size_t wordOffset() const { return word_; }  ///< where the last word began
  std::string_view wordOnLine();                    ///< empty at the end of the line
  std::string_view word();                          ///< on whatever line; empty at the end of the text
  std::string_view restOfLine();                    ///< trimmed; the cursor is left at the line's end
  void nextLine();

 private:
  bool skipBlanks();  ///< false at the end of the line or the text
  std::string_view text_;
  Style style_;
  std::size_t at_;
  std::size_t word_ = 0;
};

/// The whole word as a number. "nan", "inf" and overflows are numbers that are not finite.
bool parseNumber(std::string_view word, double& value);
bool parseInteger(std::string_view word, std::int64_t& value);

/// Groups of faces that a file may state in several ways at once; one of them becomes the mesh's groups.
class FaceNames {
 public:
  enum Kind { Material, Group, Object, kKinds };

  /// The name holds for every face that follows.
  Status set(Kind kind, std::string_view name, std::size_t firstFace, MemoryBudget& budget);
  /// The first kind that tells faces apart, else the first kind that names any; said in the notes when it is
  /// a choice. Faces without a name of that kind fall in "default".
  void finish(PolygonMesh& mesh, const std::array<const char*, kKinds>& kindNames) const;

 private:
  struct Run {
    std::size_t firstFace;
    std::array<std::uint32_t, kKinds> names;
  };
  std::vector<std::uint8_t> namesInUse(Kind kind, std::size_t faceCount) const;
  std::array<std::vector<std::string>, kKinds> names_;
  std::array<std::unordered_map<std::string, std::uint32_t>, kKinds> indexOf_;  // looked up, never walked
  std::vector<Run> runs_{{0, {kNone, kNone, kNone}}};
};

/// Starts another face and closes the one before: what `faceOffsets` needs after its corners are in.
inline void closeFace(PolygonMesh& mesh) {
  mesh.faceOffsets.push_back(std::uint32_t(mesh.corners.size()));
}

/// "3 faces of fewer than three corners are left out.", when there are any.
void noteCount(PolygonMesh& mesh, std::uint64_t count, const std::string& what);

}  // namespace coif::io
