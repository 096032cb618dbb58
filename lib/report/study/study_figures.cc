#include "innermap/study/study.h"
#include "report/figures.h"
#include "report/report_sections.h"

namespace innermap {

Figures studyFigures(const Study& study, const StudyFindings& findings, const std::string& best,
                     const std::string& cheapest) {
  std::vector<std::string> statements;
  for (const StudyStatement& s : findings.statements)
    statements.push_back(s.text + ": " + verdictText(s.verdict));
  const StudyRow none;
  const StudyRow &first = findings.best ? *findings.best : none,
                 &second = findings.cheapest ? *findings.cheapest : none;
  return together(
      {{{"runs", study.rows.size(), "runs", ""},
        {"made", study.made, "made", "by this run"},
        {"kept", study.kept, "kept", "from earlier ones"},
        {"left", study.left, "left", "for lack of time"}},
       when(findings.best.has_value(),
            {{"best", best, "best", "options of map that give the least error"},
             {"best_p99", first.p99, "best, 99% within", "", FigureUnit::diagonals},
             {"cheapest", cheapest, "cheapest", "options of map that give nearly as much for less"},
             {"cheapest_p99", second.p99, "cheapest, 99% within", "", FigureUnit::diagonals}}),
       {{"advice", findings.advice, "advice", ""},
        {"statements", statements, "statements", "the paper's, and what this says"}}});
}

std::vector<ReportSection> studySections() {
  return {{"study", "Study", "Of the runs of a study.", studyFigures({}, {}, "", ""), {}}};
}

}  // namespace innermap
