#include "innermap/tetra/detail/hex_shaping.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "innermap/core/parallel.h"
#include "innermap/evaluate/untangle.h"
#include "innermap/mesh/triangle_tree.h"
#include "innermap/sample/surface_samples.h"
#include "innermap/tetra/detail/guide_surface.h"
#include "innermap/tetra/hexahedron_check.h"

namespace innermap {
namespace {
double env(const char*n,double d){ const char*s=getenv(n); return s?atof(s):d; }

constexpr double kPillow = 0.6;  // thickness of the layer by a hexahedron's edge
constexpr std::size_t kPullsAVertex = 4, kBlock = 256;

double scaledJacobian(const Points& at, const Tetrahedron& t) {
  const Vec3 a = at[t[1]] - at[t[0]], b = at[t[2]] - at[t[0]], c = at[t[3]] - at[t[0]];
  const double lengths = norm(a) * norm(b) * norm(c);
  return lengths > 0 ? dot(a, cross(b, c)) / lengths : 0;
}

class Shaping {
 public:
  Shaping(BlockHexahedra& hexes, std::size_t core, const Mesh& surface,
          std::vector<SurfacePoint>& onSurface, const HexShapingSettings& settings)
      : hexes_(hexes),
        settings_(settings),
        guide_(surface.vertices, surface.triangles),
        onSurface_(onSurface),
        skinOf_(hexes.mesh.vertices.size(), -1) {
    const auto pillows = static_cast<double>(hexes.mesh.hexahedra.size() - core);
    unit_ = std::cbrt(signedVolume(surface) / (static_cast<double>(core) + kPillow * pillows));
    origin_ = boundingBox(surface).center();
    for (std::size_t s = 0; s < hexes.skin.size(); ++s)
      skinOf_[hexes.skin[s].outer] = static_cast<int>(s);
    for (const Vec3& p : hexes.mesh.vertices) patch_.vertices.push_back((1 / unit_) * (p - origin_));
    carried_ = patch_.vertices;
    patch_.free.assign(patch_.vertices.size(), 1);
    for (std::size_t h = 0; h < hexes.mesh.hexahedra.size(); ++h)
      for (const Tetrahedron& t : cornerTetrahedra(hexes.mesh.hexahedra[h])) {
        patch_.tets.push_back(t);
        patch_.rest.push_back(restOf(t, h >= core));
      }
    patch_.weights.assign(patch_.tets.size(), 1);
    boundary_ = boundaryTriangles(hexes.mesh);
    for (const SurfacePoint& p :
         randomSamples(surface, kPullsAVertex * hexes.skin.size(), SampleSettings{})) {
      pulls_.push_back((1 / unit_) * (positionOf(surface, p) - origin_));
      pullNormals_.push_back(guide_.normal(p.triangle));
    }
  }

  HexShaping run() {
    HexShaping out;
    stiffness_ = env("KN", 10);
    placeSprings();
    UntangleSettings first;
    first.rounds = 30;
    first.progress = settings_.progress;
    first.afterRound = [&](TetPatch&, int round) {
      reportProgress(settings_.progress, "untangling hexahedra", (round + 1) / 30.0);
      placeSprings();
      weigh();
    };
    untangle(patch_, first);
    if (getenv("VERB")) fmt::print("   untangled: {} sj {:.3f}\n", below(0), least());
    UntangleSettings more;
    more.keep = true;
    more.rounds = 1;
    more.progress = settings_.progress;
    for (; out.rounds < settings_.rounds; ++out.rounds) {
      reportProgress(settings_.progress, "shaping hexahedra",
                     static_cast<double>(out.rounds) / settings_.rounds);
      if (out.rounds < env("GROWN",5)) stiffness_ *= env("GROW", 1.5);
      placeSprings();
      weigh();
      more.keep = !(below(0) > 0);
      untangle(patch_, more);
      if (getenv("VERB")) fmt::print("   round {}: {} sj {:.3f}\n", out.rounds, below(settings_.goal), least());
    }
    for (std::size_t v = 0; v < patch_.vertices.size(); ++v)
      hexes_.mesh.vertices[v] = origin_ + unit_ * patch_.vertices[v];
    return out;
  }

 private:
  // The edges at a corner of a cube, or of one that is as thick as the layer.
  Mat3 restOf(const Tetrahedron& t, bool pillow) const {
    Mat3 rest{};
    for (std::size_t e = 0; e < 3; ++e) {
      const bool through = pillow && (skinOf_[t[0]] >= 0) != (skinOf_[t[e + 1]] >= 0);
      rest[e][e] = through ? 1 / kPillow : 1;
    }
    return rest;
  }

