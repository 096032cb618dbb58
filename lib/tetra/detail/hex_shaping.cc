#include "tetra/detail/hex_shaping.h"

#include <algorithm>
#include <cmath>

#include "innermap/core/run.h"
#include "innermap/tetra/hexahedralize.h"
#include "lattice/untangle.h"
#include "mesh/triangle_tree.h"
#include "sample/surface_samples.h"
#include "tetra/detail/guide_surface.h"

namespace innermap {
namespace {

constexpr double kPillow = 0.6;    // thickness of the layer, by a hexahedron's edge
constexpr double kStiffness = 30;  // of the springs at first; a cube's eight corners have 32
constexpr double kGrowth = 1.5;    // of that from round to round,
constexpr int kGrowing = 5;        // in so many
constexpr double kPull = 2;        // of the surface's points beside the springs
constexpr std::size_t kPointsAVertex = 4;
constexpr int kUntangling = 12;  // rounds
constexpr double kHeavier = 2, kLighter = 0.8, kHeaviest = 1000;
constexpr double kEnough = 1.2;  // times the goal: such corners count less again
constexpr std::size_t kShapingBlock = 256;

double scaledDeterminant(const Points& at, const Tetrahedron& t) {
  const Vec3 a = at[t[1]] - at[t[0]], b = at[t[2]] - at[t[0]], c = at[t[3]] - at[t[0]];
  const double lengths = norm(a) * norm(b) * norm(c);
  return lengths > 0 ? dot(a, cross(b, c)) / lengths : 0;
}

class Shaping {
 public:
  Shaping(BlockHexahedra& hexes, const Mesh& surface, std::vector<SurfacePoint>& onSurface,
          const HexShapingSettings& settings)
      : hexes_(hexes),
        settings_(settings),
        guide_(surface.vertices, surface.triangles),
        onSurface_(onSurface),
        boundary_(boundaryTriangles(hexes.mesh)) {
    const double pillows = static_cast<double>(hexes.mesh.hexahedra.size() - hexes.core);
    unit_ =
        std::cbrt(signedVolume(surface) / (static_cast<double>(hexes.core) + kPillow * pillows));
    origin_ = boundingBox(surface).center();
    makePatch();
    SampleSettings sampling;
    sampling.seed = settings.seed;
    for (const SurfacePoint& p :
         randomSamples(surface, kPointsAVertex * hexes.skin.size(), sampling)) {
      points_.push_back(toLocal(positionOf(surface, p)));
      pointNormals_.push_back(guide_.normal(p.triangle));
    }
  }

  void run() {
    placeSprings();
    UntangleSettings first;
    first.rounds = kUntangling;
    first.afterRound = [&](TetPatch&, int round) {
      reportProgress("untangling hexahedra", (round + 1.0) / kUntangling);
      if (leastCorner() > 0) return;
      placeSprings();
      weigh();
    };
    untangle(patch_, first);
    // Up to twice as many where some are not right side out by then.
    for (int round = 0; round < 2 * settings_.rounds; ++round) {
      if (round >= settings_.rounds && unproven_ == 0) break;
      if (outOfTime()) break;
      reportProgress("shaping hexahedra",
                     std::min(1.0, static_cast<double>(round) / settings_.rounds));
      if (round < kGrowing) stiffness_ *= kGrowth;
      placeSprings();
      weigh();
      UntangleSettings more;
      more.keep = leastCorner() > 0;
      more.rounds = 1;
      untangle(patch_, more);
      weighInverted();
    }
    for (std::size_t v = 0; v < patch_.vertices.size(); ++v)
      hexes_.mesh.vertices[v] = toWorld(patch_.vertices[v]);
  }

 private:
  Vec3 toLocal(const Vec3& p) const { return (1 / unit_) * (p - origin_); }
  Vec3 toWorld(const Vec3& p) const { return origin_ + unit_ * p; }

  void makePatch() {
    const CellMesh& mesh = hexes_.mesh;
    std::vector<char> outer(mesh.vertices.size(), 0);
    for (const auto& skin : hexes_.skin) outer[skin.outer] = 1;
    for (const Vec3& p : mesh.vertices) patch_.vertices.push_back(toLocal(p));
    patch_.free.assign(mesh.vertices.size(), 1);
    for (std::size_t h = 0; h < mesh.hexahedra.size(); ++h)
      for (const Tetrahedron& t : cornerTetrahedra(mesh.hexahedra[h])) {
        // The corner of a cube, or of one that is as thick as the layer.
        Mat3 rest{};
        for (std::size_t e = 0; e < 3; ++e) {
          const bool through = h >= hexes_.core && outer[t[0]] != outer[t[e + 1]];
          rest[e][e] = through ? 1 / kPillow : 1;
        }
        patch_.tets.push_back(t);
        patch_.rest.push_back(rest);
      }
    patch_.weights.assign(patch_.tets.size(), 1);
  }

