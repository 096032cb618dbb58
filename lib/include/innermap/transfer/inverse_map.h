// The inverse of a map on the voxels of its target: where each of them comes from.
#pragma once

#include <openvdb/openvdb.h>

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/field/harmonic_field.h"
#include "innermap/levelset/solid.h"
#include "innermap/transfer/carry.h"

namespace innermap {

struct CellMesh;
struct MappedSolid;

// What a map does at one point.
struct PointImage {
  Vec3 image;
  Mat3 jacobian{};     // of the way taken
  double outside = 0;  // distance from the solid, in the units of the point given
};

// A map of a solid, both ways, whatever it is made of: all that carries things takes any.
// Immutable, cheap to copy, safe from any number of threads.
class SolidMap {
 public:
  // A map both ways that is given point by point, for points anywhere: a repaired mesh as a
  // piecewise linear map, say. Both are called from any number of threads.
  struct Pointwise {
    std::function<PointImage(const Vec3&)> push, pull;  // from the source; to it
    double sourceDiagonal = 0, targetDiagonal = 0;      // of what it maps, world units
  };

  // Implicit, as each is one in every respect. Harmonic ones are inverted by Newton's method.
  SolidMap(HarmonicMap map) : harmonic_(std::make_shared<ComposedMap>(std::move(map))) {}
  SolidMap(ComposedMap map) : harmonic_(std::make_shared<ComposedMap>(std::move(map))) {}
  SolidMap(Pointwise map) : pointwise_(std::make_shared<Pointwise>(std::move(map))) {}

  // What it is made of: one of the two, the other is null.
  const ComposedMap* harmonic() const { return harmonic_.get(); }
  const Pointwise* pointwise() const { return pointwise_.get(); }

  // Of what the source becomes, world units.
  double targetDiagonal(const Solid& source) const;
  // Of points inside. accuracy: of the sums of charges, world units of the target.
  Points images(const Points& points, double accuracy) const;
  // Of a pointwise map alone: on all threads, deterministic.
  std::vector<PointImage> push(const Points& points) const;
  std::vector<PointImage> pull(const Points& points) const;

 private:
  std::shared_ptr<const ComposedMap> harmonic_;
  std::shared_ptr<const Pointwise> pointwise_;
};

// A mesh that remesh_cells.h carried and repaired, with the places that its vertices came from, in
// place of the map that it was carried by: linear on each tetrahedron, locally one-to-one as none
// is inverted; globally where proveCells() says so of both ends. What goes through it agrees with
// the mesh. Outside the mesh the nearest tetrahedron continues linearly.
//
// carried: what remesh writes, its vertices' field "source" the places that they came from. Throws
// DataError for a mesh without such a field of three components, with hexahedra, without
// tetrahedra, or with a tetrahedron that is inverted, there or here (how many).
SolidMap linearMapOf(const CellMesh& carried);

// Of a mesh that remeshCells() made with the map. Throws also DataError for a mesh that lies
// elsewhere than the map's target (their boxes differ by over a tenth of the diagonal).
SolidMap linearMapOf(const CellMesh& carried, const MappedSolid& mapped);

struct InverseSettings {
  OutsideSettings outside;
  double skin = 2;          // voxels outside the target's surface, in [0, 3]
  double tolerance = 1e-3;  // of f(p) = q, target voxels, in [1e-6, 0.01]
  double accuracy = 1e-7;   // of the sums of charges, as EvaluateSettings::accuracy
};

// Throws SettingError for a number out of its range.
void requireInRange(const InverseSettings& settings);

struct InverseStatistics {
  std::uint64_t voxels = 0;     // of the region
  std::uint64_t inverted = 0;   // with a residual of at most 0.01 voxel
  std::uint64_t uncovered = 0;  // in no cell's image: folds, and gaps along the boundary
  std::uint64_t failed = 0;     // not inverted
  std::uint64_t inside = 0, failedInside = 0;  // of those with their centre inside the target
  double largestResidual = 0;                  // of those inverted, target voxels
  Box3 failedBox;                              // world units of the target
  Points failedAt;                             // the first of them, at most 16

