// Landmarks: pairs of places on two surfaces that a correspondence must keep.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "innermap/boundary/laid_out_mesh.h"

namespace innermap {

struct LandmarkPlace {
  std::optional<int> vertex;  // of the mesh, from 0
  Vec3 point;                 // world units, when there is no vertex
};

struct LandmarkPair {
  LandmarkPlace onA, onB;
  std::size_t line = 0;  // of the file, from 1; 0: from no file, messages then count the pairs
};

struct LandmarkList {
  std::string name = "landmarks";  // the file, or what messages should call the list
  std::vector<LandmarkPair> pairs;
};

// The file's format, in words for users.
extern const char kLandmarkFormat[];

// Throws FileError with the line for what is no pair of places, also for a file without any.
LandmarkList readLandmarks(const std::string& path);

struct PlacedLandmarks {
  std::vector<Landmark> landmarks;  // #pairs
  std::string note;  // that points on A were taken as the nearest vertices; empty: none was
  bool far = false;  // one of them by more than 0.02 of the diagonal, so the note is a warning
};

// Finds the places on the surfaces. A point on A becomes A's nearest vertex. Throws FileError with
// the name and the line for vertices out of range or that no shell uses, points farther than 0.001
// of the diagonal from the surface, places that are given twice.
PlacedLandmarks placeLandmarks(const LandmarkList& list, const LaidOutMesh& a,
                               const LaidOutMesh& b);

}  // namespace innermap
