#include "fit/detail/sense_claims.h"

#include <fmt/format.h>

#include <algorithm>

#include "fit/detail/proof_words.h"

namespace innermap {
namespace {

constexpr std::size_t kListedCells = 16;

constexpr int kDigits = 6;

std::string shareAtLeast(double share) { return atLeast(100 * share, kDigits) + "%"; }
std::string shareAtMost(double share) { return atMost(100 * share, kDigits) + "%"; }

std::string cellsOf(const ProofCells& cells) {
  return fmt::format("{} cell{}, {} of the solid at most,", cells.count,
                     cells.count == 1 ? "" : "s", shareAtMost(cells.share));
}

std::string sign(bool mirrored) { return mirrored ? "det J < 0" : "det J > 0"; }

Points centersOf(const std::vector<ProofCell>& cells) {
  Points out;
  for (std::size_t i = 0; i < std::min(kListedCells, cells.size()); ++i)
    out.push_back(cells[i].center);
  return out;
}

// What is claimed not to be folded, nor undecided.
double claimedShare(const ProofFigures& p) {
  return p.whole() ? 1 : std::max(p.proven, 1 - p.undecidedShare - p.negativeShare);
}

void refuteSense(const ProofFigures& p, const SenseProof& found, const SenseEvidence& evidence,
                 Claim& claim) {
  claim.result = ClaimResult::fails;
  if (evidence.chargeInside) {
    claim.found = "a charge lies in the solid, where the map is not even defined";
    claim.places = {*evidence.chargeInside};
  } else if (found.proven.count > 0 && found.mirrored != p.mirrored) {
    claim.found =
        fmt::format("{} on {} of the solid", sign(found.mirrored), shareAtLeast(found.provenShare));
    claim.places = centersOf(found.proven.places);
  } else if (p.whole() && found.negative.count > 0) {
    claim.found = "the other sign on " + cellsOf(found.negative) + " everywhere";
    claim.places = centersOf(found.negative.places);
  } else {
    claim.result = ClaimResult::unshown;
    claim.found =
        fmt::format("{} in {} of the solid at least; on {} it is undecided", sign(found.mirrored),
                    shareAtLeast(found.provenShare), cellsOf(found.undecided));
    claim.places = centersOf(found.undecided.places);
  }
}

Claim senseClaim(const ProofFigures& p, const SenseProof& found, const SenseEvidence& evidence) {
  Claim out;
  out.name = "sense";
  const double share = claimedShare(p);
  out.claimed =
      sign(p.mirrored) + (p.whole() ? " everywhere in the solid"
                                    : " in " + shareAtLeast(share) + " of the solid at least");
  const bool shown = p.whole() ? found.whole() : found.provenShare >= share - kClaimDigits;
  if (!shown || found.proven.count == 0 || found.mirrored != p.mirrored || evidence.chargeInside) {
    refuteSense(p, found, evidence, out);
    return out;
  }
  out.result = ClaimResult::holds;
  out.found = found.whole() ? fmt::format("yes, on {} cells", found.proven.count)
                            : fmt::format("in {} at least, on {} cells",
                                          shareAtLeast(found.provenShare), found.proven.count);
  return out;
}

Claim undecidedClaim(const ProofFigures& p, const SenseProof& found) {
  Claim out;
  out.name = "undecided";
  out.claimed =
      "the sign of det J is known except in " + shareAtMost(p.undecidedShare) + " of the solid";
  out.found = found.undecided.count == 0 ? "it is known everywhere"
                                         : "on " + cellsOf(found.undecided) + " it is not known";
  out.result = found.undecided.share <= p.undecidedShare + kClaimDigits ? ClaimResult::holds
                                                                        : ClaimResult::unshown;
  if (out.result != ClaimResult::holds) out.places = centersOf(found.undecided.places);
  return out;
}

Claim foldedClaim(const SenseProof& found) {
  Claim out;
  out.name = "folded";
  out.claimed = "the map folds";
  out.found = found.whole() ? "it folds nowhere"
              : found.negative.count > 0
                  ? "the other sign on " + cellsOf(found.negative) + " everywhere"
                  : "no cell where it folds";
  out.result = found.negative.count > 0 ? ClaimResult::holds
               : found.whole()          ? ClaimResult::fails
                                        : ClaimResult::unshown;
  return out;
}

Claim leastClaim(const ProofFigures& p, const SenseProof& found, const SenseEvidence& evidence) {
  Claim out;
  out.name = "least";
  const double share = claimedShare(p);
  out.claimed = fmt::format("|det J| is {} at least {}", atLeast(p.least, kDigits),
                            p.whole() ? "there" : "in " + shareAtLeast(share) + " of the solid");
  const bool shown =
      p.whole() ? found.whole() && found.weak.count == 0 : found.leastShare >= share - kClaimDigits;
  if (shown) {
    out.result = ClaimResult::holds;
    out.found = found.whole() ? "yes" : "in " + shareAtLeast(found.leastShare) + " at least";
  } else if (p.whole() && evidence.lowAt) {
    out.result = ClaimResult::fails;
    out.found = atMost(evidence.low, kDigits) + " at most at one point";
    out.places = {*evidence.lowAt};
  } else {
    out.found = "in " + shareAtLeast(found.leastShare) + " of the solid at least";
    out.places = centersOf(found.weak.places);
  }
  return out;
}

}  // namespace

std::vector<Claim> senseClaims(const ProofFigures& claimed, const SenseProof& found,
                               const SenseEvidence& evidence) {
  std::vector<Claim> out{senseClaim(claimed, found, evidence)};
  if (claimed.negative > 0) out.push_back(foldedClaim(found));
  if (!claimed.whole()) out.push_back(undecidedClaim(claimed, found));
  if (claimed.least > 0) out.push_back(leastClaim(claimed, found, evidence));
  return out;
}

}  // namespace innermap
