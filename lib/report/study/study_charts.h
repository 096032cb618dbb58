// The charts of `study`.
#pragma once

#include <string>
#include <vector>

#include "innermap/study/study.h"
#include "report/svg_chart.h"

namespace innermap {

struct StudyChart {
  std::string file;     // its name
  std::string meaning;  // a sentence for the page
  SvgChart chart;
};

// Of those series that have two points at least. subtitle: which study.
std::vector<StudyChart> studyCharts(const Study& study, const std::string& subtitle);

// The files that there may be.
std::vector<std::string> studyChartNames();

}  // namespace innermap
