// The figures of a study as the columns of a table.
#pragma once

#include <vector>

#include "innermap/study/study.h"

namespace innermap {

struct StudyColumn {
  const char* name;   // c_error
  const char* title;  // for people; null where others say as much
  double (*value)(const Study&, const StudyRow&);
  bool ofRun = false;  // known of failed runs too
};

// All but where charges are placed and failures, in order: sources, points, points_per_source,
// s_ratio, c_ratio, o_distance, spacings, r_ratio, c_error and so on; as StudyRow has them, the
// ratios as the paper.
const std::vector<StudyColumn>& studyColumns();

// NaN for what is not known.
double valueOf(const StudyColumn& column, const Study& study, const StudyRow& row);

const char* placementText(const StudyRun& run);  // "offset", "sphere"

}  // namespace innermap
