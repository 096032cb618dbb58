// Ways to lay one surface on another, as a judge sees them: which are the same, which are as good.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/surface/correspond.h"

namespace innermap {

struct JudgedMap {
  Points images;     // of the judge's points, on B
  double score = 0;  // less is better
  Mat3 turn;         // the rotation that comes nearest to the map
};

// `points`: the judge's, on A. Throws what the judge throws.
JudgedMap judgedMap(const MapJudge& judge, const Points& points, Points images);

// Degrees of a rotation, in [0, 180].
double degreesOf(const Mat3& rotation);

// Whether both put the judge's points at about the same places.
bool sameWay(const JudgedMap& a, const JudgedMap& b);

// Whether the judge cannot be trusted to tell the worse from the better one.
bool asGood(const JudgedMap& a, const JudgedMap& b);

// Indices, first the one to take, then by score. It is that of the least score, or of other ways
// that are as good the one that turns A least: two bodies mostly stand alike, and one that is the
// same on both sides can be laid on another half a turn apart, at about the same score.
std::vector<std::size_t> byPreference(const std::vector<JudgedMap>& maps);

// The number of each map's way, from 0, in the order of the first map of each.
std::vector<std::size_t> waysOf(const std::vector<JudgedMap>& maps);

// Throws SettingError where another way than the best is wanted, as there is no choice: `which`
// says of what.
void requireOnlyWay(const WantedWay& wanted, const std::string& which);

// The number of the way that is wanted. `ways`: of maps, by preference. Throws SettingError where
// there is none such; `name` is of A.
std::size_t wantedWay(const std::vector<JudgedMap>& maps, const std::vector<std::size_t>& ways,
                      const WantedWay& wanted, const std::string& name);

}  // namespace innermap
