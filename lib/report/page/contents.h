// From what a run has in memory to what its page shows.
#pragma once

#include <cstdint>
#include <vector>

#include "innermap/fit/frame_fitter.h"
#include "innermap/fit/mapped_solid.h"
#include "report/page/page.h"

namespace innermap {

// A surface by itself. Not when a map is shown already.
void addMesh(Page& page, const Mesh& mesh);

// Two surfaces of one connectivity, before and after, coloured by stretch; in place of others.
void showPair(Page& page, const Mesh& before, const Points& after);

// The source, where the map takes it and the target as given, coloured by boundary error and
// stretch; in place of others.
void showMap(Page& page, const MappedSolid& mapped);

// The rest pose and its frames, of which so many are expected; in place of others. Frames beyond
// what a page can hold are left out evenly.
class PageFrames {
 public:
  PageFrames(Page& page, const Mesh& rest, std::size_t expected);

  // Once a frame. positions: of all the rest pose's vertices. Coloured by stretch.
  void add(std::int64_t number, const Points& positions);
  // The same where its fit takes them, coloured by boundary error too.
  void add(std::int64_t number, const Points& positions, const FrameFit& fit);

 private:
  bool wanted();
  void addPlace(std::int64_t number, Points points);

  Page& page_;
  std::vector<int> kept_;
  std::size_t each_ = 1, seen_ = 0;
};

}  // namespace innermap