  // At where the boundary is now.
  void placeSprings() {
    const std::size_t skins = hexes_.skin.size();
    patch_.springs.assign(skins, {});
    parallelBlocks(skins, kShapingBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t s = begin; s < end; ++s) {
        const int v = hexes_.skin[s].outer;
        const ClosestPoint found =
            guide_.closestFrom(onSurface_[s].triangle, toWorld(patch_.vertices[v]));
        onSurface_[s] = found.address;
        patch_.springs[s] = {v, toLocal(found.position), guide_.normal(found.address.triangle),
                             stiffness_};
      }
    });
    addPulls();
  }

  // Of each vertex of the boundary: the mean way from the faces about it to the points of the
  // surface that are nearest to them.
  void addPulls() {
    const Points& at = patch_.vertices;
    const TriangleTree faces(at, boundary_);
    std::vector<ClosestPoint> feet(points_.size());
    parallelBlocks(points_.size(), kShapingBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t p = begin; p < end; ++p) feet[p] = faces.closest(points_[p]);
    });
    std::vector<double> weight(at.size(), 0);
    Points way(at.size());
    for (std::size_t p = 0; p < points_.size(); ++p) {
      const Triangle& t = boundary_[feet[p].address.triangle];
      const Vec3 normal = cross(at[t[1]] - at[t[0]], at[t[2]] - at[t[0]]);
      if (!(dot(normal, pointNormals_[p]) > 0)) continue;  // of another sheet
      for (std::size_t k = 0; k < 3; ++k) {
        const double w = feet[p].address.barycentric[k];
        weight[t[k]] += w;
        way[t[k]] += w * (points_[p] - feet[p].position);
      }
    }
    for (const auto& skin : hexes_.skin) {
      const double w = weight[skin.outer];
      const double length = norm(way[skin.outer]);
      if (!(w > 1e-3) || !(length > 1e-9)) continue;  // rounded, no point or no way
      patch_.springs.push_back({skin.outer, at[skin.outer] + way[skin.outer] / w,
                                way[skin.outer] / length, kPull * stiffness_ * std::min(1.0, w)});
    }
  }

  // What is below the goal counts more and more; what is well above it, in the end no more than
  // at first.
  void weigh() {
    parallelBlocks(patch_.tets.size(), kShapingBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t) {
        const double now = scaledDeterminant(patch_.vertices, patch_.tets[t]);
        double& weight = patch_.weights[t];
        if (now < settings_.goal)
          weight = std::min(weight * kHeavier, kHeaviest);
        else if (now > kEnough * settings_.goal)
          weight = std::max(weight * kLighter, 1.0);
      }
    });
  }

  // Corners may be good where the cell between them is not.
  void weighInverted() {
    unproven_ = 0;
    const std::vector<Hexahedron>& cells = hexes_.mesh.hexahedra;
    for (std::size_t h = 0; h < cells.size(); ++h) {
      if (leastJacobian(patch_.vertices, cells[h]).proven()) continue;
      ++unproven_;
      for (std::size_t t = 8 * h; t < 8 * h + 8; ++t)
        patch_.weights[t] = std::min(4 * kHeavier * patch_.weights[t], kHeaviest);
    }
  }

  double leastCorner() const {
    double least = 1;
    for (const Tetrahedron& t : patch_.tets)
      least = std::min(least, scaledDeterminant(patch_.vertices, t));
    return least;
  }

  BlockHexahedra& hexes_;
  const HexShapingSettings& settings_;
  GuideSurface guide_;
  std::vector<SurfacePoint>& onSurface_;
  std::vector<Triangle> boundary_;
  double unit_ = 1;  // an edge of a hexahedron, world units
  Vec3 origin_;
  TetPatch patch_;                // in units, about the origin
  Points points_, pointNormals_;  // of the surface, in units
  double stiffness_ = kStiffness;
  std::size_t unproven_ = 0;  // hexahedra that may be inverted somewhere
};

}  // namespace

void shapeHexahedra(BlockHexahedra& hexes, const Mesh& surface,
                    std::vector<SurfacePoint>& onSurface, const HexShapingSettings& settings) {
  Shaping(hexes, surface, onSurface, settings).run();
}

}  // namespace innermap
