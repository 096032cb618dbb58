// Landmark files: pairs of places on two surfaces that a correspondence must keep.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "context.h"
#include "innermap/core/progress.h"
#include "innermap/surface/correspond.h"
#include "surface_input.h"

namespace innermap::tool {

struct LandmarkPlace {
  std::optional<int> vertex;  // of the mesh, from 0
  Vec3 point;                 // world units, when there is no vertex
};

struct LandmarkLine {
  std::size_t line = 0;  // of the file, from 1
  LandmarkPlace onA, onB;
};

// The format, for --help.
extern const char kLandmarkFormat[];

// Throws FileError with the line for what is no pair of places; an empty file is one too.
std::vector<LandmarkLine> readLandmarks(const std::string& path);

// Finds the places on the surfaces. A point on A becomes A's nearest vertex, which is told. Throws
// FileError with the line for numbers out of range, vertices that no shell uses, points farther
// than 0.001 of the diagonal from the surface, places that are given twice.
std::vector<Landmark> placeLandmarks(const std::string& path,
                                     const std::vector<LandmarkLine>& lines, const SurfaceInput& a,
                                     const SurfaceInput& b, Context& context);

}  // namespace innermap::tool
