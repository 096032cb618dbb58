#include <gtest/gtest.h>

#include <cmath>

#include "core/expect.h"
#include "innermap/tetra/cells.h"
#include "tetra/kuhn_mesh.h"

namespace innermap {
namespace {

using Overlap = CellProof::Overlap;

CellMesh moved(CellMesh mesh, const Vec3& way, double scale = 1) {
  for (Vec3& v : mesh.vertices) v = scale * v + way;
  return mesh;
}

CellMesh together(CellMesh a, const CellMesh& b) {
  const int first = static_cast<int>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (Tetrahedron t : b.tetrahedra) {
    for (int& v : t) v += first;
    a.tetrahedra.push_back(t);
  }
  return a;
}

// A bar of cubes bent about the z axis, so many times round, rising a little.
CellMesh bent(double turns, double rise) {
  CellMesh bar = test::kuhnMesh(40, [](const Vec3& p) { return p.y < 0.1 && p.z < 0.1; });
  for (Vec3& v : bar.vertices) {
    const double angle = 2 * M_PI * turns * v.x, r = 0.3 - v.y;
    v = {r * std::cos(angle), r * std::sin(angle), v.z + rise * v.x};
  }
  return bar;
}

void expectOverlap(Overlap wanted, const CellMesh& mesh, const char* what) {
  for (const double scale : {1e-9, 1.0, 1e9})
    for (const Vec3& way : {Vec3{0, 0, 0}, Vec3{300, -70, 11}}) {
      const CellProof proof = proveCells(moved(mesh, scale * way, scale));
      ASSERT_TRUE(proof.rightSideOut()) << what << scale << way.x;
      ASSERT_EQ(proof.overlap, wanted) << what << scale << way.x;
      ASSERT_EQ(proof.oneToOne(), wanted == Overlap::none) << what;
    }
}

TEST(ProveCells, CubesAndRingsTile) {
  expectOverlap(Overlap::none, test::kuhnMesh(3), "cube");
  expectOverlap(Overlap::none, bent(0.95, 0), "open ring");
  expectOverlap(Overlap::none, bent(1.4, 0.5), "helix");
  const auto shell = [](const Vec3& p) {
    return std::max({std::abs(p.x - 0.5), std::abs(p.y - 0.5), std::abs(p.z - 0.5)}) > 0.2;
  };
  expectOverlap(Overlap::none, test::kuhnMesh(5, shell), "shell");
  // Two cubes that touch in one vertex, and two that do along an edge.
  const auto pinched = [](const Vec3& p) {
    return (p.x < 0.5) == (p.y < 0.5) && (p.x < 0.5) == (p.z < 0.5);
  };
  expectOverlap(Overlap::none, test::kuhnMesh(2, pinched), "corner");
  const auto hinged = [](const Vec3& p) { return (p.x < 0.5) == (p.y < 0.5); };
  expectOverlap(Overlap::none, test::kuhnMesh(2, hinged), "edge");
  expectOverlap(Overlap::none,
                together(test::kuhnMesh(2), moved(test::kuhnMesh(2), {1.5, 0.2, 0.1})), "two");
}

// All cells are right side out in each of these.
TEST(ProveCells, WhatOverlapsIsNotOneToOne) {
  const CellMesh cube = test::kuhnMesh(2);
  expectOverlap(Overlap::some, together(cube, moved(cube, {0.31, 0.23, 0.17})), "crossing");
  expectOverlap(Overlap::some, together(cube, moved(cube, {0.31, 0.23, 0.17}, 0.1)), "inside");
  expectOverlap(Overlap::some, bent(1.4, 0.003), "closed ring");
}

TEST(ProveCells, WhatTouchesIsNotShown) {
  const CellMesh cube = test::kuhnMesh(2);
  expectOverlap(Overlap::unknown, together(cube, moved(cube, {1, 0, 0})), "face on face");
  expectOverlap(Overlap::unknown, together(cube, cube), "the same twice");
  CellMesh twice = cube;  // its faces belong to four cells each, or to two on one side
  twice.tetrahedra.insert(twice.tetrahedra.end(), cube.tetrahedra.begin(), cube.tetrahedra.end());
  expectOverlap(Overlap::unknown, twice, "cells twice");
  expectOverlap(Overlap::unknown,
                {.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.3, 0.3, 2}},
                 .tetrahedra = {{0, 1, 2, 3}, {0, 1, 2, 4}}},
                "both on one side");
}

