// The grids that innermap works with, of nine value types. Their classes are instantiated once for
// the whole project, by instantiate.cc.in, and declared here for all other files: a compiler spends
// minutes on them in each file that names a few grids otherwise.
//
// Part of the precompiled header; no source includes it by itself, and it is not installed.
#pragma once

#include <openvdb/openvdb.h>

// PREFIX: extern, or nothing. Not the root: openvdb::tree::RootNode has a member that compiles only
// as long as nobody calls it. Not accessors of constant trees, for the same reason.
#define INNERMAP_INSTANTIATE_GRID(PREFIX, TREE)                                      \
  PREFIX template class openvdb::tree::LeafNode<openvdb::TREE::BuildType, 3>;        \
  PREFIX template class openvdb::tree::InternalNode<openvdb::TREE::LeafNodeType, 4>; \
  PREFIX template class openvdb::tree::InternalNode<                                 \
      openvdb::tree::InternalNode<openvdb::TREE::LeafNodeType, 4>, 5>;               \
  PREFIX template class openvdb::tree::Tree<openvdb::TREE::RootNodeType>;            \
  PREFIX template class openvdb::tree::ValueAccessor3<openvdb::TREE, true, 0, 1, 2>; \
  PREFIX template class openvdb::Grid<openvdb::TREE>;

#ifndef INNERMAP_DEFINES_GRIDS
INNERMAP_INSTANTIATE_GRID(extern, FloatTree)
INNERMAP_INSTANTIATE_GRID(extern, DoubleTree)
INNERMAP_INSTANTIATE_GRID(extern, Int32Tree)
INNERMAP_INSTANTIATE_GRID(extern, Int64Tree)
INNERMAP_INSTANTIATE_GRID(extern, BoolTree)
INNERMAP_INSTANTIATE_GRID(extern, MaskTree)
INNERMAP_INSTANTIATE_GRID(extern, Vec3STree)
INNERMAP_INSTANTIATE_GRID(extern, Vec3DTree)
INNERMAP_INSTANTIATE_GRID(extern, Vec3ITree)
#endif
