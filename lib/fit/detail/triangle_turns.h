// Rotations along a surface as vectors that blend: neighbours' logarithms on one branch.
//
// A rotation has many logarithms, axis times (angle + 2 pi q). With the shortest of each,
// neighbours near half a turn take opposite ones, and what is blended between turns both ways at
// once. Here each triangle takes the one nearest to that of the neighbour it was reached from, over
// a spanning tree that crosses the least differences first, from the triangle that turns least. The
// aim is that of the "as consistent as possible" rotations in Gao, Lai, Yang, Zhang, Xia and
// Kobbelt, "Sparse data driven mesh deformation" (IEEE TVCG 27, 2021), who solve for all at once.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "innermap/mesh/mesh.h"

namespace innermap {

// Axis times angle of each triangle's rotation. Triangles that share an edge are neighbours; those
// without a rotation (`known` false) join none and get zero. All arrays: #triangles.
std::vector<Eigen::Vector3d> turnsOf(const std::vector<Triangle>& triangles,
                                     const std::vector<Eigen::Matrix3d>& rotations,
                                     const std::vector<bool>& known);

}  // namespace innermap
