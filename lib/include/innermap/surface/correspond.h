// Where each point of one closed surface lies on another of any connectivity.
//
// Both are laid out on a common model space; rotations of it and matched
// limb tips give candidates, which are refined by lowering the symmetric Dirichlet energy both
// ways. After Praun and Hoppe, "Spherical parametrization and remeshing" (SIGGRAPH 2003); Schmidt,
// Campen, Born, Kobbelt, "Inter-surface maps via constant-curvature metrics" (SIGGRAPH 2020).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/mesh/mesh.h"

namespace innermap {

// A closed surface, and how it is laid out on a model space: the unit sphere, or the plane modulo a
// lattice (the flat torus). One description serves both: points are rays from the origin, triangles
// are cones over three rays, and on the torus all points have z = 1, where rays are plane points.

struct ClosedSurface {
  std::string name;                 // what error messages should call it
  Points vertices;                  // #V, world units; each is used by some triangle
  std::vector<Triangle> triangles;  // #T; each edge has two, running opposite ways; outward of the
                                    // solid (so a cavity's shell has a negative volume)
  int genus = 0;                    // handles: #V - #E + #T = 2 - 2 genus
};

enum class ModelSpace { sphere, torus };

// A translation of the plane by a * period[0] + b * period[1].
struct Shift {
  int a = 0, b = 0;
};

inline Shift operator+(const Shift& s, const Shift& t) { return {s.a + t.a, s.b + t.b}; }
inline Shift operator-(const Shift& s, const Shift& t) { return {s.a - t.a, s.b - t.b}; }
inline bool operator==(const Shift& s, const Shift& t) { return s.a == t.a && s.b == t.b; }

using CornerShifts = std::array<Shift, 3>;

// Of a ClosedSurface, whose triangles it belongs to. A layout is valid when each triangle's corners
// p, q, r have det(p, q, r) > 0: then it is one-to-one (degree 1), as the triangles cover the space
// once.
struct Layout {
  ModelSpace space = ModelSpace::sphere;
  Points place;  // #V; sphere: unit vectors; torus: (x, y, 1)

  // Torus only. period[0] is the lattice vector of the meridian, period[1] that of the longitude,
  // both with z = 0 and det(period[0], period[1]) > 0 in the plane. Corner k of triangle t stands
  // at place[triangles[t][k]] moved by shift[t][k].
  std::array<Vec3, 2> period{};
  std::vector<CornerShifts> shift;  // #T; empty on the sphere

