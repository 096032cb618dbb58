#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fit/detail/exposed_pair.h"
#include "fit/detail/proof_words.h"
#include "fit/detail/sense_claims.h"
#include "fit/detail/solid_proof.h"
#include "fit/detail/stated_proof.h"
#include "innermap/fit/mapped_solid.h"
#include "mesh/winding_number.h"
#include "proof/recheck.h"

namespace innermap {
namespace {

constexpr double kFirstCells = 16;     // for each charge
constexpr double kMore = 4;            // times as many, as long as a claim is not reached
constexpr std::size_t kLowTried = 64;  // cells whose middle may have too small a determinant

bool allHold(const std::vector<Claim>& claims) {
  return std::all_of(claims.begin(), claims.end(),
                     [](const Claim& c) { return c.result == ClaimResult::holds; });
}

bool anyFails(const std::vector<Claim>& claims) {
  return std::any_of(claims.begin(), claims.end(),
                     [](const Claim& c) { return c.result == ClaimResult::fails; });
}

// The less sure of two.
ClaimResult weaker(ClaimResult a, ClaimResult b) {
  for (const ClaimResult r : {ClaimResult::fails, ClaimResult::unshown})
    if (a == r || b == r) return r;
  return ClaimResult::holds;
}

// What it takes to show what is claimed of one map.
class Verifier {
 public:
  Verifier(const MappedSolid& mapped, const ProofFigures& claimed, const VerifySettings& settings)
      : source_(mapped.boundary.source),
        map_(mapped.map),
        expanded_(mapped.map),
        solid_(mapped.solid().repaired().mesh),
        exposed_(exposedPair(mapped.boundary)),
        winding_(solid_.vertices, solid_.triangles),
        known_(mapped.injectivity),
        claimed_(claimed),
        settings_(settings) {}

  Verification run() {
    Verification out;
    out.claimed = claimed_;
    out.claims = sense();
    if (claimed_.boundaryError > 0) out.claims.push_back(boundary());
    out.found = proofFigures(sense_, boundary_);
    known_.proof = claimed_;
    if (countsPreimages(known_)) out.claims.push_back(preimagesOf(out.claims));
    if (claimed_.oneToOne > 0) out.claims.push_back(oneToOne());
    if (settings_.sample > 0) out.claims.push_back(agreement());
    return out;
  }

 private:
  // With so many cells for each charge, and in any case.
  ProofSettings proofSettings(double cells) const {
    ProofSettings out;
    const double first = std::min(kFirstCells, settings_.proofCells);
    out.leastCells =
        static_cast<std::uint64_t>(static_cast<double>(out.leastCells) * cells / first);
    out.cellsPerCharge = cells;
    out.keepProven = true;
    out.least = claimed_.least * (1 - kClaimDigits);
    return out;
  }

  // Tries with fewer cells first; until done() or the number is up.
  template <class Try, class Done>
  void withMoreCells(const Try& attempt, const Done& done) const {
    for (double cells = std::min(kFirstCells, settings_.proofCells);;
         cells = std::min(kMore * cells, settings_.proofCells)) {
      attempt(proofSettings(cells));
      if (done() || cells >= settings_.proofCells) return;
    }
  }

  std::vector<Claim> sense() {
    std::vector<Claim> claims;
    withMoreCells(
        [&](const ProofSettings& s) {
          sense_ = proveSolid(expanded_, source_.solid, s);
          claims = senseClaims(claimed_, sense_, evidence());
        },
        [&] {
          return allHold(claims) || anyFails(claims) ||
                 sense_.undecided.count + sense_.weak.count == 0;
        });
    return claims;
  }

  SenseEvidence evidence() const {
    SenseEvidence out;
    if (sense_.undecided.count > 0)
      for (const Vec3& q : map_.steps().front().field().sources())
        if (winding_.wholeAt(q) > 0) {
          out.chargeInside = q;
          break;
        }
    const std::size_t tried = std::min(kLowTried, sense_.weak.places.size());
    for (std::size_t i = 0; i < tried && !out.lowAt; ++i) {
      const Vec3& p = sense_.weak.places[i].center;
      if (std::abs(winding_.exactAt(p)) < 0.5) continue;
      const double most = proof::largestDeterminant(map_, p);
      if (!(most < claimed_.least)) continue;
      out.lowAt = p;
      out.low = most;
    }
    return out;
  }

  Claim boundary() {
    Claim out;
    out.name = "boundary";
    out.claimed = fmt::format(
        "no point of the boundary is farther than {} of the target's diagonal from where it "
        "should be",
        atMost(claimed_.boundaryError, 6));
    withMoreCells([&](const ProofSettings& s) { boundBoundary(s); },
                  [&] { return boundaryHolds() || boundaryFails(); });
    if (boundaryHolds()) {
      out.result = ClaimResult::holds;
      out.found = "none is farther than " + atMost(boundary_.error, 6);
      return out;
    }
    if (boundaryFails()) out.result = ClaimResult::fails;
    out.found = std::isfinite(boundary_.error)
                    ? fmt::format("{:.6g} at one point, none farther than {}", boundary_.seen,
                                  atMost(boundary_.error, 6))
                    : fmt::format("{:.6g} at one point; no bound near some others", boundary_.seen);
    out.places = {boundary_.seenAt};
    return out;
  }

