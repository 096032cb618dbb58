#include <fmt/format.h>

#include <cmath>
#include <string>

#include "innermap/field/field_file.h"

namespace innermap {
namespace {

constexpr const char* kError = "boundary_error_";
constexpr const char* kTolerance = "tolerance";
constexpr const char* kReached = "tolerance_reached";
constexpr const char* kMet = "tolerance_met";
constexpr double kMostSamples = 1e15;

}  // namespace

Facts factsOf(const BoundaryError& e) {
  const std::string key = kError;
  return {{key + "rms", textOfFact(e.rms)},
          {key + "p99", textOfFact(e.p99)},
          {key + "max", textOfFact(e.max)},
          {key + "samples", fmt::format("{}", e.samples)}};
}

Facts factsOfTolerance(double wanted, std::optional<double> reached, bool met) {
  Facts out{{kTolerance, textOfFact(wanted)}};
  if (reached) out.emplace_back(kReached, textOfFact(*reached));
  out.emplace_back(kMet, textOfFact(met));
  return out;
}

FitFacts fitFacts(const Facts& facts) {
  const auto number = [&](const char* key) {
    return factNumber(facts, std::string(kError) + key).value_or(std::nan(""));
  };
  FitFacts out;
  out.error.rms = number("rms");
  out.error.p99 = number("p99");
  out.error.max = number("max");
  out.error.p99Bound = number("p99_bound");
  out.error.bound = number("bound");
  const double samples = number("samples");
  if (samples >= 0 && samples < kMostSamples) out.error.samples = static_cast<std::size_t>(samples);
  out.tolerance = factNumber(facts, kTolerance);
  out.reached = factNumber(facts, kReached);
  out.met = factFlag(facts, kMet);
  return out;
}

}  // namespace innermap
