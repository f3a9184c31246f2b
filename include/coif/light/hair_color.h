// The colour of a hair: what absorbs light inside it.
//
// Absorption is σ_a in 1 / fibre radius, linear RGB. By melanin: d'Eon et al. 2011's absorption at unit
// concentration. By target albedo: Chiang et al. 2016's inversion, (9), a fit to the colour of a dense volume
// of hair after many scatterings; it depends on the azimuthal roughness.
#pragma once

#include "coif/base/vec.h"

namespace coif {

struct Melanin {
  double eumelanin = 1.3;    ///< brown to black, >= 0
  double pheomelanin = 0.2;  ///< yellow to red, >= 0
};

/// Absorption by melanin. Negative and NaN amounts are 0.
Vec3 absorptionFromMelanin(const Melanin& amounts);

/// Absorption that gives dense hair this colour. `albedo` is held within [1e-4, 1]; `azimuthalRoughness`
/// (β_n) within [0, 1].
Vec3 absorptionFromAlbedo(const Vec3& albedo, double azimuthalRoughness);
/// The inverse of the above: the colour that dense hair of this absorption takes.
Vec3 albedoFromAbsorption(const Vec3& absorption, double azimuthalRoughness);

/// Ready colours.
enum class HairColor { Black, Brown, Red, Blond, Grey, Dyed };
/// Of a preset, at β_n = 0.3 for the one that is given as an albedo (Dyed).
Vec3 absorptionOf(HairColor color);
const char* nameOf(HairColor color);

}  // namespace coif