  double invertedInside() const;  // share of the voxels inside; 1 when there are none
  double invertedOutside() const;
  // What to warn of when over 0.5% of the voxels inside are not inverted, else nothing.
  std::string warning() const;
};

// For the voxels of `region` in the order of its leaves and of the voxels in them; voxels of leaf l
// start at first[l].
struct InvertedMap {
  openvdb::MaskGrid::Ptr region;
  std::vector<std::size_t> first;               // #leaves + 1
  Points sources;                               // #voxels: p with f(p) = q, world units
  std::vector<std::array<float, 9>> jacobians;  // #voxels: of f at p, row by row
  InverseStatistics statistics;
};

// A lattice of voxels through a solid, and as far around it as the map is to be used.
struct SourceLattice {
  openvdb::FloatGrid::Ptr levelSet;  // of the solid
  openvdb::MaskGrid::Ptr region;
};

// For each voxel of the target (those of targetLevelSet whose distance is at most the skin; with
// settings.outside also those around it that come from the lattice) the point p with f(p) = q:
// cells of the lattice are mapped, voxels in their images start with second-order accuracy, and
// Newton steps with the analytic Jacobian do the rest, halved while they do not help. Voxels inside
// that these do not invert start again from the sources of their neighbours, and, where the map has
// steps, from what inverting these one after the other finds. A voxel that is not inverted has the
// source and Jacobian of the nearest one that is. Outside the solid the map is extended as
// transfer/carry.h says, so voxels along the boundary, which the map meets but for its boundary
// error, have sources just outside. Pointwise maps say themselves where the voxels of the skin come
// from. Same result for any number of threads. Throws SettingError, DataError (nothing of the
// target is inverted), MemoryError, Cancelled.
InvertedMap invertMap(const SolidMap& map, const Solid& source, const SourceLattice& lattice,
                      const openvdb::FloatGrid& targetLevelSet,
                      const InverseSettings& settings = {});

// The same at any points of the target, world units; points that are in no voxel of `inverted` stay
// as they are. #points.
Points invertAt(const ComposedMap& map, const Solid& source, const SourceLattice& lattice,
                const InvertedMap& inverted, const Points& targets,
                const InverseSettings& settings = {});

// Where the voxels of the target come from, as images are resampled: the place in the source less
// the voxel's own, world units.
struct BackwardDisplacement {
  openvdb::Vec3SGrid::Ptr
      grid;  // "displacement", on the voxels of InvertedMap::region; 0 elsewhere
  InverseStatistics statistics;
};

// Throws as invertMap() does.
BackwardDisplacement backwardDisplacement(const SolidMap& map, const Solid& source,
                                          const openvdb::FloatGrid& targetLevelSet,
                                          const InverseSettings& settings = {});

// Points carried through the map of a solid, and back, with its derivative at each.

struct CarryPointsSettings {
  OutsideSettings outside;
  // Points that are no farther outside are taken for points of the boundary and carried whatever
  // `outside` says: fraction of the source's diagonal, in [0, 0.1]. Two surfaces that are meant to
  // be one differ by that much.
  double skin = 1e-3;
  double accuracy = 1e-7;  // of the sums of charges, as EvaluateSettings::accuracy
};

// Throws SettingError for a number out of its range.
void requireInRange(const CarryPointsSettings& settings);

enum class PointFate : std::uint8_t {
  carried,
  cut,    // too far outside the solid; it has no place
  failed  // the map was not inverted there; it has the place of the nearest point found
};

struct CarriedPoints {
  Points points;                // #points, world units
  std::vector<Mat3> jacobians;  // #points, of the way taken; empty when not asked for
  std::vector<PointFate> fates;
  // Of all: outside the solid by over 1e-6 of its diagonal, whatever their fate; and the rest.
  std::uint64_t outside = 0, cut = 0, failed = 0;
  double farthest = 0;  // of those outside and not cut, fraction of the source's diagonal
};

// Carries #points; with jacobians if asked for.
using PointCarry = std::function<CarriedPoints(const Points& points, bool jacobians)>;

// Points by where they lie to a solid: found once for any number of its maps.
struct PlacedPoints {
  Points points;      // world units
  Points at, beyond;  // themselves, or the closest of the boundary; from there to the points
  std::vector<PointFate> fates;  // carried or cut, whatever the map
};

// From the source to the target: x becomes f(x), the Jacobian is f's. Outside the solid the map is
// extended as transfer/carry.h says. Holds copies, which share their data; serves any number of
// maps.
class PointPusher {
 public:
  // Throws SettingError, MemoryError, Cancelled.
  explicit PointPusher(const Solid& source, const CarryPointsSettings& settings = {});

  // Same result for any number of threads. Throws DataError for a point that is not finite,
  // Cancelled.
  CarriedPoints push(const ComposedMap& map, const Points& points, bool jacobians) const;

  // The same in two parts; placed: by this pusher or one that it gave. Throw alike.
  PlacedPoints place(const Points& points) const;
  CarriedPoints push(const ComposedMap& map, const PlacedPoints& placed, bool jacobians) const;

  // This pusher with another motion that fades in outside.
  PointPusher fadingTo(const RigidMotion& motion) const;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

// What lies around, where frames may each fade to the best rigid motion of their own.
struct FrameOutside {
  OutsideSettings settings;
  bool fitted = false;
};

// The pushers of an animation's frames.
class FramePointPusher {
 public:
  // fitted: what lies outside fades to the best rigid motion of each frame, whatever the settings
  // say. Throws as PointPusher.
  FramePointPusher(const Solid& rest, CarryPointsSettings settings, bool fitted);

  PlacedPoints place(const Points& points) const { return pusher_.place(points); }
  // moved: where a frame has the vertices of the rest pose's repaired mesh.
  PointPusher to(const Points& moved) const;

 private:
  PointPusher pusher_;
  Points from_;  // empty unless fitted
};

// From the target to the source: y becomes the x with f(x) = y, the Jacobian is the inverse of f's
// there. The inverse on a grid of the target gives the starts (see inverse_map.h), Newton's method
// does the rest, to 1e-5 of the target's diagonal and mostly to `accuracy`.
class PointPuller {
 public:
  // Inverts the map on the grid. Throws as invertMap does.
  PointPuller(const ComposedMap& map, const Solid& source, const Solid& target,
              const CarryPointsSettings& settings = {});

  // Throws as PointPusher::push.
  CarriedPoints pull(const Points& points, bool jacobians) const;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

// From the source of a solid's map to its target (push) or back, by that map or another between
// them; keeps what it needs. A pointwise one cuts what is too far from the mesh that it maps.
// Throws as PointPusher and PointPuller.
PointCarry carryByMap(const SolidMap& map, const MappedSolid& mapped, bool push,
                      const CarryPointsSettings& settings = {});

// Peak need in bytes of carrying so many points, beyond the points given: with Jacobians or
// without.
std::uint64_t carryPointsMemory(std::uint64_t points, bool jacobians);

// What of a vector or a normal becomes of it, A being the Jacobian: A v; and A^-T n, as long as n
// was. A normal stays as it is where A is singular.
Vec3 carriedVector(const Mat3& jacobian, const Vec3& v);
Vec3 carriedNormal(const Mat3& jacobian, const Vec3& n);

}  // namespace innermap
