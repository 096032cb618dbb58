#include <fmt/format.h>

#include <set>

#include "innermap/fit/mapped_solid.h"
#include "innermap/io/solid_pictures.h"
#include "io/picture/detail/place_colours.h"

namespace innermap {
namespace {

constexpr double kAccuracy = 1e-5;  // of the source's diagonal; far below a pixel
constexpr std::size_t kShown = 7;   // more are too small to be looked at

std::string labelOf(std::size_t step, std::size_t steps) {
  if (step == 0) return "source";
  return fmt::format("{} of {} step{}", step, steps, steps == 1 ? "" : "s");
}

}  // namespace

void writeStepsPicture(const std::string& path, const MappedSolid& mapped,
                       const MeshPictureSettings& settings) {
  const Mesh& mesh = mapped.solid().repaired().mesh;
  const Box3 box = boundingBox(mesh);
  const std::size_t steps = mapped.map.steps().size();
  std::set<std::size_t> chosen;  // spread evenly, the first and the last among them
  for (std::size_t i = 0; i < kShown; ++i)
    chosen.insert((2 * i * steps + kShown - 1) / (2 * (kShown - 1)));
  EvaluateFieldSettings evaluate;
  evaluate.accuracy = kAccuracy * box.diagonal();
  std::vector<PictureSurface> surfaces;
  Points now = mesh.vertices;
  for (std::size_t step = 0; step <= steps; ++step) {
    if (step > 0)
      now = pointsOf(mapped.map.steps()[step - 1].field().evaluate(now, evaluate).values);
    if (chosen.count(step) == 0) continue;
    PictureSurface surface;
    surface.label = labelOf(step, steps);
    surface.vertices = now;
    surface.triangles = mesh.triangles;
    surface.colours = [&](const std::vector<VisiblePoint>& seen) {
      return placeColours(interpolate(mesh.vertices, mesh.triangles, addresses(seen)), box);
    };
    surfaces.push_back(std::move(surface));
  }
  writeMeshPicture(path, surfaces, settings);
}

}  // namespace innermap
