// A solid's boundary where the steps of a map have carried it so far: what the next step starts
// from. Its points are images of the source's, not points of a mesh between those of vertices.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "fit/detail/refined_surface.h"
#include "innermap/field/harmonic_field.h"
#include "innermap/fit/surface_problem.h"
#include "innermap/levelset/solid.h"

namespace innermap {

struct CarriedSettings {
  double accuracy = 1e-7;  // of the sums, world units
  double chord = 1e-3;     // of the mesh about the present solid, world units; see refine
  std::uint64_t seed = 1;
};

// The way also brings points back to where `from`, positions of the source's vertices, has them: to
// within `kept`, by `most` at most, and the less the nearer they are to being `far` off. World
// units.
struct Mending {
  Points from;
  double kept = 0, most = 0, far = std::numeric_limits<double>::infinity();
};

class CarriedBoundary {
 public:
  CarriedBoundary(const Solid& source, const CarriedSettings& settings);

  const std::vector<HarmonicMap>& steps() const { return steps_; }
  // About the present solid, closed.
  const Mesh& mesh() const { return solid_.repaired().mesh; }

  // Triangles of its outer surface over those of the mesh: 1 where the mesh does not run through
  // itself. Each crossing cuts triangles into pieces; parts that are buried in it count for less.
  double pieces() const;

  // One step further; after the last one there is no problem any more. Throws DataError when what
  // is left has no inside, Cancelled.
  void advance(const HarmonicMap& step, bool last);

  // Each point of the boundary goes from where it is by its way: fitted where it is not buried in
  // other parts now, measured everywhere. ways: of the vertices of source.repaired().mesh, linear
  // between them; mending adds to these. unit: what errors are fractions of. Holds a reference to
  // this.
  //
  // Errors are measured at exact images. Points to fit to need not be, where later steps mend what
  // that leaves: those of the bent mesh are a fiftieth of the chord off in the median, a fifth at
  // 99%, and exact ones through all steps so far took three tenths of a way of 18 steps.
  AdaptiveProblem problem(const Points& ways, double unit,
                          const std::optional<Mending>& mending = {}, bool exact = true);

  // Distances from where `shape`, positions of those vertices, has them: at the points of
  // freshSamples, fractions of the unit.
  BoundaryError errorFrom(const Points& shape, double unit);

 private:
  // Random places, the same at each step.
  struct Draw {
    std::vector<SurfacePoint> places;  // on the source's repaired mesh
    Points now;                        // where they are after so many steps
    std::size_t steps = 0;
  };

  Points carried(Points points, std::size_t firstStep) const;
  // Of places on solid_.surface(). Where not exact, those of the bent mesh, but for triangles whose
  // edges are farther off than the chord allows.
  Points imagesOf(const std::vector<SurfacePoint>& places, bool exact) const;
  Points known(const Points& charges, double distance) const;
  std::vector<std::size_t> nearImages(const Points& charges, double than) const;
  void carrySurface();  // by the last step
  // Random places on the source's repaired mesh, uniform by its area; those of draw 0 are
  // freshSamples'.
  std::vector<SurfacePoint> placesOf(std::size_t count, std::uint64_t draw) const;
  const Draw& drawn(std::size_t count, std::uint64_t draw);
  Points onSource(const Points& vertices, const std::vector<SurfacePoint>& places) const;

  const Solid& source_;
  const CarriedSettings settings_;
  std::vector<HarmonicMap> steps_;
  RefinedSurface surface_;
  EdgeImages edges_;  // of surface_, now
  Points vertices_;   // of surface_, now
  Solid solid_;       // that these bound
  // By count and number. A step goes on from where the one before has taken them: carried all the
  // way each time they cost more than the fits.
  std::map<std::pair<std::size_t, std::uint64_t>, Draw> draws_;
};

}  // namespace innermap
