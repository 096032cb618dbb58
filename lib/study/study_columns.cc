#include <cmath>

#include "innermap/study/study.h"

namespace innermap {
namespace {

template <auto kMember>
double of(const Study&, const StudyRow& row) {
  return static_cast<double>(row.*kMember);
}

double ratio(std::size_t count, const Study& study) {
  return static_cast<double>(count) / static_cast<double>(study.vertices);
}

}  // namespace

const std::vector<StudyColumn>& studyColumns() {
  static const std::vector<StudyColumn> all{
      {"sources", "charges", of<&StudyRow::sources>, true},
      {"points", "boundary points", of<&StudyRow::points>, true},
      {"points_per_source", nullptr, of<&StudyRow::collocation>, true},
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
      {"c_error", "C-Error", of<&StudyRow::cError>},
      {"collocation_rms", "its rms", of<&StudyRow::collocationRms>},
      {"rms", "fresh rms", of<&StudyRow::rms>},
      {"p99", "fresh 99%", of<&StudyRow::p99>},
      {"max", "largest", of<&StudyRow::max>},
      {"harmonic_energy", "harmonic energy", of<&StudyRow::harmonicEnergy>},
      {"deformation_energy", "deformation energy", of<&StudyRow::deformationEnergy>},
      {"jacobian_min", "least det J", of<&StudyRow::jacobianMin>},
      {"folded", "folded", of<&StudyRow::folded>},
      {"weights", "weights", of<&StudyRow::weights>},
      {"condition", "condition", of<&StudyRow::condition>},
      {"regularization", "regularisation", of<&StudyRow::regularization>},
      {"rank", "rank", of<&StudyRow::rank>},
      {"seconds", "seconds", of<&StudyRow::seconds>},
      {"seconds_overall", nullptr, of<&StudyRow::secondsOverall>}};
  return all;
}

double valueOf(const StudyColumn& column, const Study& study, const StudyRow& row) {
  return column.ofRun || row.failure.empty() ? column.value(study, row) : StudyRow::kNone;
}

const char* placementText(const StudyRun& run) {
  return run.placement == ChargePlacement::sphere ? "sphere" : "offset";
}

}  // namespace innermap