  // The search ends short of what was seen by no more than the claim leaves room for.
  void boundBoundary(ProofSettings s) {
    boundary_ = proveBoundaryError(expanded_, exposed_.surface, exposed_.targets, s);
    const double room = claimed_.boundaryError / boundary_.seen - 1;
    if (boundaryHolds() || !(room > 0) || room > s.errorMargin) return;
    s.errorMargin = std::max(1e-3, 0.9 * room);
    boundary_ = proveBoundaryError(expanded_, exposed_.surface, exposed_.targets, s);
  }

  double mostError() const { return claimed_.boundaryError * (1 + kClaimDigits); }
  bool boundaryHolds() const { return boundary_.error <= mostError(); }
  bool boundaryFails() const {
    return boundary_.seen > mostError() &&
           proof::sureDistance(map_, boundary_.seenAt, boundary_.seenTo) > mostError() * diagonal();
  }

  double diagonal() const { return boundingBox(exposed_.targets).diagonal(); }

  Claim preimagesOf(const std::vector<Claim>& claims) const {
    Claim out;
    out.name = "preimages";
    out.claimed = preimages(known_);
    out.result = ClaimResult::holds;
    for (const Claim& claim : claims)
      if (claim.name == "sense" || claim.name == "boundary")
        out.result = weaker(out.result, claim.result);
    // Without these two it may still be so.
    if (out.result == ClaimResult::fails) out.result = ClaimResult::unshown;
    out.found = out.result == ClaimResult::holds
                    ? "follows from the proofs of det J and the boundary"
                    : "does not follow from the proofs above";
    return out;
  }

  Claim oneToOne() const {
    Claim out;
    out.name = "one-to-one";
    out.claimed = "no two points of the solid go to one";
    if (!sense_.whole() || !isEmbedded(source_)) {
      out.found =
          "does not follow, as the surface crosses itself or the sign of det J is not known";
      return out;
    }
    const EmbeddingProof proof =
        proveEmbedding(expanded_, solid_, proofSettings(settings_.proofCells));
    if (proof.proven && proof.connected) out.result = ClaimResult::holds;
    out.found = out.result == ClaimResult::holds
                    ? "the boundary is connected and does not meet itself"
                : proof.connected ? fmt::format("{} pairs of patches may meet", proof.undecided)
                                  : "the boundary is not connected";
    out.places = proof.places;
    return out;
  }

  Claim agreement() const {
    proof::RecheckSettings s;
    s.cells = settings_.sample;
    s.points = 4 * settings_.sample;
    s.seed = settings_.seed;
    Claim out;
    out.name = "agreement";
    out.claimed = fmt::format("intervals and plain sums agree on a sample of seed {}", s.seed);
    const proof::Recheck cells = proof::recheckSense(map_, solid_, sense_, s);
    out.found = fmt::format("{} of {} cells decided", cells.decided, cells.drawn);
    if (cells.decided > 0)
      out.found += fmt::format(", |det J| from {:.6g} to {:.6g}", cells.least, cells.greatest);
    out.found += fmt::format("; {} points of the solid looked up", cells.points);
    std::optional<proof::Disagreement> against = cells.disagreement;
    if (std::isfinite(boundary_.error) && boundary_.examined > 0) {
      const proof::Recheck triangles =
          proof::recheckBoundary(map_, exposed_.surface, exposed_.targets, boundary_.error, s);
      out.found += fmt::format("; {} of {} triangles decided, errors up to {:.6g}",
                               triangles.decided, triangles.drawn, triangles.least);
      if (!against) against = triangles.disagreement;
    }
    out.result = against                                 ? ClaimResult::fails
                 : cells.drawn > 0 && cells.decided == 0 ? ClaimResult::unshown
                                                         : ClaimResult::holds;
    if (!against) return out;
    out.found = against->what;
    out.places = {against->place};
    return out;
  }

  const SourceBoundary& source_;
  const ComposedMap& map_;
  const ExpandedMap expanded_;
  const Mesh& solid_;
  const ExposedPair exposed_;
  const WindingNumber winding_;
  Injectivity known_;
  const ProofFigures claimed_;
  const VerifySettings settings_;
  SenseProof sense_;
  BoundaryProof boundary_;
};

}  // namespace

std::string wordOf(ClaimResult result) {
  return result == ClaimResult::holds   ? "holds"
         : result == ClaimResult::fails ? "fails"
                                        : "cannot be shown";
}

std::vector<Setting> describe(VerifySettings& s) {
  return {
      Setting("proof_cells", "N", &s.proofCells,
              "look at so many cells for each charge, at most, before a claim counts as not shown")
          .from(1, 1e6),
      Setting("sample", "N", &s.sample,
              "check so many cells, and triangles of the boundary, in another way too; 0: none")
          .from(0, 1e6),
      seedSetting(&s.seed)};
}

bool Verification::holds() const { return allHold(claims); }

Verification verifyMap(const MappedSolid& mapped, const VerifySettings& settings) {
  requireDescribed(settings);
  const StatedProof stated = statedProof(mapped.facts);
  if (!stated.any) return {};
  if (stated.fault.empty()) return Verifier(mapped, stated.proof, settings).run();
  Claim form;
  form.name = "form";
  form.result = ClaimResult::fails;
  form.claimed = "a proof";
  form.found = stated.fault;
  return {{form}, {}, {}};
}

std::uint64_t verifyMemory(const MappedSolid& mapped, const VerifySettings& settings) {
  ProofSettings most;
  most.cellsPerCharge = settings.proofCells;
  most.leastCells = static_cast<std::uint64_t>(static_cast<double>(most.leastCells) *
                                               std::max(1.0, settings.proofCells / kFirstCells));
  return proofMemory(mapped.map, mapped.solid().surface().triangles.size(), most);
}

}  // namespace innermap
