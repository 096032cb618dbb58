#include "io/geometry/detail/ply_geometry.h"

#include <cmath>
#include <optional>

#include "innermap/core/error.h"
#include "innermap/core/run.h"

namespace innermap {

bool PlyGeometry::findThree(const PlyElement& element,
                            const std::vector<std::array<std::string, 3>>& names, int direction) {
  for (const auto& three : names) {
    std::array<std::optional<std::size_t>, 3> at;
    for (std::size_t p = 0; p < element.properties.size(); ++p)
      for (std::size_t a = 0; a < 3; ++a)
        if (!element.properties[p].list && element.properties[p].name == three[a] && !at[a])
          at[a] = p;
    if (!at[0] || !at[1] || !at[2]) continue;
    for (int a = 0; a < 3; ++a) {
      const PlyType type = element.properties[*at[static_cast<std::size_t>(a)]].type;
      if (!isFloat(type) && !(direction < 0))
        throw FileError(file_.path, "property '" + three[static_cast<std::size_t>(a)] +
                                        "' holds whole numbers; a direction needs float or double");
      moving_[*at[static_cast<std::size_t>(a)]] = PlyMoving{direction, a};
    }
    return true;
  }
  return false;
}

void PlyGeometry::findSplats(const PlyElement& element) {
  splats_ = PlySplats(file_.path, element);
  geometry.splats.degree = splats_.degree();
  if (splats_.degree() < 0) return;
  geometry.splittable = false;
  for (std::size_t p = 0; p < splats_.parts().size(); ++p)
    if (const int part = splats_.parts()[p]; part != PlySplats::kNone)
      moving_[p] = PlyMoving{PlyMoving::kSplat, part};
}

void PlyGeometry::findMoving(const PlyElement& element, const ReadGeometrySettings& settings) {
  moving_.assign(element.properties.size(), std::nullopt);
  if (!findThree(element, {{"x", "y", "z"}}, -1))
    throw FileError(file_.path, "its vertices have no x, y and z");
  for (const PlyProperty& p : element.properties)
    if ((p.name == "x" || p.name == "y" || p.name == "z") && !isFloat(p.type))
      throw FileError(file_.path,
                      "places are whole numbers; write them as float or double to carry them");
  const auto add = [&](const std::string& name, DirectionKind kind, bool must) {
    const auto next = static_cast<int>(geometry.directions.size());
    std::vector<std::array<std::string, 3>> names;
    if (name == "n") names.push_back({"nx", "ny", "nz"});
    for (const char* between : {"_", ".", ""})
      names.push_back({name + between + "x", name + between + "y", name + between + "z"});
    if (findThree(element, names, next))
      geometry.directions.push_back({name, kind, {}, {}});
    else if (must)
      throw FileError(file_.path, fmt::format("has no vector {0}: its vertices have no properties "
                                              "{1}_x, {1}_y and {1}_z",
                                              inQuotes(name), name));
  };
  add("n", DirectionKind::normal, false);
  for (const std::string& name : settings.normals)
    if (name != "n") add(name, DirectionKind::normal, true);
  for (const std::string& name : settings.vectors) add(name, DirectionKind::vector, true);
  findSplats(element);
}

void PlyGeometry::read(const ReadGeometrySettings& settings) {
  PlyBody body(file_, header_);
  bool vertices = false;
  for (const PlyElement& element : header_.elements) {
    const std::uint64_t rows = body.rows(element);
    const PlyRole role = plyRole(element);
    if (role == PlyRole::vertices) {
      if (vertices) throw FileError(file_.path, "has two elements of vertices; keep one");
      vertices = true;
      vertices_ = &element;
      vertexBody_ = body.position();
      findMoving(element, settings);
      readVertices(body, element);
      continue;
    }
    if (role == PlyRole::strips && rows > 0) geometry.splittable = false;
    PlyFaces faces(element);
    for (std::uint64_t row = 0; row < rows; ++row) {
      if (row % 65536 == 0)
        reportProgress("reading", static_cast<double>(body.position()) /
                                      static_cast<double>(file_.bytes.size()));
      if (role == PlyRole::other) {
        body.skipRow(element);
        continue;
      }
      faces.read(body);
      addElement(role, faces);
    }
  }
  if (!vertices) throw FileError(file_.path, "has no vertices");
  const auto count = static_cast<int>(geometry.points.size());
  for (const Corner& corner : geometry.elements.corners)
    if (corner.point >= count)
      throw FileError(file_.path, fmt::format("a face uses vertex {}, the file has {} (counted "
                                              "from 0)",
                                              corner.point, count));
  geometry.ownPoints = geometry.points.size();
  geometry.textures = textures_.size() / 2;
}

void PlyGeometry::readVertices(PlyBody& body, const PlyElement& element) {
  requireCountable(file_.path, element.count);
  geometry.points.reserve(element.count);
  for (Directions& directions : geometry.directions) {
    directions.values.reserve(element.count);
    directions.points.reserve(element.count);
  }
  std::vector<Vec3> values(1 + geometry.directions.size());
  Splat splat;
  for (std::uint64_t row = 0; row < element.count; ++row) {
    if (row % 65536 == 0)
      reportProgress("reading", static_cast<double>(body.position()) /
                                    static_cast<double>(file_.bytes.size()));
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      const std::optional<PlyMoving>& moving = moving_[p];
      if (!moving) {
        body.skip(property);
        continue;
      }
      const double value = body.nextValue(property.type);
      if (moving->direction == PlyMoving::kSplat) {
        PlySplats::valueOf(splat, moving->axis) = value;
        continue;
      }
      if (!std::isfinite(value) && moving->direction < 0)
        body.fail(fmt::format("vertex {} is not finite; export the file again", row));
      values[static_cast<std::size_t>(1 + moving->direction)][moving->axis] = value;
    }
    if (splats_.degree() >= 0) PlySplats::check(body, row, splat, splats_.degree());
    geometry.points.push_back(values[0]);
    for (std::size_t d = 0; d < geometry.directions.size(); ++d) {
      geometry.directions[d].values.push_back(values[d + 1]);
      geometry.directions[d].points.push_back(static_cast<int>(row));
    }
  }
}

void PlyGeometry::addElement(PlyRole role, const PlyFaces& face) {
  std::vector<Corner> corners(face.corners.size());
  const std::size_t firstTexture = textures_.size() / 2;
  const bool textured = !face.uvs.empty() && face.uvs.size() == 2 * corners.size();
  if (textured) textures_.insert(textures_.end(), face.uvs.begin(), face.uvs.end());
  for (std::size_t k = 0; k < corners.size(); ++k) {
    corners[k].point = face.corners[k];
    if (textured) corners[k].texture = static_cast<int>(firstTexture + k);
  }
  requireCountable(file_.path, geometry.elements.corners.size() + corners.size());
  Elements::Kind kind = role == PlyRole::edges    ? Elements::Kind::line
                        : role == PlyRole::strips ? Elements::Kind::cell
                                                  : Elements::Kind::face;
  if (kind == Elements::Kind::face && corners.size() < 3) kind = Elements::Kind::cell;
  geometry.elements.add(kind, static_cast<std::uint32_t>(roles_.size()), corners.data(),
                        corners.size());
  roles_.push_back(role);
}

std::unique_ptr<GeometryFile> readPlyGeometry(FileBytes file,
                                              const ReadGeometrySettings& settings) {
  return std::make_unique<PlyGeometry>(std::move(file), settings);
}

}  // namespace innermap
