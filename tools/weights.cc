// `innermap weights`: harmonic weights of groups of a surface, inside it.
#include <fmt/format.h>

#include <algorithm>

#include "commands.h"
#include "harmonic_options.h"
#include "innermap/io/geometry/surface_data.h"
#include "lists.h"

namespace innermap::tool {
namespace {

struct WeightOptions {
  HarmonicOptions harmonic;
  std::string groups;
};

NamedConditions conditionsOf(const WeightOptions& options, const Mesh& mesh) {
  const std::vector<std::string> wanted = commaList(options.groups);
  NamedConditions out;
  std::vector<SurfaceGroup> groups;
  for (SurfaceGroup& group : readGroups(mesh.name, mesh)) {
    const bool named = std::find(wanted.begin(), wanted.end(), group.name) != wanted.end();
    if ((wanted.empty() && !group.triangles.empty()) || named) groups.push_back(std::move(group));
  }
  for (const std::string& name : wanted)
    if (std::none_of(groups.begin(), groups.end(), [&](const auto& g) { return g.name == name; }))
      throw FileError(mesh.name, fmt::format("has no group '{}'", name));
  if (groups.size() < 2)
    throw FileError(mesh.name, fmt::format("weights need two groups of faces or more, here {}",
                                           groups.size() == 1 ? "is one" : "are none"));
  out.conditions.values = Matrix(3 * mesh.triangles.size(), groups.size());
  out.conditions.free.assign(mesh.triangles.size(), 1);
  for (std::size_t k = 0; k < groups.size(); ++k) {
    out.names.push_back(groups[k].name);
    if (groups[k].triangles.empty())
      throw FileError(mesh.name,
                      fmt::format("group '{}' has no faces; a point or a line inside cannot hold a "
                                  "weight in three dimensions: give it as a small ball or tube, a "
                                  "closed part of the surface",
                                  groups[k].name));
    for (const int triangle : groups[k].triangles) {
      const auto t = static_cast<std::size_t>(triangle);
      if (!out.conditions.free[t])
        throw FileError(mesh.name,
                        fmt::format("a face is in group '{}' and in another; name groups "
                                    "that share none (--groups)",
                                    groups[k].name));
      out.conditions.free[t] = 0;
      for (std::size_t c = 0; c < 3; ++c) out.conditions.values(3 * t + c, k) = 1;
    }
  }
  return out;
}

}  // namespace

Command makeWeightsCommand() {
  auto o = std::make_shared<WeightOptions>();
  Command c("weights", "Harmonic weights of groups of a surface, inside the solid");
  c.description(
      "A channel for each group: 1 on it, 0 on the other groups, nothing flows through the rest of "
      "the surface. All are fitted at once and sum up to 1 everywhere.");
  addHarmonicOptions(c, o->harmonic, "value");
  c.option("--groups", "LIST", &o->groups, "groups, objects or materials of the OBJ, by name")
      .defaults("all that have faces");
  c.example("innermap weights body.obj -o weights.vdb --groups head,arms,legs");
  c.run([o](Context& context) {
    runHarmonic(
        o->harmonic, [&](const Mesh& mesh) { return conditionsOf(*o, mesh); }, true, context);
  });
  return c;
}

}  // namespace innermap::tool
