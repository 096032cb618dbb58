// What a study says, in words: which settings are best, and which of the paper's statements hold.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "innermap/study/study.h"

namespace innermap {

// What a series of runs varies, the others at the study's base.
enum class StudyAxis { sources, collocation, place };

// The rows with figures, ascending in what is varied.
std::vector<StudyRow> studySeries(const Study& study, StudyAxis axis, ChargePlacement placement);

enum class StatementVerdict { holds, partly, fails, unknown };
std::string verdictText(StatementVerdict verdict);  // "holds", "in part", "does not hold", ...

struct StudyStatement {
  std::string text;
  StatementVerdict verdict = StatementVerdict::unknown;
  std::string figures;  // that say so
};

struct StudyFindings {
  std::optional<StudyRow> best;      // of the smallest error at 99% of the fresh points
  std::optional<StudyRow> cheapest;  // of the fewest seconds within kNearlyBest of it
  std::vector<std::string> advice;   // a sentence or two each
  std::vector<StudyStatement> statements;
};

constexpr double kNearlyBest = 1.5;  // times the smallest error

StudyFindings studyFindings(const Study& study);

// "1000 charges at 0.02, 4 points each"; "1000 charges on a sphere of 1.5, 4 points each".
std::string describeRun(const StudyRun& run);

// The same as options of `innermap map`, whose map it then is.
std::string optionsOf(const StudyRun& run, const StudySettings& settings);

}  // namespace innermap
