// PLY: elements and properties in any order and of any type; those of no use here are skipped.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/ply_body.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "mesh/detail/polygon_mesh.h"

namespace innermap {
namespace {

enum Role { kX, kY, kZ, kRed, kGreen, kBlue, kU, kV, kRoles, kNone = kRoles };

Role roleOf(const PlyProperty& property) {
  static const std::vector<std::string> kNames[kRoles] = {{"x"},
                                                          {"y"},
                                                          {"z"},
                                                          {"red", "diffuse_red", "r"},
                                                          {"green", "diffuse_green", "g"},
                                                          {"blue", "diffuse_blue", "b"},
                                                          {"s", "u", "texture_u"},
                                                          {"t", "v", "texture_v"}};
  int role = property.list ? kNone : kX;
  while (role < kRoles &&
         std::find(kNames[role].begin(), kNames[role].end(), property.name) == kNames[role].end())
    ++role;
  return static_cast<Role>(role);
}

double colourScale(PlyType type) {
  if (isFloat(type)) return 1;
  return type == PlyType::int16 || type == PlyType::uint16 ? 1 / 65535.0 : 1 / 255.0;
}

class PlyReader {
 public:
  explicit PlyReader(const FileBytes& file)
      : file_(file), header_(readPlyHeader(file)), body_(file, header_) {}

  PolygonMesh read() {
    for (const PlyElement& element : header_.elements) {
      const std::uint64_t rows = body_.rows(element);
      const PlyRole role = plyRole(element);
      if (role == PlyRole::vertices) {
        readVertices(element);
      } else if (role == PlyRole::faces || role == PlyRole::strips) {
        readFaces(element, role);
      } else {
        for (std::uint64_t row = 0; row < rows; ++row) {
          poll(row);
          body_.skipRow(element);
        }
      }
    }
    const int count = static_cast<int>(mesh_.vertices.size());
    for (const int v : mesh_.corners)
      if (v >= count)
        throw FileError(file_.path, fmt::format("a face uses vertex {}, the file has {} (counted "
                                                "from 0); export the mesh again",
                                                v, count));
    finishUvs();
    return std::move(mesh_);
  }

 private:
  void poll(std::uint64_t index) const {
    if (index % 65536 == 0) throwIfCancelled();
  }

  void readVertices(const PlyElement& element) {
    std::vector<Role> roles;
    bool has[kRoles + 1] = {};
    double scale = 1;
    for (const PlyProperty& property : element.properties) {
      const Role role = roleOf(property);
      // The first of each name counts: some files have u v and s t.
      roles.push_back(has[role] ? kNone : role);
      has[role] = true;
      if (role == kRed) scale = colourScale(property.type);
    }
    if (!mesh_.vertices.empty()) body_.fail("the file has two vertex elements; keep one");
    if (!has[kX] || !has[kY] || !has[kZ]) body_.fail("the vertices have no x, y and z");
    const bool colours = has[kRed] && has[kGreen] && has[kBlue], uvs = has[kU] && has[kV];
    requireCountable(file_.path, element.count);
    mesh_.vertices.reserve(element.count);
    for (std::uint64_t i = 0; i < element.count; ++i) {
      poll(i);
      double values[kRoles] = {};
      for (std::size_t p = 0; p < roles.size(); ++p)
        if (roles[p] == kNone)
          body_.skip(element.properties[p]);
        else
          values[roles[p]] = body_.nextValue(element.properties[p].type);
      if (!isFinite({values[kX], values[kY], values[kZ]}) || !std::isfinite(values[kU]) ||
          !std::isfinite(values[kV]))
        body_.fail(fmt::format("vertex {} is not finite; export the mesh again", i));
      mesh_.vertices.push_back({values[kX], values[kY], values[kZ]});
      if (colours)
        mesh_.colours.push_back(
            clampedColour(scale * values[kRed], scale * values[kGreen], scale * values[kBlue]));
      if (uvs) vertexUvs_.push_back({values[kU], values[kV]});
    }
  }

  void readFaces(const PlyElement& element, PlyRole role) {
    const auto isCorners = [&](const PlyProperty& property) {
      return plyPart(role, property) == PlyPart::corners;
    };
    if (element.count > 0 &&
        std::none_of(element.properties.begin(), element.properties.end(), isCorners))
      body_.fail(fmt::format("the element '{}' has no list vertex_indices", element.name));
    PlyFaces faces(element);
    for (std::uint64_t i = 0; i < element.count; ++i) {
      poll(i);
      faces.read(body_);
      if (role == PlyRole::strips)
        addStrip(faces.corners);
      else
        addFace(i, faces);
    }
  }

  void addFace(std::uint64_t number, const PlyFaces& face) {
    const std::vector<int>& corners = face.corners;
    if (corners.size() < 3)
      body_.fail(
          fmt::format("face {} has {} corners, it needs three; remove it", number, corners.size()));
    requireCountable(file_.path, mesh_.corners.size() + corners.size());
    mesh_.corners.insert(mesh_.corners.end(), corners.begin(), corners.end());
    mesh_.start.push_back(static_cast<int>(mesh_.corners.size()));
    if (face.uvs.size() != 2 * corners.size()) return;
    mesh_.uvCorners.resize(mesh_.corners.size() - corners.size(), -1);
    for (std::size_t k = 0; k < corners.size(); ++k) {
      mesh_.uvCorners.push_back(static_cast<int>(mesh_.uvs.size()));
      mesh_.uvs.push_back({face.uvs[2 * k], face.uvs[2 * k + 1]});
    }
  }

  // Every vertex from the third makes a triangle with the two before, turned every other time; -1
  // begins a new strip; repeated vertices only steer the strip.
  void addStrip(const std::vector<int>& strip) {
    std::size_t first = 0;
    for (std::size_t k = 0; k < strip.size(); ++k) {
      if (strip[k] < 0) first = k + 1;
      if (strip[k] < 0 || k < first + 2) continue;
      Triangle t{strip[k - 2], strip[k - 1], strip[k]};
      if ((k - first) % 2 == 1) std::swap(t[0], t[1]);
      if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
      requireCountable(file_.path, mesh_.corners.size() + 3);
      mesh_.corners.insert(mesh_.corners.end(), t.begin(), t.end());
      mesh_.start.push_back(static_cast<int>(mesh_.corners.size()));
    }
  }

  void finishUvs() {
    if (!mesh_.uvCorners.empty()) {
      mesh_.uvCorners.resize(mesh_.corners.size(), -1);
    } else if (!vertexUvs_.empty()) {
      mesh_.uvs = std::move(vertexUvs_);
      mesh_.uvCorners = mesh_.corners;
    }
  }

  const FileBytes& file_;
  const PlyHeader header_;
  PlyBody body_;
  PolygonMesh mesh_;
  std::vector<Vec2> vertexUvs_;
};

}  // namespace

PolygonMesh readPly(const FileBytes& file) { return PlyReader(file).read(); }

}  // namespace innermap
