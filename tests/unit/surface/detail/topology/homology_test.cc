#include "surface/detail/topology/homology.h"

#include <gtest/gtest.h>

#include <set>

#include "surface/detail/topology/knot.h"
#include "surface/detail/topology/linking.h"
#include "surface/detail/topology/meridians.h"
#include "surface/handle_shapes.h"

namespace innermap {
namespace {

using shapes::boundaryOf;
using shapes::plate;

TEST(HomologyBasis, LoopsAreSimpleAndTheFormsDual) {
  for (const int genus : {0, 1, 2, 5}) {
    SCOPED_TRACE(genus);
    const ClosedSurface surface = genus ? plate(genus) : shapes::closed(shapes::icosphere(2), 0);
    const HalfEdges edges(surface.triangles);
    const HomologyBasis basis = homologyBasis(surface, edges);
    ASSERT_EQ(basis.size(), static_cast<std::size_t>(2 * genus));
    for (std::size_t i = 0; i < basis.size(); ++i) {
      const Loop& loop = basis.loops[i];
      std::set<int> met;
      for (std::size_t k = 0; k < loop.size(); ++k) {
        EXPECT_EQ(edges.head(loop[k]), edges.tail(loop[(k + 1) % loop.size()]));
        EXPECT_TRUE(met.insert(edges.tail(loop[k])).second);
      }
      Integers unit(basis.size(), 0);
      unit[i] = 1;
      const std::vector<int> form = combinedForm(basis, unit, edges);
      for (int h = 0; h < edges.size(); h += 3) EXPECT_EQ(form[h] + form[h + 1] + form[h + 2], 0);
      for (std::size_t j = 0; j < basis.size(); ++j) {
        int sum = 0;
        for (const int h : basis.loops[j]) sum += form[h];
        EXPECT_EQ(sum, i == j ? 1 : 0);
        EXPECT_EQ(basis.crossings[i][j], -basis.crossings[j][i]);
      }
    }
  }
}

TEST(LeftKernel, SpansAllIntegerSolutions) {
  const IntegerMatrix kernel = leftKernel({{2, 4}, {3, 6}, {0, 0}});
  ASSERT_EQ(kernel.size(), 2u);
  for (const Integers& x : kernel) EXPECT_EQ(2 * x[0] + 3 * x[1], 0);
  // Primitive: the minors' greatest common divisor is 1. (3, -2, 0) and (0, 0, 1) span it.
  const long long minor = kernel[0][0] * kernel[1][2] - kernel[0][2] * kernel[1][0];
  EXPECT_EQ(std::abs(minor), 3);
  EXPECT_TRUE(leftKernel({{1, 0}, {0, 1}}).empty());
}

TEST(GaussIntegral, OfLinkedSquares) {
  const Points a{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  const Points b{{0, 0, -1}, {0, 0, 1}, {3, 0.1, 1}, {3, 0, -1}};
  double sum = 0;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j)
      sum += gaussIntegral(a[i], a[(i + 1) % 4], b[j], b[(j + 1) % 4]);
  EXPECT_NEAR(sum, 1, 1e-12);  // b rises through a, which runs counterclockwise seen from above
}

TEST(LinkingNumbers, DifferByTheCrossings) {
  for (const ClosedSurface& surface :
       {plate(1), plate(3), boundaryOf(shapes::trefoilCells(), 1),
        shapes::tube(shapes::trefoil, 120, 9, 0.3), boundaryOf(shapes::knottedTunnel(), 1)}) {
    const HalfEdges edges(surface.triangles);
    const HomologyBasis basis = homologyBasis(surface, edges);
    const LinkingNumbers linking = linkingNumbers(surface.vertices, edges, basis.loops);
    EXPECT_LT(linking.residual, 1e-9);
    for (std::size_t i = 0; i < basis.size(); ++i)
      for (std::size_t j = 0; j < basis.size(); ++j)
        EXPECT_EQ(linking.matrix[i][j] - linking.matrix[j][i], -basis.crossings[i][j]);
  }
}

TEST(BoundingClasses, HalfOfAllOnEitherSide) {
  for (const int genus : {1, 2, 4}) {
    SCOPED_TRACE(genus);
    const ClosedSurface surface = plate(genus);
    const HalfEdges edges(surface.triangles);
    const HomologyBasis basis = homologyBasis(surface, edges);
    const BoundingClasses classes = boundingClasses(surface, edges, basis);
    ASSERT_EQ(classes.inside.size(), static_cast<std::size_t>(genus));
    ASSERT_EQ(classes.outside.size(), static_cast<std::size_t>(genus));
    for (const Integers& a : classes.inside)
      for (const Integers& b : classes.inside) EXPECT_EQ(crossingNumber(basis, a, b), 0);
    for (const Integers& a : classes.outside)
      for (const Integers& b : classes.outside) EXPECT_EQ(crossingNumber(basis, a, b), 0);
  }
}

TEST(IsKnotted, TellsKnotsFromTangledLoops) {
  Points loop, knot, eight;
  for (int i = 0; i < 200; ++i) {
    const double s = i / 200.0, u = 2 * kPi * s;
    // Winds seven times around a circle's tube and once along it: not knotted.
    const double r = 2 + std::cos(7 * u);
    loop.push_back({r * std::cos(u), r * std::sin(u), std::sin(7 * u)});
    knot.push_back(shapes::trefoil(s));
    const double q = 2 + std::cos(2 * u);
    eight.push_back({q * std::cos(3 * u), q * std::sin(3 * u), std::sin(4 * u)});
  }
  EXPECT_FALSE(isKnotted(loop));
  EXPECT_TRUE(isKnotted(knot));
  EXPECT_TRUE(isKnotted(eight));
  EXPECT_FALSE(isKnotted({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
  EXPECT_FALSE(isKnotted({}));
}

}  // namespace
}  // namespace innermap
