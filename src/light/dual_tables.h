// How dual scattering's tables are filled.
#pragma once

#include "coif/light/dual_scattering.h"

namespace coif {

DualScatteringTables buildDualTables(const FibreScattering& fibre, DualFormulas formulas);
/// Of one channel at one inclination, from the azimuthal table: (6), (12).
FibreMeans fibreMeans(const FibreScattering& fibre, const DualScatteringTables& tables, double theta,
                      int channel);

/// Linear interpolation over a table's inclinations, −π/2 … π/2.
Vec3 overInclination(const std::vector<float>& table, int nodes, double theta);
/// Linear in both, of one lobe.
Vec3 overAzimuth(const DualScatteringTables& tables, const std::vector<float>& table, int lobe,
                 double inclination, double phi);

}  // namespace coif
