// `innermap weights`: harmonic weights of groups of a surface, inside it.
#include <algorithm>

#include "commands.h"
#include "harmonic_options.h"
#include "innermap/io/geometry_file.h"
#include "jobs/harmonic_job.h"
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
  const std::vector<SurfaceGroup> known = readGroups(mesh.name, mesh);
  for (const SurfaceGroup& group : known) {
    const bool named = std::find(wanted.begin(), wanted.end(), group.name) != wanted.end();
    if ((wanted.empty() && !group.triangles.empty()) || named) groups.push_back(group);
  }
  for (const std::string& name : wanted)
    if (!findGroup(groups, name)) throw FileError(mesh.name, noGroup(known, name));
  out.conditions = weightConditions(mesh, groups);
  for (const SurfaceGroup& group : groups) out.names.push_back(group.name);
  return out;
}

}  // namespace

Command makeWeightsCommand() {
  auto o = std::make_shared<WeightOptions>();
  o->harmonic.fit.tolerance = kWeightsTolerance;
  Command c("weights", "Compute harmonic weights inside a solid from groups of its surface");
  c.description(
      "Each group gets a channel: 1 on the group, 0 on the other groups, and no flux through the "
      "rest of the surface. Where groups touch, weights blend over the triangles along the border. "
      "One fit makes all channels, and they sum to 1 everywhere.");
  addHarmonicOptions(c, o->harmonic, "value");
  c.option("--groups", "LIST", &o->groups, "groups, objects or materials of the OBJ, by name")
      .defaults("all that have faces");
  c.example("innermap weights body.obj -o weights.vdb --groups head,arms,legs");
  c.run([o](Context& context) {
    runHarmonic(
        o->harmonic, [&](const Mesh& mesh) { return conditionsOf(*o, mesh); }, context);
  });
  return c;
}

}  // namespace innermap::tool
