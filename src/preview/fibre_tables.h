// light's scattering tables on the GPU, as shaders/fibre_tables.glsl reads them.
#pragma once

#include "coif/light/dual_scattering.h"
#include "coif/preview/preview.h"
#include "preview/gl_objects.h"

namespace coif::preview {

/// The hair that the options ask for: shading chooses the model, hairColor the absorption unless it is given.
FibreParameters fibreOf(const PreviewOptions& options);
bool sameFibre(const FibreParameters& a, const FibreParameters& b);

class FibreTables {
 public:
  explicit FibreTables(const FibreParameters& fibre);
  /// Uniform block 2, texture units 5 and 6.
  void bind() const;
  const FibreParameters& fibre() const { return fibre_; }
  bool grey() const { return grey_; }  ///< all channels alike: one is enough
  /// The part that goes on of light across a hair, ā_f.
  Vec3f forwardAcross() const { return forwardAcross_; }

 private:
  FibreParameters fibre_;
  bool grey_ = false;
  Vec3f forwardAcross_ = Vec3f::Zero();
  Buffer uniforms_;
  Texture azimuthal_, inclination_;
};

}  // namespace coif::preview
