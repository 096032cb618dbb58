// `innermap harmonic`: a harmonic field from what is known on a solid's surface.
#include <fmt/format.h>

#include "commands.h"
#include "harmonic_options.h"
#include "innermap/io/geometry_file.h"
#include "jobs/harmonic_job.h"
#include "lists.h"

namespace innermap::tool {
namespace {

struct FieldOptions {
  HarmonicOptions harmonic;
  std::string fix, flux, properties, table, channels;
  bool colours = false;
};

// "endo=0:1,epi=1:0"
std::vector<std::pair<std::string, std::vector<double>>> parseGroups(const std::string& option,
                                                                     const std::string& text) {
  std::vector<std::pair<std::string, std::vector<double>>> out;
  for (const std::string& part : commaList(text)) {
    const std::size_t equals = part.rfind('=');
    if (equals == std::string::npos || equals == 0)
      throw UsageError(option + ": '" + part + "' is not GROUP=VALUE");
    std::string values = part.substr(equals + 1);
    const auto count = static_cast<std::size_t>(std::count(values.begin(), values.end(), ':')) + 1;
    std::replace(values.begin(), values.end(), ':', ',');
    out.emplace_back(part.substr(0, equals), parseNumbers(option, values, count, "GROUP=VALUE"));
  }
  return out;
}

// "endo=0:1,epi=1:0" as groups and their rows of numbers.
struct GroupNumbers {
  std::vector<SurfaceGroup> groups;
  Matrix numbers;
};

class Conditions {
 public:
  Conditions(const FieldOptions& options, const Mesh& mesh) : options_(options), mesh_(mesh) {}

  NamedConditions make() {
    const int ways = !options_.fix.empty() + !options_.properties.empty() +
                     !options_.table.empty() + options_.colours;
    if (ways != 1)
      throw UsageError("give values by one of --fix, --property, --table and --vertex-colours");
    if (!options_.fix.empty())
      fixGroups();
    else
      readVertices();
    if (!options_.flux.empty()) readFluxes();
    nameChannels();
    return std::move(out_);
  }

 private:
  const std::vector<SurfaceGroup>& groups() {
    if (groups_.empty()) groups_ = readGroups(mesh_.name, mesh_);
    return groups_;
  }

  GroupNumbers numbersOf(const std::string& option, const std::string& text) {
    const auto given = parseGroups(option, text);
    if (given.empty()) throw UsageError(option + ": names no group");
    const std::size_t channels = given.front().second.size();
    GroupNumbers out;
    out.numbers = Matrix(given.size(), channels);
    for (std::size_t g = 0; g < given.size(); ++g) {
      const auto& [name, numbers] = given[g];
      requireChannels(option, name, numbers.size(), channels);
      const SurfaceGroup* group = findGroup(groups(), name);
      if (!group) throw FileError(mesh_.name, noGroup(groups(), name));
      out.groups.push_back(*group);
      for (std::size_t k = 0; k < channels; ++k) out.numbers(g, k) = numbers[k];
    }
    return out;
  }

  void fixGroups() {
    const GroupNumbers given = numbersOf("--fix", options_.fix);
    out_.conditions = valuesOnGroups(mesh_, given.groups, given.numbers);
  }

  // Triangles with a corner whose value is not known are free.
  void readVertices() {
    Matrix values;
    if (options_.colours) {
      if (mesh_.colours.empty()) throw FileError(mesh_.name, "has no vertex colours");
      values = Matrix(mesh_.vertices.size(), 3);
      for (std::size_t v = 0; v < mesh_.colours.size(); ++v)
        for (std::size_t k = 0; k < 3; ++k) values(v, k) = static_cast<double>(mesh_.colours[v][k]);
      out_.names = {"red", "green", "blue"};
    } else if (!options_.table.empty()) {
      VertexTable table = readVertexTable(options_.table, mesh_);
      values = std::move(table.values);
      out_.names = std::move(table.names);
    } else {
      out_.names = commaList(options_.properties);
      values = readVertexProperties(mesh_.name, out_.names, mesh_);
    }
    out_.conditions = valuesAtVertices(mesh_, std::move(values));
  }

  void readFluxes() {
    const GroupNumbers given = numbersOf("--flux", options_.flux);
    requireChannels("--flux", given.groups.front().name, given.numbers.columns(),
                    out_.conditions.values.columns());
    setFluxes(mesh_, given.groups, given.numbers, out_.conditions);
  }

  static void requireChannels(const std::string& option, const std::string& group,
                              std::size_t given, std::size_t wanted) {
    if (given != wanted)
      throw UsageError(fmt::format("{}: group '{}' has {} values, others have {}", option, group,
                                   given, wanted));
  }

  void nameChannels() {
    const std::size_t channels = out_.conditions.values.columns();
    if (!options_.channels.empty()) out_.names = commaList(options_.channels);
    if (out_.names.empty()) out_.names = channelNames(channels);
    if (out_.names.size() != channels)
      throw UsageError(
          fmt::format("--channels: {} names for {} channels", out_.names.size(), channels));
  }

  const FieldOptions& options_;
  const Mesh& mesh_;
  NamedConditions out_;
  std::vector<SurfaceGroup> groups_;
};

}  // namespace

Command makeHarmonicCommand() {
  auto o = std::make_shared<FieldOptions>();
  Command c("harmonic",
            "Compute a harmonic field inside a solid from values and fluxes on its surface");
  c.description(
      "Needs no tetrahedra. Give values for groups of an OBJ (--fix) or for vertices. With groups, "
      "nothing flows through the rest of the surface. With vertices, nothing flows through a "
      "triangle if one of its vertices has no value. For each channel, harmonic writes values, "
      "gradients, their directions and their lengths, with the surface and its fog. The "
      "certificate says how far the field may be off.");
  addHarmonicOptions(c, o->harmonic, "value,gradient,direction,magnitude");
  c.option("--fix", "LIST", &o->fix,
           "values on groups, objects or materials of an OBJ: GROUP=VALUE,...; for several "
           "channels GROUP=VALUE:VALUE,...");
  c.option("--property", "LIST", &o->properties,
           "take these properties of a PLY's vertices as channels");
  c.option("--table", "FILE", &o->table,
           "take the columns of a text file as channels: lines VERTEX,VALUE,..., vertices counted "
           "from 0; the first line may name them")
      .reads();
  c.flag("--vertex-colours", &o->colours, "take the colours of the mesh's vertices as channels");
  c.option("--flux", "LIST", &o->flux,
           "derivatives along the outward normal on groups, GROUP=VALUE,..., in values' units per "
           "world unit, in place of 0 or of a value");
  c.option("--channels", "LIST", &o->channels, "names of the channels' grids")
      .defaults("`value`, those of the table or the properties");
  c.example("innermap harmonic heart.obj -o depth.vdb --fix endo=0,epi=1");
  c.example("innermap harmonic part.ply -o heat.vdb --property temperature --field heat.ply");
  c.run([o](Context& context) {
    runHarmonic(
        o->harmonic, [&](const Mesh& mesh) { return Conditions(*o, mesh).make(); }, context);
  });
  return c;
}

}  // namespace innermap::tool
