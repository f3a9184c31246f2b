#include "preview/fibre_tables.h"

#include "coif/light/hair_color.h"
#include "preview/frame_data.h"

namespace coif::preview {
namespace {

/// The uniform block `Fibre`; std140.
struct FibreBlock {
  Vec4f shifts, variances;
  std::int32_t counts[4];
  Vec4f densities;
};
static_assert(sizeof(FibreBlock) == 64);

Texture floatTexture(GLenum target, int width, int height, int layers) {
  GLuint name = 0;
  glCreateTextures(target, 1, &name);
  if (layers > 1) {
    glTextureStorage3D(name, 1, GL_RGB32F, width, height, layers);
  } else {
    glTextureStorage2D(name, 1, GL_RGB32F, width, height);
  }
  glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTextureParameteri(name, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTextureParameteri(name, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  return Texture(name);
}

// ā_b at the tables' inclinations: what a hair sends back of light from the eye's side.
std::vector<float> backwardAttenuation(const DualScattering& dual) {
  const int count = dual.tables().inclinations;
  std::vector<float> out;
  for (int i = 0; i < count; ++i) {
    const double theta = 3.14159265358979323846 * (double(i) / (count - 1) - 0.5);
    for (int channel = 0; channel < 3; ++channel)
      out.push_back(float(dual.means(theta, channel).attenuationBackward));
  }
  return out;
}

}  // namespace

FibreParameters fibreOf(const PreviewOptions& options) {
  FibreParameters fibre = options.fibre;
  if (options.shading == PreviewShading::KajiyaKay) {
    fibre.model = FibreModel::KajiyaKay;
  } else if (fibre.model == FibreModel::KajiyaKay) {
    fibre.model = FibreModel::Chiang;
  }
  if (!options.useAbsorption) {
    fibre.absorption =
        absorptionFromAlbedo(options.hairColor.cast<double>(), options.fibre.azimuthalRoughness);
  }
  return fibre;
}

bool sameFibre(const FibreParameters& a, const FibreParameters& b) {
  return a.model == b.model && a.absorption == b.absorption && a.index == b.index &&
         a.longitudinalRoughness == b.longitudinalRoughness && a.azimuthalRoughness == b.azimuthalRoughness &&
         a.tiltRad == b.tiltRad;
}

FibreTables::FibreTables(const FibreParameters& fibre) : fibre_(fibre) {
  const FibreScattering scattering(fibre);
  const DualScattering dual(scattering);
  const DualScatteringTables& tables = dual.tables();
  const Vec3 a = scattering.parameters().absorption;
  grey_ = a.x() == a.y() && a.y() == a.z();
  const auto across = 3 * std::size_t(tables.inclinations / 2);
  for (int c = 0; c < 3; ++c) forwardAcross_[c] = float(tables.forwardAttenuation[across + std::size_t(c)]);

  azimuthal_ = floatTexture(GL_TEXTURE_2D_ARRAY, tables.azimuths, tables.azimuthInclinations, 8);
  inclination_ = floatTexture(GL_TEXTURE_2D, tables.inclinations, 6, 1);
  int layer = 0;
  for (const auto* table : {&tables.azimuthal, &tables.azimuthalScattered}) {
    glTextureSubImage3D(azimuthal_.name(), 0, 0, 0, layer, tables.azimuths, tables.azimuthInclinations, 4,
                        GL_RGB, GL_FLOAT, table->data());
    layer += 4;
  }
  const std::vector<float> backward = backwardAttenuation(dual);
  int row = 0;
  for (const auto* table :
       {&tables.forwardAttenuation, &tables.forwardVariance, &tables.backscatterAttenuation,
        &tables.backscatterShift, &tables.backscatterVariance, &backward}) {
    glTextureSubImage2D(inclination_.name(), 0, 0, row++, tables.inclinations, 1, GL_RGB, GL_FLOAT,
                        table->data());
  }
  FibreBlock block;
  for (int lobe = 0; lobe < 4; ++lobe) {
    block.shifts[lobe] = float(scattering.lobeShift(kFibreLobes[std::size_t(lobe)]));
    block.variances[lobe] = float(scattering.lobeVariance(kFibreLobes[std::size_t(lobe)]));
  }
  block.counts[0] = int(fibre.model);
  block.counts[1] = tables.inclinations;
  block.counts[2] = tables.azimuthInclinations;
  block.counts[3] = 0;
  const auto& densities = dual.parameters();
  block.densities = Vec4f(float(densities.forwardDensity), float(densities.backwardDensity), 0, 0);
  uniforms_ = makeBuffer(std::span<const FibreBlock>(&block, 1));
}

void FibreTables::bind() const {
  glBindBufferBase(GL_UNIFORM_BUFFER, 2, uniforms_.name());
  glBindTextureUnit(5, azimuthal_.name());
  glBindTextureUnit(6, inclination_.name());
}

}  // namespace coif::preview
