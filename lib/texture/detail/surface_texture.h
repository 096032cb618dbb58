// What is known of a textured surface: its colours and texture coordinates, as boundary
// values of a field.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "innermap/core/matrix.h"
#include "innermap/levelset/solid.h"
#include "innermap/mesh/mesh.h"
#include "innermap/texture/solid_texture.h"
#include "mesh/uv_charts.h"
#include "texture/detail/input_lookup.h"

namespace innermap {

// Channels of the field that is continued inwards, three by three:
//   coordinates  u, v, 0
//   groups       w, w (u - c.x), w (v - c.y) for each group of charts
//   colours      r, g, b and, when the mesh has texture coordinates, u, v, 0
enum class TextureKind { coordinates, groups, colours };

// Immutable; safe from any number of threads. Keeps references to the mesh and the solid.
class SurfaceTexture {
 public:
  // With texture coordinates and the image to look up.
  SurfaceTexture(const Solid& solid, const Mesh& mesh, TextureKind kind, TextureLookup texture,
                 std::optional<UvGroups> groups = {});
  // With the mesh's vertex colours.
  using Decoding = std::function<double(double)>;
  SurfaceTexture(const Solid& solid, const Mesh& mesh, const Decoding& decode);

  std::size_t channels() const;
  std::vector<Vec2> groupCentres() const { return centres_; }

  // `channels()` values at a point of solid.surface(). Images are averaged over `spacing` (world
  // units): what a sample stands for.
  void values(const SurfacePoint& onSurface, double spacing, double* out) const;
  Matrix values(const std::vector<SurfacePoint>& onSurface, double spacing) const;

  // The colour at a point of the surface.
  Vec3 colour(const SurfacePoint& onSurface, double spacing) const;
  // The colour on one side of a seam: on the edge from the triangle's corner to the next, at t.
  Vec3 colourOnEdge(int triangle, int corner, double t, double spacing) const;

  double bearingShare() const { return lookup_.bearingShare(); }

 private:
  Vec2 uvAt(const InputPoint& p) const;
  Vec3 colourAt(const InputPoint& p, double spacing) const;
  void findCentres();

  const Mesh& mesh_;
  TextureKind kind_;
  TextureLookup texture_;
  std::optional<UvGroups> groups_;
  std::vector<Vec2> centres_;
  std::vector<Vec3> vertexColours_;
  InputLookup lookup_;
};

}  // namespace innermap
