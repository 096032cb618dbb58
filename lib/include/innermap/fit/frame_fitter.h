// Maps of one rest pose onto many frames: charges and boundary points are placed and factored once;
// each frame is one right-hand side.
//
// All frames of a fitter have the same charges, so their fields can be combined weight by weight:
// velocities are such combinations, harmonic fields themselves.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "innermap/core/setting.h"
#include "innermap/field/fit.h"
#include "innermap/field/harmonic_field.h"
#include "innermap/fit/boundary_pair.h"
#include "innermap/fit/mapped_solid.h"
#include "innermap/solve/solver.h"

namespace innermap {

class CrossingLines;

struct FrameFitterSettings {
  std::size_t sources = 8000;      // charges, the same for all frames
  std::size_t collocation = 0;     // boundary points, at least sources + 4; 0: 3 a source
  std::optional<double> distance;  // at most 4 spacings for over kMostDenseSources charges
  std::uint64_t seed = 1;
  Prove prove = Prove::off;         // of each frame's map
  double proofCells = kProofCells;  // as in FitMapSettings
};

// Without prove and proofCells; see describeProof.
std::vector<Setting> describe(FrameFitterSettings& settings);

// Boundary points of these settings: `collocation`, or its default.
std::size_t frameCollocation(const FrameFitterSettings& settings);

// Peak need in bytes of setting up and solving, and then of what else a frame takes: `others`.
std::uint64_t frameFitterMemory(const FrameFitterSettings& settings, std::uint64_t others = 0);

// The map of one frame as it is solved for, not measured.
struct FrameSolution {
  TargetBoundary boundary;
  HarmonicField field;
  int iterations = 0;
  double residual = 0;   // root mean square at the boundary points, world units of the frame
  StageSeconds seconds;  // "solid", "solve"
};

// The map of one frame.
constexpr double kLeastJumpTold = 1e-3;  // fraction of the frame's diagonal

struct FrameFit {
  TargetBoundary boundary;
  HarmonicField field;
  BoundaryError error;  // by certify, fractions of the frame's diagonal
  // As of a map of its own, of some thousand points inside; with Prove::off `mirrored`, `inside`
  // and `outside` alone.
  Injectivity injectivity;
  double folded() const;  // share of these points whose Jacobian determinant is not above 0
  int iterations = 0;
  // Where exposed parts cross and slide along each other by more than kLeastJumpTold, and
  // how far, in words; empty where none do. The charges stand where they stand, so the fit blends
  // there.
  std::string jumps;
  std::vector<std::string> warnings;
  StageSeconds seconds;  // "solid", "solve", "certificate", "inside", "check", "proof"
};

// Immutable once made; safe from any number of threads.
class FrameFitter {
 public:
  // Places charges and points, factors. Throws SettingError, DataError (no room for charges),
  // MemoryError, Cancelled.
  FrameFitter(SourceBoundary rest, const FrameFitterSettings& settings = {});

  const SourceBoundary& rest() const { return rest_; }
  const Solid& solid() const { return rest_.solid; }
  const Points& sources() const { return solver_->sources(); }
  std::size_t collocation() const { return collocation_.points.size(); }
  bool iterative() const { return levels_ > 1; }  // else dense
  double distance() const { return distance_; }   // of the finest charges, of the diagonal
  const StageSeconds& seconds() const { return seconds_; }  // "sample", "factor"

  // What a frame gives depends on the rest pose, the settings and the frame alone, not on which
  // frames came before. frame: of the rest pose's connectivity. Throws DataError for a frame that
  // cannot be used, as makeTargetBoundary does; Cancelled.
  FrameFit fit(const Mesh& frame) const;

  // The same field, at a tenth of the time. Throws alike.
  FrameSolution solve(const Mesh& frame) const;

 private:
  // Points of the boundary that move with it.
  struct Samples {
    Points points;                        // world units of the rest pose
    std::vector<SurfacePoint> onSurface;  // of solid().surface()
  };
  Samples samplesAt(std::vector<SurfacePoint> onSurface) const;
  BoundaryPair pairOf(const Mesh& frame, const TargetBoundary& boundary) const;
  void examine(const Mesh& frame, FrameFit& fit) const;

  SourceBoundary rest_;
  FrameFitterSettings settings_;
  Samples collocation_;
  Points inside_;
  std::shared_ptr<const CrossingLines> lines_;
  std::optional<IterativeSolver> solver_;
  std::size_t levels_ = 0;
  double distance_ = 0;
  StageSeconds seconds_;
};

// A frame's fit and its number in the animation.
struct NumberedFit {
  const FrameFit* fit = nullptr;
  std::int64_t number = 0;
};

// How the inside moves at a frame, world units of the targets per second, as a field over the rest
// pose: the derivative of the parabola through the frame and one before and one after it, at their
// numbers, or, where one of these is missing, of the line to the other. All fits: of one fitter.
// framesPerSecond: positive. Throws DataError when both are missing.
HarmonicField velocityAt(const NumberedFit& frame, const std::optional<NumberedFit>& before,
                         const std::optional<NumberedFit>& after, double framesPerSecond);

// The fits of an animation's frames as they are asked for, in ascending order: each is made once,
// and kept while velocities may need it.
class FrameFits {
 public:
  // numbers: of the frames, ascending. make: the fit of the frame at a place in `numbers`; throws
  // FileError or DataError for a frame that cannot be used. All fits: of one fitter.
  FrameFits(std::vector<std::int64_t> numbers, std::function<FrameFit(std::size_t)> make);

  // Throws what `make` throws.
  std::shared_ptr<const FrameFit> at(std::size_t index);

  // velocityAt this frame, from the nearest before and after it that can be used. Throws DataError
  // when there is neither, what `make` throws for this one.
  HarmonicField velocity(std::size_t index, double framesPerSecond);

 private:
  std::shared_ptr<const FrameFit> tryAt(std::size_t index);  // none for a broken frame
  std::optional<NumberedFit> neighbour(std::size_t index, int step);

  std::vector<std::int64_t> numbers_;
  std::function<FrameFit(std::size_t)> make_;
  std::map<std::size_t, std::shared_ptr<const FrameFit>> kept_;  // null: broken
};

}  // namespace innermap
