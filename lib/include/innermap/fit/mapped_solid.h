// A map together with the solid that it maps: all that evaluating it, or carrying things through
// it, needs. It is what a map's file holds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "innermap/field/field_file.h"
#include "innermap/field/harmonic_field.h"
#include "innermap/fit/boundary_pair.h"
#include "innermap/mesh/check.h"
#include "innermap/proof/prove.h"

namespace innermap {

// What is known of a map's being one-to-one, and what follows from that, in words.
//
// Let f be continuously differentiable on the closure of a bounded domain. Its degree about a point
// y off the image of the boundary is the winding number of that image about y, and the number of
// points that f takes to y, each counted with the sign of det J (degree theory; Deimling,
// "Nonlinear Functional Analysis", 1985, chapter 1). So
//
// - where det J > 0 everywhere inside, as many points go to y as the image of the boundary winds
//   about it, and f is one-to-one inside when that winds about no point more than once: Ball,
//   "Global invertibility of Sobolev functions and the interpenetration of matter", Proc. Roy. Soc.
//   Edinburgh 88A, 1981, where boundary values are those of a one-to-one map; Meisters and Olech,
//   "Locally one-to-one mappings and a classical theorem on schlicht functions", Duke Math. J. 30,
//   1963;
// - a one-to-one map has the degree 1 or -1 about each point that it reaches, the same about all
//   that a connected part of the solid reaches, and on such a part det J nowhere changes its sign
//   (it may be 0: Wood, "Lewy's theorem fails in higher dimensions", Math. Scand. 1991). So both
//   signs on one part rule it out, and so does a boundary that winds twice about some point;
// - moving the boundary by less than the distance of y from it does not change how often it winds
//   about y. An image of the boundary that is within e of the target's surface winds about points
//   farther than e from that as the target does.

// Determinants of the map's derivative, world units of the target over those of the source, cubed,
// times the sign that they have where the map is not folded: -1 onto a target that is inside out.
struct DeterminantFigures {
  std::size_t checked = 0;  // points or cells; none: nothing is known of them
  std::size_t folded = 0;   // of these: not above 0
  // Of these: their image is where the target runs through itself; within a hundredth of its
  // diagonal, or where its surface winds otherwise than once or not at all.
  std::size_t foldedAtOverlap = 0;
  double least = 0;

  void add(double determinant, bool atOverlap = false);
  void add(const DeterminantFigures& others);
};

// How often the image of the boundary winds about random points in the target that are farther
// from its surface than boundaryError.
struct DegreeFigures {
  std::size_t checked = 0;  // points; none: no point lies so deep
  int least = 0, greatest = 0;
};

// The map that is linear on the tetrahedra between neighbouring voxels: six in each cube of eight
// voxel centres (Kuhn's), where all corners are inside.
struct CellFigures : DeterminantFigures {
  double share = 0;  // of the solid's volume that they fill, in [0, 1]
  // Places where their boundary's image passes through itself (pairs of triangles) or has cells on
  // its inside that it does not wind about just once: their images overlap. -1: not known, as where
  // a cell is folded, or where that image touches itself. None: this map is one-to-one.
  std::int64_t overlaps = -1;
  // All of this by exact signs of the voxels' floats, as they are in the grid map, or map_local.
  std::uint64_t exact = 0;  // signs of cells that took exact arithmetic
  bool local = false;       // it is map_local, which map is rounded from once more
};

struct SelfIntersectionFigures {
  std::size_t pairs = 0;  // of triangles
  Points places;          // the first of them, at most 16, world units
};

// What is proven of the solid as a whole; docs/method.md, "Proofs". Volumes are shares of the
// source's.
struct ProofFigures {
  std::size_t cells = 0;                    // that cover the solid; none: no proof was tried
  std::size_t undecided = 0, negative = 0;  // of these: nothing is known; folded everywhere on them
  double proven = 0;                        // at least: det J has one sign there
  double undecidedShare = 0, negativeShare = 0;  // at most
  bool mirrored = false;                         // that sign is negative
  double least = 0;                              // of |det J| where its sign is proven
  // No point of the boundary is farther from where it should be, fraction of the target's diagonal;
  // 0: not known. Of a source whose parts overlap of what is exposed, as its solid knows that.
  double boundaryError = 0;
  // No two points of the solid go to one: 1 proven, 0 not decided, -1 not asked. Of a solid with
  // one connected surface that does not cross itself.
  int oneToOne = -1;
  // Those cells, the largest first; of the run that proved alone, as a map's file holds none.
  std::vector<ProofCell> negativeCells, undecidedCells;

