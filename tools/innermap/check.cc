// `innermap check`: what is wrong with a mesh, and what it means for a map.
#include "innermap/mesh/check.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "commands.h"
#include "correspondence.h"
#include "innermap/core/memory.h"
#include "innermap/mesh/mesh_file.h"
#include "innermap/surface/correspond.h"
#include "inputs.h"
#include "map_report.h"
#include "report/page/contents.h"
#include "report/report_figures.h"

namespace innermap::tool {
namespace {

using Json = nlohmann::ordered_json;

struct CheckOptions {
  std::string mesh;
  bool json = false;
  CheckSettings check;
  std::string outer;
  LayOutSettings layOut;
};

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
Json vector(const Vec3& v) { return {number(v.x), number(v.y), number(v.z)}; }

template <class List, class Entry>
Json array(const List& list, const Entry& entry) {
  Json out = Json::array();
  for (const auto& item : list) out.push_back(entry(item));
  return out;
}

Json crossingJson(const Crossing& c) {
  return {{"triangles", {c.first, c.second}}, {"place", vector(c.place)}};
}

Json loopJson(const BoundaryLoop& loop) {
  return {{"edges", loop.vertices.size()},
          {"length", number(loop.length)},
          {"first_vertex", loop.vertices.empty() ? -1 : loop.vertices.front()}};
}

Json findingJson(const Finding& f) {
  return {{"name", f.name}, {"count", f.count}, {"what", f.what}, {"meaning", f.meaning}};
}

Json checkJson(const std::string& path, const MeshReport& r, const std::vector<Finding>& found) {
  return {{"path", path},
          {"vertices", r.vertices},
          {"triangles", r.triangles},
          {"polygons", r.polygons},
          {"components", r.components},
          {"closed", r.closed},
          {"outward", r.outward},
          {"genus", r.genus},
          {"area", number(r.area)},
          {"volume", number(r.volume)},
          {"diagonal", number(r.box.diagonal())},
          {"box", {{"lower", vector(r.box.lower)}, {"upper", vector(r.box.upper)}}},
          {"boundary_loops", array(r.boundaryLoops, loopJson)},
          {"non_manifold_edges", r.nonManifoldEdges.size()},
          {"non_manifold_vertices", r.nonManifoldVertices.size()},
          {"duplicate_triangles", r.duplicateTriangles.size()},
          {"opposite_triangles", r.oppositeTriangles.size()},
          {"degenerate_triangles", r.degenerateTriangles.size()},
          {"inconsistent_edges", r.inconsistentEdges},
          {"loose_vertices", r.looseVertices.size()},
          {"self_intersections", r.selfIntersections},
          {"crossings", array(r.crossings, crossingJson)},
          {"findings", array(found, findingJson)}};
}

std::string sized(double value) {
  return std::isfinite(value) ? fmt::format("{:.6g}", value) : "too large to compute";
}

std::string checkText(const std::string& path, const MeshReport& r,
                      const std::vector<Finding>& found) {
  const Vec3 size = r.box.extent();
  std::string text = fmt::format(
      "{}\n"
      "  {} vertices, {} triangles{}, {} component{}, {}\n"
      "  box {:.6g} x {:.6g} x {:.6g}, diagonal {:.6g}, from ({:.6g}, {:.6g}, {:.6g})\n"
      "  area {}, volume {}{}\n",
      path, r.vertices, r.triangles,
      r.polygons && r.polygons != r.triangles ? fmt::format(" (from {} polygons)", r.polygons) : "",
      r.components, r.components == 1 ? "" : "s",
      r.closed ? fmt::format("closed, genus {}", r.genus) : "open", size.x, size.y, size.z,
      r.box.diagonal(), r.box.lower.x, r.box.lower.y, r.box.lower.z, sized(r.area), sized(r.volume),
      r.closed ? "" : " (holes capped)");
  if (found.empty()) return text + "no findings: ready for a map\n";
  text += fmt::format("{} finding{}:\n", found.size(), found.size() == 1 ? "" : "s");
  for (const Finding& f : found) text += fmt::format("- {}\n    {}\n", f.what, f.meaning);
  for (const Crossing& c : r.crossings)
    text += fmt::format("    triangles {} and {} cross near ({:.6g}, {:.6g}, {:.6g})\n", c.first,
                        c.second, c.place.x, c.place.y, c.place.z);
  if (r.selfIntersections > r.crossings.size())
    text += fmt::format("    and {} more (--listed)\n", r.selfIntersections - r.crossings.size());
  return text;
}

void fillReport(const Mesh& mesh, const MeshReport& r, const std::vector<Finding>& found,
                Report& report) {
  ReportMesh source = reportOf(mesh, r.volume);
  source.boundaryLoops = static_cast<int>(r.boundaryLoops.size());
  source.genus = r.genus;
  report.add("source", figures(source));
  for (const Finding& f : found) report.add("findings", findingFigures(f.name, f.count));
}

// What stands for the mesh where it is mapped onto a stranger, filled or laid out.
void writeOuter(const CheckOptions& options, Mesh mesh, Context& context) {
  ClosedSurfaceSettings closing;
  closing.closeHoles = true;
  const Mesh outer =
      closedSurfaces(takeCleanSurface(std::move(mesh), options.layOut, context), closing).mesh;
  if (context.page()) addMesh(*context.page(), outer);
  context.timed("write", [&] { writeMesh(options.outer, outer); });
}

void run(const CheckOptions& options, Context& context) {
  if (!options.outer.empty()) context.output(options.outer);
  Mesh mesh = readMeshFile(options.mesh, context);
  const std::uint64_t need = checkMemory(mesh);
  if (context.dryRun() && !options.outer.empty()) cleanSurface(mesh, options.layOut);
  if (!context.begins(
          {"check " + options.mesh + fmt::format(" ({} triangles)", mesh.triangles.size())},
          {"checking " + options.mesh, need, "raise {max_memory} or simplify the mesh"}))
    return;
  const MeshReport report = context.timed("check", [&] { return checkMesh(mesh, options.check); });
  const std::vector<Finding> found = findings(report);
  fillReport(mesh, report, found, context.report());
  context.print(options.json ? checkJson(options.mesh, report, found)
                                       .dump(2, ' ', false, Json::error_handler_t::replace) +
                                   "\n"
                             : checkText(options.mesh, report, found));
  if (!options.outer.empty()) writeOuter(options, std::move(mesh), context);
}

}  // namespace

Command makeCheckCommand() {
  auto o = std::make_shared<CheckOptions>();
  Command c("check", "Say what is wrong with a mesh and what each finding means for a map");
  c.description(
      "Counts components, holes, non-manifold edges and vertices, duplicate, opposite and "
      "degenerate triangles, inconsistent orientation, loose vertices and self-intersections. "
      "Findings are no failure: the exit code is 0.");
  c.positional("MESH", &o->mesh, "mesh file: .obj, .ply, .off or .stl");
  c.flag("--json", &o->json, "print machine-readable findings on stdout");
  c.option("--listed", "N", &o->check.listed,
           "list the places of at most this many self-intersections; the total counts all")
      .range(0, 1e6);
  c.option("--outer", "FILE", &o->outer,
           "also write the closed surface that other commands use in place of MESH: its outer "
           "surface if it runs through itself, else MESH; .ply or .obj")
      .writes({".ply", ".obj"});
  c.settings(describe(o->layOut));
  c.example("innermap check horse.obj");
  c.example("innermap check posed.obj --outer outer.ply --html");
  c.example("innermap check horse.obj --json > findings.json");
  return c.running(o, run);
}

}  // namespace innermap::tool
