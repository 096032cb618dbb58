// A basis of the loops of a closed surface, and how loops cross.
//
// Tree and cotree (Eppstein, "Dynamic generators of topologically embedded graphs", SODA 2003) of
// short loops (Erickson, Whittlesey, "Greedy optimal homotopy and homology generators", SODA 2005).
#pragma once

#include <vector>

#include "innermap/surface/correspond.h"
#include "surface/detail/topology/half_edges.h"

namespace innermap {

// Half-edges, each beginning where the one before ends, the last ending where the first begins.
using Loop = std::vector<int>;
using Integers = std::vector<long long>;
using IntegerMatrix = std::vector<Integers>;  // rows

struct HomologyBasis {
  std::vector<Loop> loops;  // 2 genus, none through a vertex twice

  // Closed one-forms: form i is 1 on these half-edges, -1 on their opposites, 0 on all others. It
  // sums to 0 around each triangle, to 1 along loop i, to 0 along the others.
  std::vector<std::vector<int>> forms;

  // crossings[i][j]: how often loop j crosses loop i from right to left, less the other way.
  IntegerMatrix crossings;

  std::size_t size() const { return loops.size(); }
};

// Near linear in the number of triangles for few handles.
HomologyBasis homologyBasis(const ClosedSurface& surface, const HalfEdges& edges);

// sum_i coefficients[i] form_i, for each half-edge.
std::vector<int> combinedForm(const HomologyBasis& basis, const Integers& coefficients,
                              const HalfEdges& edges);

// a^T crossings b: crossings of loops of these classes.
long long crossingNumber(const HomologyBasis& basis, const Integers& a, const Integers& b);

// Rows that span, over the integers, all x with x^T m = 0.
IntegerMatrix leftKernel(const IntegerMatrix& m);

}  // namespace innermap
