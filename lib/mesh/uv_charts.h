// Where a surface's texture coordinates are continuous, and where they jump.
#pragma once

#include <vector>

#include "innermap/mesh/mesh.h"

namespace innermap {

// An edge on whose two sides the texture coordinates differ.
struct UvSeam {
  int triangle = 0,
      corner = 0;                  // one side: from this corner of the triangle to the next
  int other = 0, otherCorner = 0;  // the other side, which may run either way
};

struct UvCharts {
  // #T: the chart of each triangle, -1 where a corner has no coordinates.
  // Triangles are of one chart when edges lead from one to the other on whose
  // two sides the coordinates agree.
  std::vector<int> chart;
  int count = 0;
  std::vector<UvSeam> seams;
  double seamLength = 0,
         edgeLength = 0;  // of the seams and of all edges, world units
};

// Coordinates agree when they have the same index or differ by less than a
// millionth of their extent. Vertices that the file split along a seam count as
// one. An edge of more than two triangles is a seam between those of its
// neighbouring uses that differ; a border of the part that has coordinates is
// none. Throws DataError as validate() does, and when the mesh has no texture
// coordinates at all; Cancelled.
UvCharts uvCharts(const Mesh& mesh);

// Charts in groups, so that one continuous pair of functions may hold the
// coordinates of a group.
struct UvGroups {
  std::vector<int> group;       // #T, -1 where there are no coordinates
  int count = 0;                // at most what was asked for
  int pieces = 0;               // that the charts were divided into
  double unresolvedLength = 0;  // of seams whose two sides are in one group all the same
};

struct UvGroupSettings {
  int most = 16;  // groups, in [2, 64]
};

// A chart that meets itself along a seam (an unrolled cylinder) is divided:
// each triangle goes with the side of its seams that is nearer along the chart.
// Then each piece is a group of its own when there are at most
// settings.most;
// otherwise pieces that no seam joins share groups (greedy colouring, largest
// pieces first). Same for any number of threads. Throws SettingError, Cancelled.
UvGroups uvGroups(const Mesh& mesh, const UvCharts& charts, const UvGroupSettings& settings = {});

}  // namespace innermap
