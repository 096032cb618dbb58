#include <cmath>

#include "core/require_number.h"
#include "innermap/core/error.h"
#include "innermap/io/solid_pictures.h"
#include "io/picture/detail/picture.h"

namespace innermap {
namespace {

// The plane as one square of two triangles.
PictureSurface planeSurface(const Box3& box, const PlaneFunction& function,
                            const PlanePictureSettings& settings) {
  PictureSurface surface;
  surface.label = function.label;
  const int u = (settings.axis + 1) % 3, v = (settings.axis + 2) % 3;
  for (int corner = 0; corner < 4; ++corner) {
    Vec3 p;
    p[settings.axis] = box.lower[settings.axis] + settings.at * box.extent()[settings.axis];
    p[u] = corner == 1 || corner == 2 ? box.upper[u] : box.lower[u];
    p[v] = corner >= 2 ? box.upper[v] : box.lower[v];
    surface.vertices.push_back(p);
  }
  surface.triangles = {{0, 1, 2}, {0, 2, 3}};
  surface.colours = [corners = surface.vertices, triangles = surface.triangles, function,
                     settings](const std::vector<VisiblePoint>& seen) {
    Points points(seen.size());
    for (std::size_t i = 0; i < seen.size(); ++i)
      for (int k = 0; k < 3; ++k)
        points[i] += seen[i].barycentric[k] * corners[triangles[seen[i].triangle][k]];
    const std::vector<double> values = function.values(points);
    if (values.size() != points.size())
      throw DataError(function.label + ": not as many values as points");
    std::vector<Vec3> colours(points.size(), Vec3{2, 2, 2});  // white whatever the light
    for (std::size_t i = 0; i < values.size(); ++i)
      if (std::isfinite(values[i]))
        colours[i] = linear(rampColour((values[i] - settings.blue) / (settings.red - settings.blue),
                                       settings.colormap));
    return colours;
  };
  return surface;
}

}  // namespace

void writePlanePicture(const std::string& path, const Box3& box,
                       const std::vector<PlaneFunction>& functions,
                       const PlanePictureSettings& settings) {
  requireNumber("axis", settings.axis, {0, 2});
  requireNumber("at", settings.at, {0, 1});
  if (!(std::abs(settings.red - settings.blue) > 0))
    throw SettingError("red", "must differ from blue");
  if (functions.empty() || box.empty()) throw DataError("picture of a plane: nothing to show");
  std::vector<PictureSurface> surfaces;
  for (const PlaneFunction& function : functions)
    surfaces.push_back(planeSurface(box, function, settings));
  MeshPictureSettings picture;
  picture.pixels = settings.pixels;
  Vec3 from{0, 0, 0};
  from[settings.axis] = 1;
  picture.from = {from};
  picture.caption = settings.caption;
  writeMeshPicture(path, surfaces, picture);
}

}  // namespace innermap
