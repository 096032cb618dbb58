// Proofs about maps: where a map keeps its sense on whole cells of its solid, and how far its
// boundary can be from its target anywhere.
//
// A map is known by finitely many numbers, so these are theorems, not samples. On a cell about c,
// |x - c| <= r, each step is expanded in solid harmonics, f(c + x) = sum_n u_n(x), with
// coefficients L_n in Schmidt's basis up to order P. With B = J(c)^-1, H(x) the part of J that is
// linear in x, and d_j the distances of the charges w_j from c, rho_j = r / d_j,
//
//   S = max over the cell's corners x of |B H(x)| + sum_{n=3..P} n r^(n-1) |B L_n|
//     + |B| sum_j |w_j| / d_j^2 rho_j^P ((P+1) - P rho_j) / (1 - rho_j)^2
//
// bounds |B J(x) - 1| on the cell. Where S < 1, det J has there the sign of det J(c), |det J| is at
// least |det J(c)| (1 - S)^3, and f is one-to-one on the cell. Cells are split until S <= 0.8.
// Derivation, literature, and what follows for the whole solid: docs/method.md, "Proofs".
//
// Rounding: S has a part of 1e-12 |B| times the sum of the absolute values of all terms of J, and
// as much again for each 8,000 charges. That is above what summing the terms, one after the other,
// and moving their expansions through all levels can lose. Cells overlap by 1e-12 of the solid;
// sums of a few terms have margins of 1e-9. Compiled without -ffast-math.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "innermap/core/setting.h"
#include "innermap/core/vec3.h"
#include "innermap/field/harmonic_field.h"
#include "innermap/mesh/mesh.h"

namespace innermap {

namespace proof {
class StepTrees;
}

// A map and its expansions, which take as long to make as some 4 cells a charge take to decide.
// Proofs make them where they are first asked for, and proofs of one object share them; copies too.
class ExpandedMap {
 public:
  ExpandedMap(ComposedMap map);  // implicit: one proof alone needs no more than the map
  ExpandedMap(HarmonicMap map);

  const ComposedMap& map() const { return map_; }

  // Of lengths times `scale`, a power of two; the last scale's are kept. Safe from many threads.
  std::shared_ptr<const proof::StepTrees> expansions(double scale) const;

 private:
  struct Kept;
  ComposedMap map_;
  std::shared_ptr<Kept> kept_;
};

struct ProofSettings {
  // Cells, or pieces of the boundary (of maps in steps twice as many), that are looked at before
  // the rest stays undecided: a count in proportion to the map's charges, never a clock, so that
  // results do not depend on the machine's speed. From 1 to 1e6.
  double cellsPerCharge = 100;
  std::uint64_t leastCells = 50'000;  // that many in any case
  // How near the proven boundary error comes to the largest one that is seen, relative to that;
  // from 1e-3 to 1.
  double errorMargin = 0.02;
  bool keepProven = false;  // the places of proven cells too
  // Of the solid, world units cubed, of which shares are taken; 0: what its mesh encloses. To be
  // given where parts of the mesh overlap, which would count twice; at most what they fill.
  double volume = 0;
  // proveSense cuts proven cells further until |det J| is at least that on them; see
  // SenseProof::weak. Not below 0.
  double least = 0;
};

// Without keepProven, volume and least.
std::vector<Setting> describe(ProofSettings& settings);

// Need in bytes of proveSense or proveBoundaryError, about a surface of so many triangles; an upper
// bound.
std::uint64_t proofMemory(const ComposedMap& map, std::size_t triangles,
                          const ProofSettings& settings);

// A cube. World units of the source.
struct ProofCell {
  Vec3 center;
  double halfEdge = 0;
};

struct ProofCells {
  std::size_t count = 0;
  double volume = 0;  // of whole cubes, which reach out of the solid beside its surface
  double share = 0;   // of the solid's volume, at most: the cubes' volume over that, in [0, 1]
  std::vector<ProofCell> places;  // largest first
};

// What is known of the sign of det J on each cell of a solid. Cells that hold no point of it are
// left out. Of a map in steps each step's sign is meant, on the image of the cell under those
// before; a product of two folded steps is no proof.
struct SenseProof {
  ProofCells proven;       // det J has the map's sign everywhere on them; places if asked for
  ProofCells negative;     // the other sign everywhere: folded
  ProofCells undecided;    // neither, at the limit
  double provenShare = 0;  // of the solid's volume, at least
  bool mirrored = false;   // the map's sign, that of the greater volume, is negative
  double least = 0;        // lower bound of |det J| on the proven cells; 0 where there is none
  // Parts of proven cells where |det J| is not shown to be ProofSettings::least, and the share of
  // the solid's volume where it is, at least.
  ProofCells weak;
  double leastShare = 0;
  std::uint64_t examined = 0;  // cells, of all sizes

  // det J has one sign on the closed solid.
  bool whole() const { return proven.count > 0 && negative.count + undecided.count == 0; }
};

// solid: closed, outward oriented, in the map's world units; as it was fitted, with caps. A charge
// inside it or on it leaves its cells undecided, and so does det J = 0. On all threads, the same
// result for any number of them. Throws DataError for a mesh that is not closed, without volume or
// not finite, and for more than 64 steps; SettingError; MemoryError; Cancelled.
SenseProof proveSense(const ExpandedMap& map, const Mesh& solid,
                      const ProofSettings& settings = {});

// How far the map's boundary is from its target, proven: no point of any triangle is farther from
// where the target's affine map of that triangle takes it. Fractions of the target's diagonal.
struct BoundaryProof {
  double error = 0;            // none is larger; infinity where nothing could be bounded
  double seen = 0;             // the largest that was evaluated
  Vec3 seenAt;                 // there, world units of the source
  Vec3 seenTo;                 // where its target is, world units of the target
  bool close = false;          // error <= (1 + errorMargin) seen
  std::uint64_t examined = 0;  // pieces of triangles
};

// By branch and bound. target: #vertices of `surface`, where its vertices go; `surface` need not be
// closed. An error below 1e-11 counts as close. On all threads, the same result for any number of
// them. Throws DataError when the numbers of vertices differ, there is no triangle, or a number is
// not finite; SettingError; MemoryError; Cancelled.
BoundaryProof proveBoundaryError(const ExpandedMap& map, const Mesh& surface, const Points& target,
                                 const ProofSettings& settings = {});

// Whether the map takes no two points of a surface to one: then it is a homeomorphism of the
// surface onto its image; and of a whole connected solid onto its own, where that has this surface
// as its connected boundary and proveSense() finds one sign (Meisters and Olech 1963).
struct EmbeddingProof {
  bool proven = false;
  bool connected = false;      // the surface is one piece, joined by edges of two triangles
  std::size_t undecided = 0;   // pairs of patches that may meet, where their number was up
  Points places;               // of the first of them, at most 16; world units of the source
  std::uint64_t examined = 0;  // pairs
};

// Each pair of patches either lies in one box on which the map is one-to-one, or has images apart;
// else it is split. Looks at up to four times the pairs that settings has cells, shared among the
// map's steps. On all threads, the same result for any number of them. Throws as
// proveBoundaryError().
EmbeddingProof proveEmbedding(const ExpandedMap& map, const Mesh& surface,
                              const ProofSettings& settings = {});

}  // namespace innermap
