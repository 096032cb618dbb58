#include "fit/detail/proof_words.h"

#include <fmt/format.h>

#include <cmath>

namespace innermap {
namespace {

// 100, not 1e+02.
std::string written(double value, int digits) {
  const std::string out = fmt::format("{:.{}g}", value, digits);
  return std::abs(value) < 1e6 && out.find("e+") != out.npos ? fmt::format("{:.0f}", std::stod(out))
                                                             : out;
}

std::string rounded(double bound, int digits, bool up) {
  const std::string near = written(bound, digits);
  if (!(bound > 0) || !std::isfinite(bound)) return near;
  const double shown = std::stod(near);
  if (up ? shown >= bound : shown <= bound) return near;
  const double unit = std::pow(10, std::floor(std::log10(bound)) - digits + 1);
  return written(shown + (up ? unit : -unit), digits);
}

// The target's surface winds about its inside once, and about nothing else: one closed surface that
// does not cross itself. What caps do is not looked at.
bool windsOnce(const Injectivity& known) {
  return known.solid.surfaces == 1 && known.solid.caps == 0 && known.target.pairs == 0;
}

}  // namespace

std::string atMost(double bound, int digits) { return rounded(bound, digits, true); }
std::string atLeast(double bound, int digits) { return rounded(bound, digits, false); }

bool countsPreimages(const Injectivity& known) {
  return known.proof.cells > 0 && known.proof.boundaryError > 0 && known.source.pairs == 0 &&
         !known.solid.overlaps;
}

bool countsPointsOnce(const Injectivity& known) {
  return known.proof.whole() && countsPreimages(known) && windsOnce(known);
}

std::string preimages(const Injectivity& known) {
  const ProofFigures& p = known.proof;
  return fmt::format(
      "each point farther than {} of the target's diagonal from the target's surface{} has as many "
      "preimages as that surface winds about it{}{}",
      atMost(p.boundaryError),
      p.whole() ? "" : ", and outside the images of undecided and turned-over cells,",
      p.mirrored ? ", the other way round" : "",
      windsOnce(known) ? ": one inside, none outside" : "");
}

}  // namespace innermap
