// What is claimed of det J, beside what was found.
#pragma once

#include <optional>
#include <vector>

#include "innermap/fit/mapped_solid.h"

namespace innermap {

// Figures are compared to so much of them: another machine's differ in the last digits, as sums
// are put together otherwise there.
constexpr double kClaimDigits = 1e-9;

// What rules such claims out, beside the proof's cells.
struct SenseEvidence {
  std::optional<Vec3> chargeInside;  // a charge of the first step lies in the solid
  // A point of the solid where |det J| is below the claim, and what it is there at most.
  std::optional<Vec3> lowAt;
  double low = 0;
};

// `found`: with ProofSettings::least as claimed. Claims about what is claimed alone.
std::vector<Claim> senseClaims(const ProofFigures& claimed, const SenseProof& found,
                               const SenseEvidence& evidence);

}  // namespace innermap