  // det J has one sign everywhere.
  bool whole() const { return cells > 0 && undecided + negative == 0; }
};

// The solid as it was fitted, with the caps that close it.
struct SolidFigures {
  std::size_t parts = 1;     // not connected with one another
  std::size_t surfaces = 1;  // closed ones that bound it: one of each part and each cavity
  std::size_t caps = 0;
  bool overlaps = false;  // some of these surfaces lies inside others, or inside itself
};

struct Injectivity {
  bool mirrored = false;  // the target is inside out: det J < 0 wherever the map is not folded
  SolidFigures solid;
  ProofFigures proof;
  DeterminantFigures inside;    // random, spread evenly
  DeterminantFigures boundary;  // random points of it, uniform by area
  DeterminantFigures voxels;    // with their centre inside; of a grid, when there is one
  CellFigures cells;            // of that grid
  std::size_t repaired = 0;     // of the voxels: that were folded before
  double outside = 0;           // share of `inside` farther out of the target than boundaryError
  DegreeFigures degree;
  double boundaryError = 0;  // that 99% of it keep, fraction of the target's diagonal
  SelfIntersectionFigures source, target;
};

// Whether something that was found rules out that the map is one-to-one: det J of both signs on a
// connected solid, or a boundary that winds twice, or both ways, about points. What the target does
// to maps that meet it exactly is not asked.
bool notOneToOne(const Injectivity& known);

// What was checked, what was found and what follows, no more than that: plain English, one line.
// Bounds are rounded to the side on which they still hold.
std::string injectivityStatement(const Injectivity& known);

// The short of it, for terminals: "no fold at 20033 points inside, ...".
std::string injectivityLine(const Injectivity& known);

// The figures that are known as facts of a map's file, "one_to_one_inside_checked" and so on, and
// back; what facts do not say stays as it is in `known`, as does what they say out of range.
Facts injectivityFacts(const Injectivity& known);
void readInjectivity(const Facts& facts, Injectivity& known);

// What is proven of a map that was fitted. core: where det J has one sign on whole cells of the
// solid, and how far the boundary is from its target at most. full: that no two points go to one,
// too; see proveMap.
enum class Prove { off, core, full };
constexpr double kProofCells = 8;  // a charge; maps in one piece need 4 to 7

// FitMapSettings::proofCells and those of frames, as settings. more: of their number, in words.
std::vector<Setting> describeProof(Prove* prove, double* cells, const std::string& more = "");

// Proves what it can; see proof/prove.h. full: also that the boundary does not meet itself, which
// takes some ten times as long. Throws what those do.
ProofFigures proveMap(const ComposedMap& map, const BoundaryPair& boundary,
                      const ProofSettings& settings = {}, bool full = false);

// The self-intersections of a mesh that was checked.
SelfIntersectionFigures selfIntersectionFigures(const MeshReport& check);

struct MappedSolid {
  ComposedMap map;
  BoundaryPair boundary;
  // How the map was made and how good it is, as its file says it: version, source, target, method,
  // interpolation, seed, regularization, rank, boundary_error_rms, boundary_error_p99,
  // boundary_error_max, boundary_error_samples, boundary_error_p99_bound, boundary_error_bound,
  // boundary_error_confidence, boundary_error_smooth_bound, c_error, and boundary_error_triangles
  // or boundary_error_vertices_max, and distance, radius_ratio, tolerance, tolerance_reached,
  // tolerance_met where they apply; those of injectivityFacts.
  Facts facts;
  // As far as points tell; what grids tell, evaluateOnGrid adds.
  Injectivity injectivity;

  const Solid& solid() const { return boundary.solid(); }
};

// One step of a map in steps.
struct MapStep {
  double from = 0, to = 0;  // the part of the way that it goes, in [0, 1]
  std::size_t sources = 0;
  double error = 0;   // its own, at 99% of its boundary, fraction of its target's diagonal
  double folded = 0;  // share of the points inside that it folds
};

// The map's file: one PLY, see field_file.h. Throws FileError when it cannot be written; it appears
// whole or not at all.
void writeMap(const std::string& path, const MappedSolid& mapped);

// Reads it and makes the solid again. Throws FileError for what is not the file of a map with its
// boundary, DataError as makeBoundaryPair does, Cancelled.
MappedSolid readMap(const std::string& path);

// What a map's file claims to be proven, proven again from what the file holds: its charges, its
// mesh and where that goes. The file's figures are not believed; they say what is to be shown. Then
// a random sample is looked at in another way, with plain sums and intervals; proof.md has both.

// unshown: neither that it holds nor that it does not.
enum class ClaimResult { holds, fails, unshown };
std::string wordOf(ClaimResult result);  // "holds", "fails", "cannot be shown"

struct Claim {
  // form: the facts are such as fits write them; sense: where det J has one sign; undecided: where
  // that may be otherwise; folded: that it is somewhere; least: of |det J|; boundary: its error;
  // preimages: what follows; one-to-one: no two points go to one; agreement: of both ways, on the
  // sample.
  std::string name;
  ClaimResult result = ClaimResult::unshown;
  std::string claimed, found;  // each half a sentence
  Points places;               // where it fails; world units of the source, at most 16
};

struct VerifySettings {
  // Cells for each charge that are looked at, at most: fewer first, and four times as many as long
  // as a claim is not reached. See ProofSettings::cellsPerCharge.
  double proofCells = 100;
  std::uint64_t sample = 64;  // cells, and triangles of the boundary, that are drawn; from 0 to 1e6
  std::uint64_t seed = 1;
};

std::vector<Setting> describe(VerifySettings& settings);

struct Verification {
  std::vector<Claim> claims;  // none: nothing is claimed to be proven
  ProofFigures claimed;       // as the file says it, and as it came out here
  ProofFigures found;

  bool holds() const;  // each claim
};

// A claim that is weaker than what is shown holds; figures are compared to nine digits. Throws as
// proveMap does.
Verification verifyMap(const MappedSolid& mapped, const VerifySettings& settings = {});

// Need in bytes of verifyMap, an upper bound.
std::uint64_t verifyMemory(const MappedSolid& mapped, const VerifySettings& settings);

// How accurate sums of charges have to be, a fraction of the target's diagonal, in [1e-9, 1e-5]:
// well below the map's own error as its facts state that.
double sumAccuracy(const MappedSolid& mapped);

// The same for a map whose boundary error has that root mean square.
double sumAccuracy(double boundaryErrorRms);

}  // namespace innermap
