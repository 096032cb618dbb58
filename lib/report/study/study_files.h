// What `study` writes beside its charts: a table, the same as JSON, and a page.
#pragma once

#include <string>
#include <vector>

#include "innermap/study/study.h"
#include "report/study/study_charts.h"

namespace innermap {

struct StudyNames {
  std::string source, target;
  bool laidOn = false;  // `target` is a correspondence
};

// Without its folders.
std::string fileNameOf(const std::string& path);

// CSV, a row for each run.
void writeStudyTable(const std::string& path, const Study& study);

void writeStudyJson(const std::string& path, const Study& study, const StudyFindings& findings,
                    const StudySettings& settings, const StudyNames& names);

// One file that needs no other.
void writeStudyPage(const std::string& path, const Study& study, const StudyFindings& findings,
                    const StudySettings& settings, const std::vector<StudyChart>& charts,
                    const StudyNames& names);

// For the terminal.
std::string studyHeader();
std::string studyLine(const StudyRow& row);

}  // namespace innermap
