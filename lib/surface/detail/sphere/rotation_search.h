// Which rotation of one sphere layout fits another best.
#pragma once

#include <cstdint>
#include <vector>

#include "surface/detail/refining/map_samples.h"

namespace innermap {

struct RotationCandidate {
  Mat3 rotation;
  double cost = 0;
};

struct RotationSearchSettings {
  std::size_t rotations = 6000;  // tried, evenly spread (Alexa, "Super-Fibonacci spirals", 2022)
  std::size_t refined = 40;      // of them, the best, by coordinate descent
  std::size_t kept = 3;          // most
  double apart = 0.35;           // radians between those kept, at least
  const Points* targetNormals = nullptr;  // unit, #triangles of the target: normals should agree
  Points from, to;  // unit vectors that should go to one another, of two landmarks each
};

// The best first. Cost: mean of ln^2 s1 + ln^2 s2 of the composed map over the samples, plus with
// targetNormals how far normals disagree, plus with landmarks their squared distances.
std::vector<RotationCandidate> searchRotations(const std::vector<MapSample>& samples,
                                               const TargetMetric& target,
                                               const RotationSearchSettings& settings);

Mat3 rotationAbout(const Vec3& axisTimesAngle);

// The proper rotation R that minimises sum |R a - b|^2 (Kabsch 1976), by Horn's quaternion.
Mat3 bestRotation(const Points& a, const Points& b);

// Root mean square of |R a - b|.
double rotationMisfit(const Mat3& rotation, const Points& a, const Points& b);

}  // namespace innermap
