// `innermap verify`: what a map's file claims to be proven, proven again.
#include <fmt/format.h>

#include "commands.h"
#include "innermap/fit/mapped_solid.h"
#include "inputs.h"
#include "report/figures.h"

namespace innermap::tool {
namespace {

enum class Required { nothing, proof, whole };

struct VerifyOptions {
  std::string map;
  VerifySettings settings;
  Required required = Required::nothing;
};

std::string textOf(const Claim& claim) {
  std::string text = fmt::format("  {:<15} {}: {}; found: {}", wordOf(claim.result), claim.name,
                                 claim.claimed, claim.found);
  if (claim.result != ClaimResult::holds && !claim.places.empty()) {
    const Vec3& p = claim.places.front();
    text += fmt::format(", near ({:.8g}, {:.8g}, {:.8g})", p.x, p.y, p.z);
  }
  return text + "\n";
}

std::string textOf(const VerifyOptions& options, const Verification& made) {
  if (made.claims.empty())
    return options.map +
           ": claims no proof, so there is nothing to check (innermap fit and map prove, unless "
           "you give --prove off)\n";
  std::string text = fmt::format("{}: {}\n", options.map,
                                 made.holds() ? "all claims hold" : "some claims do not hold");
  for (const Claim& claim : made.claims) text += textOf(claim);
  return text;
}

// Why the run fails; empty if it does not.
std::string failureOf(const VerifyOptions& options, const Verification& made) {
  std::string names;
  for (const Claim& claim : made.claims)
    if (claim.result != ClaimResult::holds)
      names +=
          fmt::format("{}{} ({})", names.empty() ? "" : ", ", claim.name, wordOf(claim.result));
  if (!names.empty()) return fmt::format("{}: some claims do not hold: {}", options.map, names);
  if (options.required != Required::nothing && made.claims.empty())
    return fmt::format("{}: claims no proof, but --require asks for one", options.map);
  const bool whole = made.claimed.whole() && made.claimed.boundaryError > 0;
  if (options.required == Required::whole && !whole)
    return fmt::format(
        "{}: --require whole asks for two claims: that det J has one sign everywhere, and a bound "
        "of the boundary's error; the file does not make both",
        options.map);
  return "";
}

void run(const VerifyOptions& options, Context& context) {
  const MappedSolid mapped = readMapFile(options.map, context);
  if (!context.begins({"verify " + options.map},
                      {"verifying " + options.map, verifyMemory(mapped, options.settings),
                       "raise {max_memory} or lower {proof_cells}"}))
    return;
  const Verification made =
      context.timed("verify", [&] { return verifyMap(mapped, options.settings); });
  context.report().add("verification", figures(made));
  context.print(textOf(options, made));
  if (const std::string failure = failureOf(options, made); !failure.empty())
    context.failAfterwards(failure);
}

}  // namespace

Command makeVerifyCommand() {
  auto o = std::make_shared<VerifyOptions>();
  Command c("verify", "Check the proofs that a map's file claims");
  c.description(
      "Proves each claim again from the map's file alone: its charges, its mesh and its target. "
      "For each claim it prints the claim, the finding, and the answer: holds, fails, or cannot be "
      "shown. A claim holds if verify proves as much or more. verify also checks a random sample "
      "of cells and triangles in another way, with intervals and plain sums. The exit code is 1 "
      "unless all claims hold. The file's figures for sampled points (99% of the boundary, points "
      "inside) are no proofs, so verify does not check them. A file that claims nothing does not "
      "fail, unless --require asks for a claim.");
  c.positional("MAP", &o->map, "a map.ply written by fit or map");
  c.choice("--require", "WHAT", &o->required,
           {{"nothing", Required::nothing}, {"proof", Required::proof}, {"whole", Required::whole}},
           "end with exit code 1 unless the file claims this. proof: anything; whole: that det J "
           "has one sign everywhere, and a bound of the boundary's error");
  c.settings(describe(o->settings));
  c.example("innermap verify map.ply");
  c.example("innermap verify map.ply --require whole --json | jq .verification");
  return c.running(o, run);
}

}  // namespace innermap::tool
