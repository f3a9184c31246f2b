// What the key light sees of the hair, on the GPU: the visibility methods of light's visibility.h, by the
// same rule of fragments, so that both give the same transmittance. Strands are walked over the map by
// compute and add up in whole numbers (shaders/map_walk.comp); density clustering, whose moments need floats,
// is drawn as lines.
//
// Cost in passes over the strands: None and LightMap 0; Exact 2; DeepOpacity and Occupancy 2; Opacity 2, more
// where a storage block does not hold all slices; DensityClustering 3. Bytes a texel: DeepOpacity 8 + 4 ·
// layers (in fours), Occupancy 40, DensityClustering 56 (and 64 while it is made), Opacity 8 + 4 · slices,
// Exact 12 and 8 a fragment.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "coif/light/light_view.h"
#include "coif/light/visibility.h"
#include "preview/fragment_lists.h"
#include "preview/frame_data.h"
#include "preview/synthesis.h"

namespace coif::preview {

/// Errors: InvalidArgument for what the GPU's versions do not have: more than 256 slices or 16 layers,
/// clusters other than 4, occupancy other than 128 slices in 4 slabs.
Status checkMapOptions(const VisibilityOptions& options);

/// The permutation of hair_map_query.glsl for these options, for any shader that looks the map up.
std::vector<std::string> mapDefines(const VisibilityOptions& options);

class HairMap {
 public:
  HairMap() = default;  ///< no hair; nothing to bind
  /// Draws the map; lines (Topology::Segments) or null for no hair. `options.layerSize` must be set for
  /// DeepOpacity. Errors: TooLarge where the driver cannot hold it.
  static Result<HairMap> make(const Programs& programs, const StrandBuffers* lines, const LightView& view,
                              double opacity, const VisibilityOptions& options);
  /// Deep opacity of the fewest of 3, 7, 11 and 15 layers whose bound is at most `options.bound`; where none
  /// is, the fewest within 3 % of the least. With `lists`, sorted lists instead where those take no more
  /// memory than three layers. `layerSize` says s for a number of layers where `options` does not.
  static Result<HairMap> makeFewest(const Programs& programs, const StrandBuffers& lines,
                                    const LightView& view, double opacity, const VisibilityOptions& options,
                                    bool lists, const std::function<double(int)>& layerSize);

  /// As VisibilityMap::aPosterioriBound: of deep opacity and of lists; one where nothing is known.
  TransmittanceBound bound(const Programs& programs) const;
  const std::string& choice() const { return choice_; }  ///< why makeFewest chose what it did

  /// Uniform block 1, texture units 2 … 4, storage blocks 1 … 3, as hair_map_query.glsl names them.
  void bind() const;
  const VisibilityOptions& options() const { return options_; }
  const LightView& view() const { return view_; }
  std::size_t bytes() const { return bytes_; }

  struct Answer {
    float transmittance, opticalDepth;  ///< the latter unfiltered
  };
  /// Texels that one pass over the strands touches, each as often as a segment does.
  Result<std::uint64_t> texelsTouched(const Programs& programs, const StrandBuffers& lines) const;
  /// Looks up world points, for tests and for measuring errors. Filtered as the options say.
  std::vector<Answer> query(const Programs& programs, std::span<const Vec3> points) const;

 private:
  void placeUniforms(double opacity);
  void drawRange(const Programs& programs, const StrandBuffers& lines);
  void drawWholeRange(const Programs& programs);
  Status drawOpacity(const Programs& programs, const StrandBuffers& lines);
  Status drawDeep(const Programs& programs, const StrandBuffers& lines);
  void drawClusters(const Programs& programs, const StrandBuffers& lines);
  Status drawOccupancy(const Programs& programs, const StrandBuffers& lines);
  void resolve(const Programs& programs, const ProgramSource& source) const;
  Status drawLists(const Programs& programs, const StrandBuffers& lines);
  Result<bool> drawShortLists(const Programs& programs, const StrandBuffers& lines);
  Status draw(const Programs& programs, const StrandBuffers& lines);
  Texture makeLayers(int count, GLenum format = GL_RGBA32F);
  Texture makeFlat(GLenum format);

  LightView view_;
  VisibilityOptions options_;
  std::string choice_;
  std::size_t bytes_ = 0, listLimit_ = SIZE_MAX;
  Buffer uniforms_, wholeRange_;
  Texture range_, layers_, bits_;
  std::optional<FragmentLists> lists_;
};

/// Opacity slices, and a last deep layer that is enlarged, need the depths of all fragments taken together.
bool needsWholeRange(const VisibilityOptions& options);

/// Those that walk over the map by compute (hair_map_walk.cpp).
std::vector<ProgramSource> walkPrograms();
/// Every permutation that maps are drawn with, for the test that compiles them all.
std::vector<ProgramSource> mapPrograms();
/// Methods and options that look-ups differ by.
std::vector<std::vector<std::string>> mapQueryPermutations();

}  // namespace coif::preview
