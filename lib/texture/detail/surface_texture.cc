#include "texture/detail/surface_texture.h"

#include <cmath>

#include "innermap/core/error.h"

namespace innermap {
namespace {

constexpr double kLargestUv = 1e5;

// 1 where all corners have finite coordinates.
std::vector<char> withUv(const Mesh& mesh) {
  std::vector<char> bears(mesh.triangles.size(), 0);
  for (std::size_t t = 0; t < mesh.uvTriangles.size(); ++t) {
    bears[t] = 1;
    for (const int uv : mesh.uvTriangles[t]) {
      if (uv < 0 || !std::isfinite(mesh.uvs[uv].x) || !std::isfinite(mesh.uvs[uv].y)) {
        bears[t] = 0;
        break;
      }
      if (std::abs(mesh.uvs[uv].x) > kLargestUv || std::abs(mesh.uvs[uv].y) > kLargestUv)
        throw DataError(
            mesh.name +
            ": has texture coordinates beyond 100000; give it ones that were unwrapped");
    }
  }
  return bears;
}

struct Axes {
  Vec2 a, b;
};

// What two steps of `length` along and across the triangle do to its texture coordinates.
Axes steps(const Mesh& mesh, int triangle, double length) {
  const Triangle &t = mesh.triangles[triangle], &c = mesh.uvTriangles[triangle];
  const Vec3 p = mesh.vertices[t[1]] - mesh.vertices[t[0]],
             q = mesh.vertices[t[2]] - mesh.vertices[t[0]];
  const double along = norm(p), area = norm(cross(p, q));
  if (!(along > 0) || !(area > 1e-12 * along * along)) return {};
  const double x = dot(q, p) / along, y = area / along;
  const Vec2 &u0 = mesh.uvs[c[0]], &u1 = mesh.uvs[c[1]], &u2 = mesh.uvs[c[2]];
  const Vec2 a{(u1.x - u0.x) / along, (u1.y - u0.y) / along};
  const Vec2 b{(u2.x - u0.x - x * a.x) / y, (u2.y - u0.y - x * a.y) / y};
  return {{length * a.x, length * a.y}, {length * b.x, length * b.y}};
}

}  // namespace

SurfaceTexture::SurfaceTexture(const Solid& solid, const Mesh& mesh, TextureKind kind,
                               TextureLookup texture, std::optional<UvGroups> groups)
    : mesh_(mesh),
      kind_(kind),
      texture_(std::move(texture)),
      groups_(std::move(groups)),
      lookup_(solid, mesh, withUv(mesh), "texture coordinates") {
  if (groups_) findCentres();
}

SurfaceTexture::SurfaceTexture(const Solid& solid, const Mesh& mesh, const Decoding& decode)
    : mesh_(mesh),
      kind_(TextureKind::colours),
      lookup_(solid, mesh, std::vector<char>(mesh.triangles.size(), 1), "vertex colours") {
  for (const auto& c : mesh.colours) {
    Vec3 colour;
    for (int k = 0; k < 3; ++k) {
      const double v = decode ? decode(c[k]) : c[k];
      if (!std::isfinite(v)) throw DataError(mesh.name + ": has a vertex colour that is no number");
      colour[k] = v;
    }
    vertexColours_.push_back(colour);
  }
}

void SurfaceTexture::findCentres() {
  std::vector<double> area(static_cast<std::size_t>(groups_->count), 0.0);
  centres_.assign(area.size(), {});
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    if (groups_->group[t] < 0) continue;
    const auto g = static_cast<std::size_t>(groups_->group[t]);
    const double a = norm(areaVector(mesh_, static_cast<int>(t)));
    const Vec2 uv = uvAt({static_cast<int>(t), {1.0 / 3, 1.0 / 3, 1.0 / 3}});
    area[g] += a;
    centres_[g].x += a * uv.x;
    centres_[g].y += a * uv.y;
  }
  for (std::size_t g = 0; g < area.size(); ++g)
    if (area[g] > 0) centres_[g] = {centres_[g].x / area[g], centres_[g].y / area[g]};
}

std::size_t SurfaceTexture::channels() const {
  if (kind_ == TextureKind::groups) return 3 * centres_.size();
  return kind_ == TextureKind::colours && vertexColours_.empty() ? 6 : 3;
}

Vec2 SurfaceTexture::uvAt(const InputPoint& p) const {
  const Triangle& c = mesh_.uvTriangles[p.triangle];
  return {p.mean([&](int k) { return mesh_.uvs[c[k]].x; }),
          p.mean([&](int k) { return mesh_.uvs[c[k]].y; })};
}

Vec3 SurfaceTexture::colourAt(const InputPoint& p, double spacing) const {
  if (!vertexColours_.empty()) {
    const Triangle& t = mesh_.triangles[p.triangle];
    return p.mean([&](int k) { return vertexColours_[t[k]]; });
  }
  const Axes axes = steps(mesh_, p.triangle, spacing);
  return texture_(uvAt(p), axes.a, axes.b);
}

void SurfaceTexture::values(const SurfacePoint& onSurface, double spacing, double* out) const {
  const InputPoint p = lookup_.at(onSurface);
  if (kind_ == TextureKind::groups) {
    std::fill(out, out + channels(), 0.0);
    const auto g = static_cast<std::size_t>(groups_->group[p.triangle]);
    const Vec2 uv = uvAt(p);
    out[3 * g] = 1;
    out[3 * g + 1] = uv.x - centres_[g].x;
    out[3 * g + 2] = uv.y - centres_[g].y;
    return;
  }
  if (kind_ == TextureKind::colours) {
    const Vec3 colour = colourAt(p, spacing);
    for (int k = 0; k < 3; ++k) *out++ = colour[k];
    if (!vertexColours_.empty()) return;
  }
  const Vec2 uv = uvAt(p);
  out[0] = uv.x;
  out[1] = uv.y;
  out[2] = 0;
}

Matrix SurfaceTexture::values(const std::vector<SurfacePoint>& onSurface, double spacing) const {
  Matrix all(onSurface.size(), channels());
  std::vector<double> one(channels());
  for (std::size_t i = 0; i < onSurface.size(); ++i) {
    values(onSurface[i], spacing, one.data());
    for (std::size_t k = 0; k < one.size(); ++k) all(i, k) = one[k];
  }
  return all;
}

Vec3 SurfaceTexture::colour(const SurfacePoint& onSurface, double spacing) const {
  return colourAt(lookup_.at(onSurface), spacing);
}

Vec3 SurfaceTexture::colourOnEdge(int triangle, int corner, double t, double spacing) const {
  InputPoint p{triangle, {0, 0, 0}};
  p.weights[static_cast<std::size_t>(corner)] = 1 - t;
  p.weights[static_cast<std::size_t>((corner + 1) % 3)] = t;
  return colourAt(p, spacing);
}

}  // namespace innermap
