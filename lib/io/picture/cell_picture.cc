#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "core/require_number.h"
#include "innermap/core/error.h"
#include "innermap/io/solid_pictures.h"
#include "io/picture/detail/picture.h"

namespace innermap {
namespace {

constexpr double kLine = 0.05;              // of a face's height: how wide its edges are drawn
constexpr std::size_t kMostLined = 150000;  // faces; edges of more would only be grey

struct Face {
  std::array<int, 4> key;      // sorted; the first is -1 for a triangle
  std::array<int, 4> corners;  // the last is -1 for a triangle
  int cell;
};

class CutMesh {
 public:
  CutMesh(const CellMesh& mesh, const CellPictureSettings& settings) : mesh_(mesh) {
    const Vec3 direction = settings.direction / norm(settings.direction);
    double low = 1e300, high = -1e300;
    for (const Tetrahedron& c : mesh.tetrahedra) range(c, direction, low, high);
    for (const Hexahedron& c : mesh.hexahedra) range(c, direction, low, high);
    const double cut = low + settings.at * (high - low);
    static constexpr int kTet[4][4] = {{1, 2, 3, -1}, {0, 3, 2, -1}, {0, 1, 3, -1}, {0, 2, 1, -1}};
    static constexpr int kHex[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                       {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
    int cell = 0;
    for (const Tetrahedron& c : mesh.tetrahedra) add(c, kTet, cell++, direction, cut);
    for (const Hexahedron& c : mesh.hexahedra) add(c, kHex, cell++, direction, cut);
    expose();
  }

  PictureSurface surface;
  std::vector<int> cellOf;     // of each triangle
  std::vector<bool> diagonal;  // the side after its third corner is a quadrilateral's diagonal

 private:
  template <std::size_t N>
  void range(const std::array<int, N>& cell, const Vec3& direction, double& low,
             double& high) const {
    for (const int v : cell) {
      const double x = dot(mesh_.vertices[v], direction);
      low = std::min(low, x);
      high = std::max(high, x);
    }
  }

  template <std::size_t N, std::size_t F>
  void add(const std::array<int, N>& cell, const int (&faces)[F][4], int number,
           const Vec3& direction, double cut) {
    Vec3 sum;
    for (const int v : cell) sum += mesh_.vertices[v];
    if (dot(sum, direction) > cut * static_cast<double>(N)) return;
    for (const auto& f : faces) {
      Face face{};
      for (int k = 0; k < 4; ++k) face.corners[k] = f[k] < 0 ? -1 : cell[f[k]];
      face.key = face.corners;
      std::sort(face.key.begin(), face.key.end());
      face.cell = number;
      faces_.push_back(face);
    }
  }

  // Faces of one cell alone are seen; each triangle has corners of its own, so that it is flat.
  void expose() {
    tbb::parallel_sort(faces_.begin(), faces_.end(), [](const Face& a, const Face& b) {
      return std::tie(a.key, a.cell) < std::tie(b.key, b.cell);
    });
    for (std::size_t i = 0, end = 0; i < faces_.size(); i = end) {
      for (end = i + 1; end < faces_.size() && faces_[end].key == faces_[i].key; ++end) {
      }
      if (end > i + 1) continue;
      const auto& c = faces_[i].corners;
      addTriangle(c[0], c[1], c[2], faces_[i].cell, c[3] >= 0);
      if (c[3] >= 0) addTriangle(c[2], c[3], c[0], faces_[i].cell, true);
    }
    faces_.clear();
  }

  void addTriangle(int a, int b, int c, int cell, bool half) {
    const int first = static_cast<int>(surface.vertices.size());
    for (const int v : {a, b, c}) surface.vertices.push_back(mesh_.vertices[v]);
    surface.triangles.push_back({first, first + 1, first + 2});
    cellOf.push_back(cell);
    diagonal.push_back(half);
  }

  const CellMesh& mesh_;
  std::vector<Face> faces_;
};

void checkSettings(const CellMesh& mesh, const std::vector<double>& values,
                   const CellPictureSettings& settings) {
  if (values.size() != mesh.tetrahedra.size() + mesh.hexahedra.size())
    throw DataError("picture of " + mesh.name + ": not as many values as cells");
  requireNumber("at", settings.at, {0, 1});
  if (!(norm(settings.direction) > 0))
    throw SettingError("direction", "must have a length above 0");
  if (!(std::abs(settings.red - settings.blue) > 0))
    throw SettingError("red", "must differ from blue");
}

}  // namespace

void writeCellPicture(const std::string& path, const CellMesh& mesh,
                      const std::vector<double>& values, const CellPictureSettings& settings) {
  checkSettings(mesh, values, settings);
  CutMesh cut(mesh, settings);
  if (cut.surface.triangles.empty())
    throw DataError("picture of " + mesh.name + ": no cell is left behind the cut");
  cut.surface.label = settings.label;
  const bool lined = cut.surface.triangles.size() <= kMostLined;
  cut.surface.colours = [&](const std::vector<VisiblePoint>& points) {
    std::vector<Vec3> colours;
    colours.reserve(points.size());
    for (const VisiblePoint& p : points) {
      const double value = values[cut.cellOf[p.triangle]];
      const double share = (value - settings.blue) / (settings.red - settings.blue);
      Vec3 colour = linear(rampColour(share, settings.colormap));
      const auto& b = p.barycentric;
      // The side opposite to corner 1 joins corners 2 and 0: a quadrilateral's diagonal.
      const double edge = std::min({b[0], b[2], cut.diagonal[p.triangle] ? 1.0 : b[1]});
      if (lined && edge < kLine) colour = 0.35 * colour;
      colours.push_back(colour);
    }
    return colours;
  };
  MeshPictureSettings picture;
  picture.pixels = settings.pixels;
  const Vec3 d = settings.direction / norm(settings.direction);
  const Vec3 aside = std::abs(d.y) > 0.9 ? Vec3{0.3, 0, 0.25} : cross(Vec3{0, 1, 0}, d) * 0.35;
  picture.from = {d + aside + Vec3{0, std::abs(d.y) > 0.9 ? 0 : 0.2, 0}};
  picture.caption = settings.caption;
  writeMeshPicture(path, {cut.surface}, picture);
}

}  // namespace innermap
