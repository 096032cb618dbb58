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
           ": claims nothing to be proven, so nothing was looked at (innermap fit and map prove, "
           "unless with --prove off)\n";
  std::string text = fmt::format("{}: {}\n", options.map,
                                 made.holds() ? "each claim holds" : "not each claim holds");
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
  if (!names.empty()) return fmt::format("{}: not each claim holds: {}", options.map, names);
  if (options.required != Required::nothing && made.claims.empty())
    return fmt::format("{}: claims nothing to be proven, as --require asks for", options.map);
  const bool whole = made.claimed.whole() && made.claimed.boundaryError > 0;
  if (options.required == Required::whole && !whole)
    return fmt::format(
        "{}: does not claim that det J has one sign everywhere and that its boundary's error is "
        "bounded, as --require whole asks for",
        options.map);
  return "";
}

void run(const VerifyOptions& options, Context& context) {
  const MappedSolid mapped = readMapFile(options.map, context);
  const std::uint64_t need = verifyMemory(mapped, options.settings);
  if (context.dryRun()) return context.plan({"verify " + options.map}, need);
  context.requireMemory("verifying " + options.map, need,
                        "raise --max-memory or lower --proof-cells");
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
  Command c("verify", "Prove again what a map's file claims to be proven of it");
  c.description(
      "Reads the map's file alone: its charges, its mesh and where that goes. Says of each claim "
      "what is claimed, what was found, and whether it holds, fails or cannot be shown; a claim "
      "that is weaker than what is shown holds. A random sample of cells and triangles is checked "
      "in another way too, with intervals and plain sums. Exit code 1 unless each claim holds. "
      "What the file says of points that were looked at (99% of the boundary, points inside) is "
      "no proof and is not checked. A file that claims nothing does not fail, unless --require "
      "asks for a claim.");
  c.positional("MAP", &o->map, "a map.ply written by fit or map");
  c.choice("--require", "WHAT", &o->required,
           {{"nothing", Required::nothing}, {"proof", Required::proof}, {"whole", Required::whole}},
           "what has to be claimed, else the exit code is 1: anything (proof), or that det J has "
           "one sign everywhere and how large the boundary's error is at most (whole)");
  c.settings(describe(o->settings));
  c.example("innermap verify map.ply");
  c.example("innermap verify map.ply --require whole --json | jq .verification");
  c.run([o](Context& context) { run(*o, context); });
  return c;
}

}  // namespace innermap::tool