  void placeSprings() {
    const std::size_t skins = hexes_.skin.size();
    patch_.springs.assign(skins, {});
    parallelBlocks(skins, kBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t s = begin; s < end; ++s) {
        const int v = hexes_.skin[s].outer;
        const ClosestPoint found =
            guide_.closestFrom(onSurface_[s].triangle, origin_ + unit_ * patch_.vertices[v]);
        onSurface_[s] = found.address;
        patch_.springs[s] = {v, (1 / unit_) * (found.position - origin_),
                             guide_.normal(found.address.triangle), stiffness_};
      }
    });
    if (env("A", 0) > 0)
      for (std::size_t s = 0; s < skins; ++s) {
        const int v = hexes_.skin[s].outer;
        patch_.springs.push_back({v, carried_[v], {}, env("A", 0)});
      }
    if (env("PULL", 1) > 0) addPulls();
  }

  // Of each vertex of the boundary, the mean way from the faces about it to the points of the
  // surface that are nearest to them.
  void addPulls() {
    const TriangleTree faces(patch_.vertices, boundary_);
    std::vector<ClosestPoint> feet(pulls_.size());
    parallelBlocks(pulls_.size(), kBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t p = begin; p < end; ++p) feet[p] = faces.closest(pulls_[p]);
    });
    std::vector<double> weight(patch_.vertices.size(), 0);
    Points way(patch_.vertices.size());
    for (std::size_t p = 0; p < pulls_.size(); ++p) {
      const Triangle& t = boundary_[feet[p].address.triangle];
      const Vec3 n = cross(patch_.vertices[t[1]] - patch_.vertices[t[0]],
                           patch_.vertices[t[2]] - patch_.vertices[t[0]]);
      if (!(dot(n, pullNormals_[p]) > 0)) continue;  // of another sheet
      for (std::size_t k = 0; k < 3; ++k) {
        const double w = feet[p].address.barycentric[k];
        weight[t[k]] += w;
        way[t[k]] += w * (pulls_[p] - feet[p].position);
      }
    }
    for (const auto& skin : hexes_.skin) {
      const double w = weight[skin.outer];
      if (!(w > 0)) continue;
      const Vec3 mean = way[skin.outer] / w;
      const double length = norm(mean);
      if (!(length > 1e-9)) continue;
      patch_.springs.push_back({skin.outer, patch_.vertices[skin.outer] + mean, mean / length,
                                env("PULL", 1) * stiffness_ * std::min(1.0, w)});
    }
  }

  // What is below the goal counts more and more, what is well above it no more than at first.
  void weigh() {
    parallelBlocks(patch_.tets.size(), kBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t) {
        const double now = scaledJacobian(patch_.vertices, patch_.tets[t]);
        double& w = patch_.weights[t];
        if (now < settings_.goal)
          w = std::min(w * env("MULT", 2), env("WMAX", 1000));
        else if (now > 1.2 * settings_.goal)
          w = std::max(1.0, w * 0.8);
      }
    });
  }

  double least() const {
    double sj = 1;
    for (const Tetrahedron& t : patch_.tets) sj = std::min(sj, scaledJacobian(patch_.vertices, t));
    return sj;
  }
  int below(double q) const {
    int n = 0;
    for (const Tetrahedron& t : patch_.tets) n += !(scaledJacobian(patch_.vertices, t) > q);
    return n;
  }

  BlockHexahedra& hexes_;
  const HexShapingSettings& settings_;
  GuideSurface guide_;
  std::vector<SurfacePoint>& onSurface_;
  std::vector<int> skinOf_;  // of each vertex, or -1
  double unit_ = 1;          // world units
  Vec3 origin_;
  TetPatch patch_;  // in units of edges, about the origin
  Points carried_;
  std::vector<Triangle> boundary_;
  Points pulls_, pullNormals_;  // points of the surface
  double stiffness_ = 0;
};

}  // namespace

HexShaping shapeHexahedra(BlockHexahedra& hexes, std::size_t core, const Mesh& surface,
                          std::vector<SurfacePoint>& onSurface,
                          const HexShapingSettings& settings) {
  return Shaping(hexes, core, surface, onSurface, settings).run();
}

}  // namespace innermap