  Vec3 moved(const Vec3& p, const Shift& s) const {
    return p + (static_cast<double>(s.a) * period[0] + static_cast<double>(s.b) * period[1]);
  }
  Vec3 corner(const std::vector<Triangle>& triangles, int t, int k) const {
    const Vec3& p = place[triangles[t][k]];
    return shift.empty() ? p : moved(p, shift[t][k]);
  }
};

// Of three rays: six times the signed volume of the cone; positive where a layout is valid.
inline double tripleProduct(const Vec3& p, const Vec3& q, const Vec3& r) {
  return dot(p, cross(q - p, r - p));
}

struct LayoutQuality {
  std::size_t flips = 0;      // triangles with tripleProduct not above 0
  double degree = 0;          // signed area covered over that of the space; 1 when valid
  double areaRatioLog10 = 0;  // the least log10 of (a triangle's share of the space / its share of
                              // the surface), over triangles that have area
};

LayoutQuality layoutQuality(const std::vector<Triangle>& triangles, const Points& vertices,
                            const Layout& layout);

// Of several shells: all flips, the degree farthest from 1, the least ratio.
LayoutQuality together(const std::vector<LayoutQuality>& shells);

// Judges maps of a shell by more than the two surfaces: by the inside, say.
struct MapJudge {
  std::vector<SurfacePoint> at;                       // of A's shell
  std::function<double(const Points& images)> score;  // of `at`, world units on B; less is better
};

// Which way round one surface is laid on another, of those that a judge heard.
struct WantedWay {
  int choose = 1;       // by preference: the best, then the next that differs, ...
  bool mirror = false;  // instead: the best that turns left into right, as `choose` = 1 does not
};

// A map that was considered.
struct ConsideredMap {
  std::string origin;  // how it was found, in words
  double energy = 0;   // of a coarse surface, both ways
  double score = 0;    // the judge's, of that
  double turn = 0;     // degrees of the rotation nearest to it, in [0, 180]
  int way = 1;         // maps that put A's parts at about the same places are one way round
};

// Another way round that a judge finds as good as the one that was taken.
struct OtherWay {
  int way = 2;
  std::array<double, 2> score{}, turn{};  // of the one taken and of this one
  ClosedSurface surface;                  // A's shell, coarse
  Layout image;                           // of it
};

// The shells of a solid's boundary, ready to be mapped: each closed, connected, manifold, oriented.

// A vertex of one of several shells.
struct ShellVertex {
  int shell = -1, vertex = -1;  // -1: none (loose vertices)
};

// A mesh taken apart. Vertices that the file split along texture seams are one.
struct SurfaceShells {
  // Vertices: the mesh's own in its order, then the caps', then one for each further fan of a
  // vertex where parts touch. Triangles: the mesh's own in its order, turned where that was needed
  // to be outward, then the caps'. Triangles that are in no shell (duplicates, with a repeated
  // vertex, of parts that enclose nothing) stay in it.
  Mesh mesh;
  std::vector<ClosedSurface> shells;     // in order of their first triangles
  std::vector<int> parent;               // #shells: the shell directly around it, or -1
  std::vector<ShellVertex> shellVertex;  // for each vertex of mesh
  // For each shell, each triangle's number in mesh; corner k is the same corner in both.
  std::vector<std::vector<int>> meshTriangle;
  std::vector<bool> turned;        // for each triangle of mesh: the file's runs the other way
  std::size_t splitVertices = 0;   // added for further fans
  int caps = 0;                    // boundary loops closed
  std::vector<std::string> notes;  // what was repaired, a line each
};

struct ClosedSurfaceSettings {
  bool closeHoles = false;  // cap boundary loops (mesh/check.h); otherwise they are an error
};

// Throws DataError: holes (their number and the longest) without consent to close them, edges of
// more than two triangles (the first few named by their vertices), one-sided surfaces, a mesh with
// no inside or in one plane; Cancelled. Vertices where parts merely touch are split: each fan gets
// one of its own. Parts that overlap one another stay shells of their own; a shell is inside
// another when most of it is.
SurfaceShells closedSurfaces(const Mesh& mesh, const ClosedSurfaceSettings& settings = {});

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

// How good a map between two surfaces is.

struct Quantiles {
  double median = 0, p99 = 0, max = 0;
};

// Both solids' shells scaled to unit area together, so a map that keeps all lengths but for one
// factor has energies 4 and stretch 1.
struct MapQuality {
  // On the model spaces, over all shells; with no flip and degree 1 the map is one-to-one.
  std::size_t flips = 0;      // triangles of A's images and of B's layouts
  double degree = 0;          // of the image farthest from degree 1
  double areaRatioLog10 = 0;  // least log10 of an image triangle's share of the model space over
                              // its share of A

  // Mean of the symmetric Dirichlet energy s1^2 + s2^2 + 1/s1^2 + 1/s2^2 of the map A -> B (s1, s2:
  // its singular values) over A's area, and over B's: at least 4 each.
  double energyForward = 0, energyBackward = 0;
  // max(s1, 1/s2) of the map A -> B, weighted by A's area. The map is the one through the model
  // space, which covers B exactly.
  Quantiles stretch;
  // The same of A's triangles onto the flat triangles between their moved vertices, 1e12 at most.
  Quantiles triangleStretch;
  double unmeasured = 0;  // share of the samples that fell on slivers (a height under a millionth
                          // of the longest edge), which have no meaningful derivative

  // Image triangles that face against B at all three corners and in the middle.
  std::size_t invertedTriangles = 0;
  double invertedShare = 0;  // of all triangles

  // Distance of the flat image triangles from B, and of B from them; shares of B's diagonal,
  // weighted by area.
  Quantiles deviation, backDeviation;

  // Pairs of triangles that pass through each other.
  std::size_t imageSelfIntersections = 0, targetSelfIntersections = 0;
};

struct MapQualitySettings {
  std::size_t samples = 100000;  // on each surface, spread by area; in [1, 1e8]. Each triangle has
                                 // one at least
  bool selfIntersections = true;
};

// Same result for any number of threads. Throws SettingError, Cancelled.
MapQuality mapQuality(const Correspondence& map, const MapQualitySettings& settings = {});

}  // namespace innermap
