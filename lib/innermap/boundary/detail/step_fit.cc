#include "innermap/boundary/detail/step_fit.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "innermap/boundary/detail/shape_path.h"

namespace innermap {
namespace {

constexpr std::size_t kPlanPoints = 3000;
constexpr int kFirstSteps = 2;
constexpr int kDeepest = 5;            // halvings of one of the first steps
constexpr double kSumAccuracy = 1e-7;  // of the target's diagonal: where points go, and their folds

// One step that was fitted.
struct Fitted {
  MapStep record;
  AdaptiveEnd end = AdaptiveEnd::met;
  std::optional<HarmonicMap> map;
  MappedPoints mapped;  // what was inside, at its end
};

class StepFitter {
 public:
  StepFitter(const BoundaryPair& pair, const StepFitSettings& settings)
      : settings_(settings),
        mesh_(pair.solid().repaired().mesh),
        path_(mesh_.vertices, pair.target.moved, mesh_.triangles, growthOf(pair)) {}

  // Ends of the steps that coarse fits need, 0 left out.
  std::vector<double> plan(const Points& inside) {
    Points some;
    for (std::size_t i = 0; i < inside.size();
         i += std::max<std::size_t>(1, inside.size() / kPlanPoints))
      some.push_back(inside[i]);
    return endsOf(walk(evenly(std::min(kFirstSteps, settings_.maxSteps)), some, true));
  }

  std::vector<Fitted> fit(const std::vector<double>& ends, const Points& inside) {
    return walk(ends, inside, false);
  }

  HarmonicMap finished(const HarmonicMap& last) const {
    return HarmonicMap(movedBy(path_.rest(), last.field()));
  }

 private:
  static double growthOf(const BoundaryPair& pair) {
    const double volume = pair.target.volume;
    return volume > 0 ? std::cbrt(volume / pair.solid().volume())
                      : pair.target.diagonal / pair.solid().diagonal();
  }

  static std::vector<double> evenly(int steps) {
    std::vector<double> ends;
    for (int i = 1; i <= steps; ++i) ends.push_back(static_cast<double>(i) / steps);
    return ends;
  }

  static std::vector<double> endsOf(const std::vector<Fitted>& steps) {
    std::vector<double> ends;
    for (const Fitted& s : steps) ends.push_back(s.record.to);
    return ends;
  }

  Mesh shapeAt(double t) const {
    Mesh out;
    out.name = "an intermediate shape";
    out.vertices = path_.at(t);
    out.triangles = mesh_.triangles;
    return out;
  }

  Fitted fitOne(double from, double to, const MappedPoints& before, bool coarse) const {
    FittedStep step = settings_.fit(shapeAt(from), shapeAt(to), coarse);
    Fitted out;
    out.mapped =
        mapPoints(step.map, {before.points, {}}, kSumAccuracy * step.diagonal, settings_.progress);
    out.record = {from, to, step.map.field().sources().size(), step.error,
                  foldedShare(out.mapped.determinants)};
    out.end = step.end;
    out.map = std::move(step.map);
    return out;
  }

  // From 0 through the ends; a step that folds is halved, while there may be more of them.
  std::vector<Fitted> walk(std::vector<double> ends, const Points& inside, bool coarse) const {
    std::reverse(ends.begin(), ends.end());  // the next one last
    const double shortest = ends.empty() ? 0 : std::ldexp(1.0 / kFirstSteps, -kDeepest);
    std::vector<Fitted> done;
    MappedPoints now{inside, {}};
    double at = 0;
    while (!ends.empty()) {
      const double end = ends.back();
      Fitted step = fitOne(at, end, now, coarse);
      const bool more = static_cast<int>(done.size() + ends.size()) < settings_.maxSteps;
      if (step.record.folded > 0 && more && (end - at) / 2 >= shortest) {
        ends.push_back(0.5 * (at + end));
        continue;
      }
      ends.pop_back();
      at = end;
      now = step.mapped;
      done.push_back(std::move(step));
    }
    return done;
  }

  const StepFitSettings& settings_;
  const Mesh& mesh_;
  const ShapePath path_;
};

}  // namespace

StepFit fitInSteps(const BoundaryPair& pair, const Points& inside,
                   const StepFitSettings& settings) {
  StageSeconds seconds;
  StepFitter fitter(pair, settings);
  const std::vector<double> ends = timed(seconds, "plan", [&] { return fitter.plan(inside); });
  std::vector<Fitted> steps = timed(seconds, "steps", [&] { return fitter.fit(ends, inside); });
  std::vector<HarmonicMap> maps;
  std::vector<MapStep> records;
  AdaptiveEnd end = AdaptiveEnd::met;
  for (const Fitted& s : steps) {
    if (end == AdaptiveEnd::met) end = s.end;
    maps.push_back(*s.map);
    records.push_back(s.record);
  }
  maps.back() = fitter.finished(maps.back());
  return {ComposedMap(std::move(maps)), std::move(records), end, std::move(seconds)};
}

}  // namespace innermap
