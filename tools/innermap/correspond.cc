// `innermap correspond`: where each point of one closed surface lies on another.
#include <fmt/format.h>

#include "commands.h"
#include "correspondence.h"
#include "innermap/io/solid_pictures.h"
#include "innermap/mesh/mesh_file.h"
#include "inputs.h"
#include "job_cost.h"
#include "report/page/contents.h"

namespace innermap::tool {
namespace {

struct CorrespondCommand {
  std::string a, b, output, sourceOutput, picture;
  CorrespondOptions correspond;
};

// The file of A with the triangles of the output, where those are not A's own.
std::string sourceOutputOf(const CorrespondCommand& options) {
  if (!options.sourceOutput.empty()) return options.sourceOutput;
  return options.output.substr(0, options.output.size() - 4) + ".source.ply";
}

MemoryNeed needOf(const CorrespondCommand& options, std::size_t countA, std::size_t countB) {
  MemoryNeed need = correspondNeed(countA, countB);
  if (!options.picture.empty()) need.bytes = std::max(need.bytes, meshPictureMemory());
  return need;
}

void run(const CorrespondCommand& options, Context& context) {
  context.output(options.output);
  context.output(sourceOutputOf(options), false);
  if (!options.picture.empty()) {
    context.output(options.picture);
    context.output(otherPicture(options.picture), false);
  }
  Mesh a = readMeshFile(options.a, context), b = readMeshFile(options.b, context);
  const std::size_t countA = a.vertices.size(), countB = b.vertices.size();
  context.expect(correspondPhases(countA + countB));
  if (context.dryRun())
    context.timed("check", [&] { requireLayable(a, b, options.correspond.map.layOut); });
  if (!context.begins({fmt::format("map the {} vertices of {} onto {} ({} vertices)", countA,
                                   options.a, options.b, countB),
                       "write them to " + options.output},
                      needOf(options, countA, countB)))
    return;
  context.spend(Context::kMostOfTime);
  const MeshCorrespondence moved =
      correspondMeshes(std::move(a), std::move(b), options.correspond, context);
  if (context.page()) showPair(*context.page(), moved.source, moved.positions);
  context.timed("write", [&] {
    if (moved.changed) {
      Mesh source = moved.source;
      source.colours.clear();
      writeMesh(sourceOutputOf(options), source);
    }
    writeCorrespondence(options.output, moved);
  });
  if (!options.picture.empty())
    context.timed("picture", [&] {
      writeCorrespondencePictures(options.picture, moved,
                                  [](const std::string& path, const auto& write) { write(path); });
    });
  if (moved.changed)
    context.note(fmt::format("{} has SOURCE with the same {} vertices: give both to innermap map",
                             sourceOutputOf(options), moved.source.vertices.size()));
}

}  // namespace

Command makeCorrespondCommand() {
  auto o = std::make_shared<CorrespondCommand>();
  Command c("correspond", "Lay the surface of one solid onto that of another, of any connectivity");
  c.description(
      std::string(
          "Writes SOURCE with its vertices moved onto TARGET's surface, as a target for map, fit "
          "and other commands. Each vertex also gets its `triangle` of TARGET (counted from 0) and "
          "barycentric coordinates `b0 b1 b2`. The map between the two surfaces is one-to-one and "
          "reaches each point of TARGET. Triangles between the moved vertices cut corners where "
          "TARGET is finer than SOURCE (see --subdivide). Both solids need the same number of "
          "handles and of shells (cavities). ") +
      kLandmarkFormat);
  c.positional("SOURCE", &o->a, "mesh of the first solid: .obj, .ply, .off or .stl");
  c.positional("TARGET", &o->b, "mesh of the second solid");
  c.outputFile(&o->output, {".ply"}, "SOURCE on TARGET, a .ply file");
  c.option(
       "--source-out", "FILE", &o->sourceOutput,
       "SOURCE with the same vertices as the output, written when its triangles were split or its "
       "touching parts cut apart")
      .defaults("the output's name with .source.ply")
      .writes({".ply"})
      .advanced();
  c.limitTime("stop trying and refining after this time");
  addCorrespondOptions(c, o->correspond);
  c.setting(seedSetting(&o->correspond.map.seed));
  c.option("--picture", "FILE", &o->picture,
           "also write a .png with SOURCE's coordinates as colours on both; if another way is "
           "about as good, it goes to the same name with .other.png")
      .writes({".png"});
  c.example("innermap correspond cow.obj man.obj -o cow_on_man.ply --picture cow_on_man.png");
  c.example(
      "innermap correspond cow.obj man.obj -o out.ply --landmarks pairs.txt --subdivide 0.005");
  c.example("innermap correspond scan.ply ball.obj -o out.ply --surface-resolution 96");
  return c.running(o, run);
}

}  // namespace innermap::tool
