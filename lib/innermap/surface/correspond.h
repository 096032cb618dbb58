// Where each point of one closed surface lies on another that was never related to it.
//
// Both are laid out on a common model space (surface/layout.h); rotations of it and matched limb
// tips give candidates, which are refined by lowering the symmetric Dirichlet energy both ways.
// After Praun and Hoppe, "Spherical parametrization and remeshing" (SIGGRAPH 2003); Schmidt,
// Campen, Born, Kobbelt, "Inter-surface maps via constant-curvature metrics" (SIGGRAPH 2020).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "innermap/mesh/mesh.h"
#include "innermap/surface/closed_surface.h"
#include "innermap/surface/layout.h"

namespace innermap {

struct Correspondence;
struct CorrespondSettings;

struct EmbeddingSettings {
  bool closeHoles = false;  // cap the boundary loops of an open mesh; otherwise it is refused
};

// A mesh with its shells laid out: what any number of partners can be mapped onto. Immutable, cheap
// to copy, safe from any number of threads.
class EmbeddedSurface {
 public:
  // Throws what closedSurfaces() throws.
  explicit EmbeddedSurface(const Mesh& mesh, const EmbeddingSettings& settings = {});

  const SurfaceShells& surfaces() const;
  // Of a shell of genus 0 or 1; of higher genus: empty.
  const Layout& layout(std::size_t shell) const;
  double seconds() const;  // that laying out took

 private:
  friend Correspondence correspond(const EmbeddedSurface&, const EmbeddedSurface&,
                                   const CorrespondSettings&);
  struct Implementation;
  std::shared_ptr<const Implementation> implementation_;
};

// Throws DataError where the shells of the two have no pairing of the same topology, as
// correspond() does.
void requireSameTopology(const SurfaceShells& a, const SurfaceShells& b);

struct Landmark {
  int vertex = 0;         // of A's mesh
  SurfacePoint onTarget;  // of B's mesh
};

// A judge for maps of one shell onto another, or null: then by their energy.
using JudgeMaker =
    std::function<std::shared_ptr<const MapJudge>(const ClosedSurface& a, const ClosedSurface& b)>;

struct CorrespondSettings {
  std::vector<Landmark> landmarks;  // met to rounding
  bool aligned = false;  // the two stand in the same pose: prefer agreeing normals and places
  int candidates = 3;    // that are refined, in [1, 64]; the one of least energy is taken
  bool refine = true;
  JudgeMaker judge;  // chooses among first maps and among those refined; none: the least energy
  WantedWay way;     // another than the best: with a judge, of shells of genus 0 and 1
  std::uint64_t seed = 1;
  double subdivide = 0;  // split A until it follows B within this share of B's diagonal; 0: never
};

struct CutSurface;

// One shell of A on one of B. Of genus 2 and more both are cut along meridians and capped, and the
// map is one between those.
struct ShellCorrespondence {
  int source = 0, target = 0;                   // shells of A and B
  ClosedSurface surface;                        // A's shell, subdivided where asked
  Layout image;                                 // of `surface` on the model space of targetSurface
  ClosedSurface targetSurface;                  // B's shell
  Layout targetLayout;                          // of it
  std::vector<SurfacePoint> onTarget;           // #vertices of surface: triangle of targetSurface
  Points positions;                             // #vertices of surface, world units
  std::shared_ptr<const CutSurface> targetCut;  // how B's shell was cut; null up to genus 1
  std::string origin;                           // how the map was found, in words
  int way = 1;                                  // WantedWay::choose that gives this one
  std::vector<ConsideredMap> considered;        // with a judge: first maps, best first
  std::optional<OtherWay> other;                // that is as good
};

struct Correspondence {
  // A with its own vertices first, in order, then those that subdividing added; connectivity as
  // A's own but for what was subdivided.
  Mesh source;
  Points positions;                    // #vertices of source: where each lies on B. A loose vertex
                                       // lies where the nearest used one does
  std::vector<SurfacePoint> onTarget;  // of each, triangle of b.surfaces().mesh
  std::vector<ShellCorrespondence> shells;
  std::vector<std::string> notes;                       // choices worth telling, a line each
  std::vector<std::pair<std::string, double>> seconds;  // by stage
};

// Addresses in the mesh (target.mesh, of b.surfaces()) of points of a shell's targetSurface; points
// on a cap go to its rim. #points.
std::vector<SurfacePoint> onTargetMesh(const ShellCorrespondence& shell,
                                       const SurfaceShells& target,
                                       const std::vector<SurfacePoint>& points);

// Throws DataError where the solids' topology differs (naming both), where landmarks contradict one
// another or the orientation; SettingError, also where there is no such way round; Cancelled. Same
// result for any number of threads.
Correspondence correspond(const EmbeddedSurface& a, const EmbeddedSurface& b,
                          const CorrespondSettings& settings = {});

// A correspondence asked anywhere.
struct SurfaceImages {
  Points positions;                    // #points, world units, on B
  std::vector<SurfacePoint> onTarget;  // #points: triangle of target.mesh
  double farthest = 0;                 // of the points from A's surface, world units
};

// Where points near A's surface lie on B: each goes where the closest point of A's shells goes, by
// the map through the model space, which is one-to-one (not by chords between moved vertices).
// `target`: the shells that the map was made onto (b.surfaces()). Same result for any number of
// threads. Throws Cancelled.
SurfaceImages imagesOf(const Points& points, const Correspondence& map,
                       const SurfaceShells& target);

// The way back: the points of A (world units) that lie on points of B, given by triangle of
// target.mesh. Points of triangles that are in no shell go with the closest shell. Throws
// Cancelled.
Points preimagesOf(const std::vector<SurfacePoint>& onTarget, const Correspondence& map,
                   const SurfaceShells& target);

}  // namespace innermap
