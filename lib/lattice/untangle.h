// Tetrahedra that are inside out, turned right by moving their vertices.
//
// Garanzha, Kaporin, Kudryavtseva, Protais, Ray and Sokolov, "Foldover-free maps in 50 lines of
// code" (ACM TOG 40(4), 2021): an energy that is finite for folded elements too, and the more it
// rises there the nearer it comes to its end; minimised by L-BFGS (liblbfgs).
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "innermap/core/vec3.h"

namespace innermap {

// Adds stiffness * (normal . (x - place))^2 to the energy, normal of length 1; with a normal of
// zeros stiffness * |x - place|^2.
struct Spring {
  int vertex = 0;
  Vec3 place, normal;
  double stiffness = 0;  // not negative
};

struct TetPatch {
  Points vertices;                       // #V: where they are now
  std::vector<char> free;                // #V: may be moved
  std::vector<std::array<int, 4>> tets;  // #T
  // #T: J is the matrix of a tetrahedron's edges from its first vertex, as columns, times this.
  // Scaled so that the determinants of J are about 1, and vertices to edges of about 1.
  std::vector<Mat3> rest;
  std::vector<Spring> springs;  // of any of the vertices
  std::vector<double> weights;  // #T: what each counts, over 0; empty: 1 each
};

struct UntangleSettings {
  double volumeShare = 0.5;  // theta: of the volumes' part of the energy, over 0
  int rounds = 20;           // at most, over 0; in each the regularisation stays as it is
  int stepsARound = 50;      // at most, over 0
  // How fast eps falls at least, the paper's sigma, in [0, 1): with its 0.1 patches that can be
  // repaired take three times the rounds.
  double leastSigma = 0.5;
  // A round ends when three steps lower the energy by less than this share of it; 0: not so.
  double leastStepGain = 0;
  // Where no determinant is negative none becomes so: no regularisation in the first round either.
  bool keep = false;
  // Called after each round, with its number from 0: may change the springs' places, normals and
  // stiffness, and the weights.
  std::function<void(TetPatch& patch, int round)> afterRound;
};

// The inverse of the matrix of a tetrahedron's edges from its first vertex: what `rest` holds, but
// for the scale. Entries that are not finite where its volume is 0.
Mat3 inverseEdges(const std::array<Vec3, 4>& corners);

// Of one tetrahedron, by its corners and its `rest`.
Mat3 jacobianOf(const std::array<Vec3, 4>& corners, const Mat3& rest);
Mat3 jacobianOf(const TetPatch& patch, std::size_t tet);

// Moves the free vertices until no determinant is negative and nothing is to be gained, or the
// rounds are over. Minimises
//   sum over tetrahedra of their weight times |J|^2 / chi^(2/3) + theta (1 + D^2) / chi,  D = det
//   J, chi = (D + sqrt(D^2 + eps^2)) / 2,
// and the springs, with eps falling from round to round. Returns the least determinant.
// Deterministic. Throws Cancelled, std::bad_alloc.
double untangle(TetPatch& patch, const UntangleSettings& settings = {});

}  // namespace innermap
