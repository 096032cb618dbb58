// A layout relaxed while the vertices of a coarsened mesh return one by one.
//
// The hierarchical scheme of Praun and Hoppe, "Spherical parametrization and remeshing" (SIGGRAPH
// 2003), for any energy that is a sum over triangles.
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "innermap/surface/correspond.h"
#include "surface/detail/refining/progressive_mesh.h"
#include "surface/detail/sphere/star_kernel.h"

namespace innermap {

// The energy of the triangles around one vertex as a function of its place.
class Star {
 public:
  virtual ~Star() = default;
  virtual void gather(int vertex) = 0;
  // Whether some triangle of the gathered star is so thin that steps get nowhere.
  virtual bool squeezed() const { return false; }
  // Of the gathered star; infinite where a triangle is not positive.
  virtual double at(const Vec3& place) const = 0;
  // at(place) where that is below `most`; elsewhere any value that is not, which may be known
  // sooner.
  virtual double below(double most, const Vec3& place) const {
    (void)most;
    return at(place);
  }
  // Tangent vector towards lower energy; `now` is at(place).
  virtual Vec3 step(const Vec3& place, double now) const = 0;
};

// An energy that is a sum over triangles.
class StarEnergy {
 public:
  virtual ~StarEnergy() = default;
  virtual void changed(int triangle) = 0;  // its corners are others now
  virtual void grown(std::size_t vertices) {
    (void)vertices;
  }  // before all triangles are `changed`
  // Before each sweep over the vertices; whether the energy changed all over, so that all are
  // visited.
  virtual bool sweeps() { return false; }
  // Stars of one energy may be used on several threads while it does not change.
  virtual std::unique_ptr<Star> star() const = 0;
};

struct RelaxSettings {
  double growth = 1.5;   // all vertices are relaxed when there are so many times more
  int sweeps = 4;        // most, over all vertices at each growth
  int lastSweeps = 12;   // when the mesh is complete
  int steps = 2;         // most, at each vertex of a sweep
  double enough = 5e-3;  // share of its energy that a star must win for its neighbours to go on
  // Vertices that do not touch at the same time, where a star is worth handing to another thread.
  bool parallel = false;
  std::string_view stage = "relaxing";
};

// The result is that of one vertex after the other, whatever the number of threads.
class CoarseToFine {
 public:
  // `fixed`: #V or empty, vertices that are never moved. All references must outlive it.
  CoarseToFine(ProgressiveMesh& mesh, Layout& layout, StarEnergy& energy, std::vector<char> fixed,
               const RelaxSettings& settings)
      : mesh_(mesh),
        layout_(layout),
        energy_(energy),
        fixed_(std::move(fixed)),
        settings_(settings),
        relaxers_([&energy] {
          return Relaxer{energy.star(), {}, {}};
        }) {}

  // At most `sweeps` over all vertices that are present.
  void relaxAll(int sweeps);

  // Returns vertices until `vertices` are present (all at most). Where rounding leaves no valid
  // place for one, it stops: the vertex, or -1.
  int refine(std::size_t vertices);

 private:
  // What a thread needs to move a vertex.
  struct Relaxer {
    std::unique_ptr<Star> star;
    Ring ring;
    RingPlaces places;
  };
  struct Returned {
    int vertex, into;
  };

  double relax(Relaxer& relaxer, int v, int steps);
  bool insert(Relaxer& relaxer, const Returned& returned);
  std::vector<Returned> splitApart(std::size_t vertices);
  int insertAll(const std::vector<Returned>& returned);
  void findLevels(const std::vector<char>& active);
  void relaxLevel(const std::vector<int>& level, std::vector<char>& moved);

  ProgressiveMesh& mesh_;
  Layout& layout_;
  StarEnergy& energy_;
  std::vector<char> fixed_;
  RelaxSettings settings_;
  tbb::enumerable_thread_specific<Relaxer> relaxers_;
  std::vector<std::vector<int>> levels_;
  std::vector<int> levelOf_, star_;
  std::vector<std::size_t> touched_;  // by vertex: the last round of splits around it
  std::size_t round_ = 0;
};

}  // namespace innermap
