#include "fit/detail/stated_proof.h"

#include <fmt/format.h>

#include <cmath>
#include <map>

namespace innermap {
namespace {

constexpr std::string_view kPrefix = "one_to_one_proof_";

Facts factsOf(const ProofFigures& proof) {
  Injectivity known;
  known.proof = proof;
  Facts out;
  for (const auto& fact : injectivityFacts(known))
    if (fact.first.rfind(kPrefix, 0) == 0) out.push_back(fact);
  return out;
}

// They must be those that a fit writes of these figures: each once, and no other.
std::string differenceOf(const Facts& stated, const ProofFigures& proof) {
  std::map<std::string, std::string> open;
  for (const auto& [key, text] : stated)
    if (!open.emplace(key, text).second) return fmt::format("{} stands there twice", key);
  for (const auto& [key, text] : factsOf(proof)) {
    const auto found = open.find(key);
    if (found == open.end()) return fmt::format("{} is missing", key);
    const auto number = factNumber({*found}, key), taken = factNumber({{key, text}}, key);
    if (!number || !taken || !std::isfinite(*number) || std::abs(*number - *taken) > 0)
      return fmt::format("{} is '{}', which it cannot be", key, found->second);
    open.erase(found);
  }
  if (open.empty()) return "";
  const auto& [key, text] = *open.begin();
  return fmt::format("{} is '{}', which is not known here", key, text);
}

std::string outOfRange(const ProofFigures& p) {
  for (const double share : {p.proven, p.undecidedShare, p.negativeShare})
    if (!(share >= 0 && share <= 1)) return fmt::format("{} is no share", share);
  if (!(p.least >= 0)) return fmt::format("{} is no size of a determinant", p.least);
  if (p.undecided > p.cells || p.negative > p.cells - p.undecided)
    return fmt::format("more cells are undecided or folded than the {} there are", p.cells);
  if (p.oneToOne > 1 || (p.oneToOne == 1 && !p.whole()))
    return "one-to-one as a whole, though not all cells are proven";
  return "";
}

}  // namespace

StatedProof statedProof(const Facts& facts) {
  StatedProof out;
  Facts stated;
  for (const auto& fact : facts)
    if (fact.first.rfind(kPrefix, 0) == 0) stated.push_back(fact);
  if (stated.empty()) return out;
  out.any = true;
  Injectivity known;
  readInjectivity(stated, known);
  out.fault = differenceOf(stated, known.proof);
  if (out.fault.empty()) out.fault = outOfRange(known.proof);
  if (out.fault.empty()) out.proof = known.proof;
  return out;
}

}  // namespace innermap
