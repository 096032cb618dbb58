#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <string_view>
#include <type_traits>

#include "innermap/fit/mapped_solid.h"

namespace innermap {
namespace {

constexpr std::size_t kPlaces = 16;
constexpr std::string_view kPrefix = "one_to_one_";

// Calls visit(name, number, whether it is known) for each of them; numbers of `known` may be
// written to where it is not constant.
template <class Figures, class Visit>
void visitDeterminants(const std::string& of, Figures& figures, const Visit& visit) {
  const bool any = figures.checked > 0;
  visit(of + "_checked", figures.checked, any);
  visit(of + "_folded", figures.folded, any);
  visit(of + "_folded_at_overlap", figures.foldedAtOverlap, any);
  visit(of + "_least", figures.least, any);
}

template <class Figures, class Visit>
void visitProof(Figures& proof, const Visit& visit) {
  const bool any = proof.cells > 0;
  visit("proof_cells", proof.cells, any);
  visit("proof_undecided", proof.undecided, any);
  visit("proof_negative", proof.negative, any);
  visit("proof_proven_share", proof.proven, any);
  visit("proof_undecided_share", proof.undecidedShare, any);
  visit("proof_negative_share", proof.negativeShare, any);
  visit("proof_mirrored", proof.mirrored, any);
  visit("proof_least", proof.least, any);
  visit("proof_boundary_error", proof.boundaryError, proof.boundaryError > 0);
  visit("proof_one_to_one", proof.oneToOne, proof.oneToOne >= 0);
}

template <class Known, class Visit>
void visitFigures(Known& known, const Visit& visit) {
  visitDeterminants("inside", known.inside, visit);
  visit("outside", known.outside, known.inside.checked > 0);
  visitDeterminants("boundary", known.boundary, visit);
  visit("boundary_error", known.boundaryError, known.boundaryError > 0);
  const bool degree = known.degree.checked > 0;
  visit("degree_checked", known.degree.checked, degree);
  visit("degree_least", known.degree.least, degree);
  visit("degree_greatest", known.degree.greatest, degree);
  visitDeterminants("voxels", known.voxels, visit);
  visit("repaired", known.repaired, known.voxels.checked > 0);
  const bool cells = known.cells.checked > 0;
  visitDeterminants("cells", known.cells, visit);
  visit("cells_share", known.cells.share, cells);
  visit("cells_overlaps", known.cells.overlaps, known.cells.overlaps >= 0);
  visitProof(known.proof, visit);
}

// Whether a number that a file states is one of that type.
template <class Value>
bool fits(double number) {
  if constexpr (std::is_same_v<Value, double>) return true;
  if constexpr (std::is_same_v<Value, bool>) return number == 0 || number == 1;
  constexpr double kWhole = 9007199254740992;  // 2^53: all whole numbers up to it are doubles
  const auto least = static_cast<double>(std::numeric_limits<Value>::min());
  const auto most = static_cast<double>(std::numeric_limits<Value>::max());
  return number >= std::max(least, -kWhole) && number <= std::min(most, kWhole);
}

}  // namespace

void DeterminantFigures::add(double determinant, bool atOverlap) {
  least = checked == 0 ? determinant : std::min(least, determinant);
  ++checked;
  if (determinant > 0) return;
  ++folded;
  if (atOverlap) ++foldedAtOverlap;
}

void DeterminantFigures::add(const DeterminantFigures& others) {
  if (others.checked == 0) return;
  least = checked == 0 ? others.least : std::min(least, others.least);
  checked += others.checked;
  folded += others.folded;
  foldedAtOverlap += others.foldedAtOverlap;
}

Facts injectivityFacts(const Injectivity& known) {
  Facts out;
  visitFigures(known, [&](const std::string& name, const auto& value, bool is) {
    using Value = std::decay_t<decltype(value)>;
    using Number = std::conditional_t<std::is_same_v<Value, bool>, int, Value>;
    if (is)
      out.emplace_back(std::string(kPrefix) + name, fmt::format("{}", static_cast<Number>(value)));
  });
  return out;
}

void readInjectivity(const Facts& facts, Injectivity& known) {
  visitFigures(known, [&](const std::string& name, auto& value, bool) {
    using Value = std::decay_t<decltype(value)>;
    const auto number = factNumber(facts, std::string(kPrefix) + name);
    if (number && fits<Value>(*number)) value = static_cast<Value>(*number);
  });
}

SelfIntersectionFigures selfIntersectionFigures(const MeshReport& check) {
  SelfIntersectionFigures out;
  out.pairs = check.selfIntersections;
  for (std::size_t i = 0; i < std::min(kPlaces, check.crossings.size()); ++i)
    out.places.push_back(check.crossings[i].place);
  return out;
}

}  // namespace innermap
