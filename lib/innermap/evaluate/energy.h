// Energy densities of a map from its Jacobian, after Li et al., "Meshless Harmonic Volumetric
// Mapping Using Fundamental Solution Methods" (IEEE T-ASE 2009), formulas (3) and (4).
#pragma once

#include <vector>

#include "innermap/core/setting.h"
#include "innermap/core/vec3.h"

namespace innermap {

// Elastic constants; the defaults are the paper's (rubber). lambda >= 0, mu >= 0.
struct LameConstants {
  double lambda = 0.0335;
  double mu = 0.0224;
};

std::vector<Setting> describe(LameConstants& settings);

// ||J||^2, the squared Frobenius norm: 3 for the identity and every rotation.
double harmonicEnergyDensity(const Mat3& jacobian);

// psi = 1/2 s : e with strain e = J^T J - I (no factor 1/2) and stress s = lambda tr(e) I + 2 mu e.
// 0 for every rigid motion, reflections included; (s^2 - 1)^2 (9/2 lambda + 3 mu) for uniform
// scaling by s.
double deformationEnergyDensity(const Mat3& jacobian, const LameConstants& lame = {});

}  // namespace innermap
