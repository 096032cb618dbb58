#include <cmath>

#include "innermap/study/study.h"

namespace innermap {
namespace {

double ratio(std::size_t count, const Study& study) {
  return static_cast<double>(count) / static_cast<double>(study.vertices);
}

}  // namespace

const std::vector<StudyColumn>& studyColumns() {
  static const std::vector<StudyColumn> all{
      {"sources", "charges",
       [](const Study&, const StudyRow& r) { return static_cast<double>(r.sources); }, true},
      {"points", "boundary points",
       [](const Study&, const StudyRow& r) { return static_cast<double>(r.points); }, true},
      {"points_per_source", nullptr, [](const Study&, const StudyRow& r) { return r.collocation; },
       true},
      {"s_ratio", nullptr, [](const Study& s, const StudyRow& r) { return ratio(r.sources, s); },
       true},
      {"c_ratio", nullptr, [](const Study& s, const StudyRow& r) { return ratio(r.points, s); },
       true},
      {"o_distance", "distance",
       [](const Study&, const StudyRow& r) {
         return r.placement == ChargePlacement::offset ? r.at : StudyRow::kNone;
       },
       true},
      {"spacings", "in spacings",
       [](const Study& s, const StudyRow& r) {
         return r.placement == ChargePlacement::offset
                    ? r.at / s.spacing * std::sqrt(static_cast<double>(r.sources))
                    : StudyRow::kNone;
       },
       true},
      {"r_ratio", "radius",
       [](const Study&, const StudyRow& r) {
         return r.placement == ChargePlacement::sphere ? r.at : StudyRow::kNone;
       },
       true},
      {"c_error", "C-Error", [](const Study&, const StudyRow& r) { return r.cError; }},
      {"collocation_rms", "its rms",
       [](const Study&, const StudyRow& r) { return r.collocationRms; }},
      {"rms", "fresh rms", [](const Study&, const StudyRow& r) { return r.rms; }},
      {"p99", "fresh 99%", [](const Study&, const StudyRow& r) { return r.p99; }},
      {"max", "largest", [](const Study&, const StudyRow& r) { return r.max; }},
      {"harmonic_energy", "harmonic energy",
       [](const Study&, const StudyRow& r) { return r.harmonicEnergy; }},
      {"deformation_energy", "deformation energy",
       [](const Study&, const StudyRow& r) { return r.deformationEnergy; }},
      {"jacobian_min", "least det J",
       [](const Study&, const StudyRow& r) { return r.jacobianMin; }},
      {"folded", "folded", [](const Study&, const StudyRow& r) { return r.folded; }},
      {"weights", "weights", [](const Study&, const StudyRow& r) { return r.weights; }},
      {"condition", "condition", [](const Study&, const StudyRow& r) { return r.condition; }},
      {"regularization", "regularisation",
       [](const Study&, const StudyRow& r) { return r.regularization; }},
      {"rank", "rank", [](const Study&, const StudyRow& r) { return static_cast<double>(r.rank); }},
      {"seconds", "seconds", [](const Study&, const StudyRow& r) { return r.seconds; }},
      {"seconds_overall", nullptr,
       [](const Study&, const StudyRow& r) { return r.secondsOverall; }}};
  return all;
}

double valueOf(const StudyColumn& column, const Study& study, const StudyRow& row) {
  return column.ofRun || row.failure.empty() ? column.value(study, row) : StudyRow::kNone;
}

const char* placementText(const StudyRun& run) {
  return run.placement == ChargePlacement::sphere ? "sphere" : "offset";
}

}  // namespace innermap
