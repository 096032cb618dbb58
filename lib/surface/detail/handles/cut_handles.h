// A surface with handles cut open along meridians and capped, so that what
// works on surfaces without handles works on it.
#pragma once

#include <array>
#include <vector>

#include "innermap/surface/correspond.h"

namespace innermap {

// One meridian, cut. Both sides list the copies of the same vertices in the same order. Side 0 lies
// to the left of the loop, seen from outside the solid.
struct CutHandle {
  std::array<std::vector<int>, 2> loop;  // vertices of the cut surface
  std::array<int, 2> centre{};           // of the caps
};

struct CutSurface {
  // Of genus 0: what was cut, and two fans for each handle.
  ClosedSurface surface;
  std::vector<CutHandle> handles;
  // For each vertex of `surface` the one it is a copy of; -1 of centres and of those put in since.
  std::vector<int> vertexOf;
  // For each triangle the one that it is part of, -1 of caps, and its corners' barycentric
  // coordinates in that.
  std::vector<int> triangleOf;
  std::vector<std::array<std::array<double, 3>, 3>> cornerIn;
};

// Disjoint meridians of a surface, by the numbers of the vertices they pass: as many independent
// ones as handles, each the shortest that meets none before; then more, each of another class of
// loops and the shortest that is left, at most three times as long as those. Any independent ones
// may be cut together.
struct HandleLoops {
  CutSurface uncut;  // without handles yet; triangles in four where edges left no room for loops
  std::vector<std::vector<int>> loops;
  std::vector<std::vector<long long>> classes;  // of each loop, in some basis
  std::size_t handles = 0;
};

// Triangles are cut in four twice at most. Throws DataError, naming the surface, where no system of
// meridians is found: handles that are knotted or linked so that no discs close them, a surface
// that passes through itself; Cancelled.
HandleLoops handleLoops(const ClosedSurface& surface);

// Along the loops chosen (numbers in loops.loops; as many as handles, independent).
CutSurface cutAlong(const HandleLoops& loops, const std::vector<int>& chosen);

// Points to put in on edges of a cut surface.
struct EdgeSplit {
  int from = 0, to = 0;   // an edge
  double fraction = 0.5;  // of the way, in (0, 1)
};

// Splits edges, one after the other (a later split may name an edge that an earlier one made); the
// vertices made have consecutive numbers. A valid layout on the sphere stays one.
void splitEdges(CutSurface& cut, Layout& layout, const std::vector<EdgeSplit>& splits);

// Of a point of a surface laid out on the sphere.
Vec3 placeOnSphere(const ClosedSurface& surface, const Layout& layout, const SurfacePoint& point);

// Points of the surface before the cut on the cut surface. #points.
std::vector<SurfacePoint> onCut(const CutSurface& cut, const std::vector<SurfacePoint>& points);

// Points of the cut surface on the surface before the cut; those of a cap on its rim, away from its
// centre. #points.
std::vector<SurfacePoint> onUncut(const CutSurface& cut, const std::vector<SurfacePoint>& points);

}  // namespace innermap