// Cells about an edge that go round it twice: each is right side out, each inner face has two
// sides, and no vertex tells.
TEST(ProveCells, TwiceAboutAnEdgeOverlaps) {
  CellMesh mesh{.vertices = {{0, 0, -1}, {0, 0, 1}}};
  constexpr int kCells = 14;
  for (int k = 0; k < kCells; ++k) {
    const double angle = 4 * M_PI * (k + 0.1) / kCells, r = 1 + 0.05 * k;
    mesh.vertices.push_back({r * std::cos(angle), r * std::sin(angle), 0.01 * k});
  }
  for (int k = 0; k < kCells; ++k) mesh.tetrahedra.push_back({0, 1, 2 + k, 2 + (k + 1) % kCells});
  for (Tetrahedron& t : mesh.tetrahedra)
    if (signedVolume(mesh.vertices, t) < 0) std::swap(t[0], t[1]);
  const CellProof proof = proveCells(mesh);
  EXPECT_TRUE(proof.rightSideOut());
  EXPECT_EQ(proof.overlap, Overlap::some);
}

TEST(ProveCells, CountsInvertedFlatAndHexahedra) {
  CellMesh mesh = test::kuhnMesh(2);
  std::swap(mesh.tetrahedra[3][0], mesh.tetrahedra[3][1]);
  CellProof proof = proveCells(mesh);
  EXPECT_EQ(proof.inverted, 1u);
  EXPECT_FALSE(proof.rightSideOut());
  mesh = test::kuhnMesh(1);
  for (Vec3& v : mesh.vertices) v.z *= 0;
  EXPECT_EQ(proveCells(mesh).inverted, 6u);
  proof = proveCells(test::cubeMesh(2));
  EXPECT_TRUE(proof.rightSideOut());
  EXPECT_EQ(proof.overlap, Overlap::unknown);
  EXPECT_FALSE(proof.oneToOne());
  EXPECT_FALSE(proveCells({}).rightSideOut());
}

TEST(ProveCells, SentencesSayNoMoreThanIsProven) {
  CellProof proof{.cells = 5};
  EXPECT_NE(statementOf(proof).find("local"), std::string::npos);
  EXPECT_EQ(linearMapStatement(proof, proof), "");  // hexahedra
  proof.boundary = {{0, 1, 2}};
  EXPECT_NE(linearMapStatement(proof, proof).find("not proven"), std::string::npos);
  proof.overlap = Overlap::none;
  EXPECT_EQ(statementOf(proof).find("local"), std::string::npos);
  EXPECT_NE(linearMapStatement(proof, proof).find("globally."), std::string::npos);
  CellProof some = proof;
  some.overlap = Overlap::some;
  EXPECT_NE(statementOf(some).find("some overlap"), std::string::npos);
  EXPECT_EQ(linearMapStatement(some, proof).find("globally."), std::string::npos);
  some.undecided = 1;
  EXPECT_EQ(statementOf(some).find("roven"), std::string::npos);
  EXPECT_EQ(linearMapStatement(proof, some), "");
}

TEST(ProveCells, SameForAnyNumberOfThreadsAndCancels) {
  const CellMesh mesh = bent(1.4, 0.003);
  test::expectSameForThreads([&] { return proveCells(mesh).meetings; });
  test::expectCancels([&] { proveCells(mesh); });
}

}  // namespace
}  // namespace innermap
