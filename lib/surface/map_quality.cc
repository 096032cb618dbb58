#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/require_number.h"
#include "innermap/core/run.h"
#include "innermap/mesh/check.h"
#include "innermap/surface/correspond.h"
#include "mesh/triangle_tree.h"
#include "surface/detail/refining/area_samples.h"
#include "surface/detail/refining/joined_shells.h"
#include "surface/detail/refining/layout_map.h"

namespace innermap {
namespace {

constexpr char kMeasuring[] = "measuring the map";
constexpr std::size_t kBlock = 256;
constexpr double kCollapsed = 1e12;  // stretch of a triangle whose image has no area

struct Weighted {
  double value, weight;
};

// The value that half, or 99%, of the weight does not exceed.
Quantiles quantilesOf(std::vector<Weighted>& values) {
  Quantiles result;
  if (values.empty()) return result;
  std::sort(values.begin(), values.end(),
            [](const Weighted& a, const Weighted& b) { return a.value < b.value; });
  double total = 0;
  for (const Weighted& v : values) total += v.weight;
  const auto at = [&](double share) {
    double sum = 0;
    for (const Weighted& v : values)
      if ((sum += v.weight) >= share * total) return v.value;
    return values.back().value;
  };
  result.median = at(0.5);
  result.p99 = at(0.99);
  result.max = values.back().value;
  return result;
}

class Measurement {
 public:
  Measurement(const Correspondence& map, const MapQualitySettings& settings)
      : map_(map), settings_(settings) {
    for (const ShellCorrespondence& shell : map.shells) {
      const ClosedSurface& b = shell.targetSurface;
      from_.add(shell.surface.vertices, shell.surface.triangles);
      image_.add(shell.positions, shell.surface.triangles);
      onto_.add(b.vertices, b.triangles);
    }
    const auto sum = [](const JoinedShells& s) {
      const std::vector<double> areas = triangleAreas(s.vertices, s.triangles);
      return std::accumulate(areas.begin(), areas.end(), 0.0);
    };
    areaA_ = sum(from_);
    areaB_ = sum(onto_);
    scale_ = areaA_ > 0 && areaB_ > 0 ? std::sqrt(areaA_ / areaB_) : 1;
    diagonal_ = boundingBox(onto_.vertices).diagonal();
  }

  MapQuality run() {
    std::vector<LayoutQuality> images;
    for (const ShellCorrespondence& shell : map_.shells) {
      const ClosedSurface& b = shell.targetSurface;
      images.push_back(layoutQuality(shell.surface.triangles, shell.surface.vertices, shell.image));
      result_.flips += layoutQuality(b.triangles, b.vertices, shell.targetLayout).flips;
      measureShell(shell, b);
    }
    const LayoutQuality image = together(images);
    result_.flips += image.flips;
    result_.degree = image.degree;
    result_.areaRatioLog10 = image.areaRatioLog10;
    result_.energyForward = energy_[0] / std::max(weight_[0], 1e-300);
    result_.energyBackward = energy_[1] / std::max(weight_[1], 1e-300);
    result_.unmeasured =
        missed_ / std::max(missed_ + weight_[0] / areaA_ + weight_[1] / areaB_, 1e-300);
    result_.stretch = quantilesOf(stretch_);
    result_.triangleStretch = quantilesOf(triangleStretch_);
    result_.invertedShare = static_cast<double>(result_.invertedTriangles) /
                            static_cast<double>(std::max<std::size_t>(1, image_.triangles.size()));
    result_.deviation = deviationOf(image_, onto_);
    result_.backDeviation = deviationOf(onto_, image_);
    if (settings_.selfIntersections) {
      result_.imageSelfIntersections = crossingsOf(image_);
      result_.targetSelfIntersections = crossingsOf(onto_);
    }
    return result_;
  }

 private:
  template <typename Body>
  void parallel(std::size_t count, const Body& body) {
    parallelBlocks(
        count, kBlock,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) body(i);
        },
        kMeasuring);
  }

  Stretches scaled(Stretches s) const { return {scale_ * s.s1, scale_ * s.s2}; }

  // Samples follow the area on both surfaces: what a small triangle is stretched over counts too.
  double samplesFor(double share) const {
    return static_cast<double>(settings_.samples) * std::min(1.0, share);
  }
  static std::vector<double> bothShares(const std::vector<double>& own,
                                        const std::vector<double>& image) {
    const double sumOwn = std::accumulate(own.begin(), own.end(), 0.0),
                 sumImage = std::accumulate(image.begin(), image.end(), 0.0);
    std::vector<double> shares(own.size());
    for (std::size_t t = 0; t < own.size(); ++t)
      shares[t] = own[t] / std::max(sumOwn, 1e-300) + image[t] / std::max(sumImage, 1e-300);
    return shares;
  }

  void measureShell(const ShellCorrespondence& shell, const ClosedSurface& b) {
    const ClosedSurface& a = shell.surface;
    const Locator onA(a.triangles, shell.image), onB(b.triangles, shell.targetLayout);
    const LayoutMap composed({a, shell.image, onA}, {b, shell.targetLayout, onB});
    const std::vector<double> areas = triangleAreas(a.vertices, a.triangles),
                              imageAreas = triangleAreas(shell.positions, a.triangles),
                              targetAreas = triangleAreas(b.vertices, b.triangles);
    measureForward(
        composed, areaSamples(a, bothShares(areas, imageAreas), samplesFor(sumOf(areas) / areaA_)));
    const std::vector<double> back = preimageAreas(composed, b);
    measureBackward(composed, areaSamples(b, bothShares(targetAreas, back),
                                          samplesFor(sumOf(targetAreas) / areaB_)));
    measureTriangles(shell, composed, b);
  }

  static double sumOf(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
  }

  void measureForward(const LayoutMap& composed, const std::vector<AreaSample>& samples) {
    std::vector<Stretches> found(samples.size());
    std::vector<char> measured(samples.size(), 0);
    parallel(samples.size(), [&](std::size_t i) {
      const LayoutMap::Image image = composed.at(samples[i].triangle, samples[i].barycentric);
      measured[i] = image.measured;
      found[i] = scaled(image.stretches);
    });
    collect(0, samples, found, measured);
    for (std::size_t i = 0; i < samples.size(); ++i)
      if (measured[i]) stretch_.push_back({found[i].worst(), samples[i].area});
  }

  void measureBackward(const LayoutMap& composed, const std::vector<AreaSample>& samples) {
    std::vector<Stretches> found(samples.size());
    std::vector<char> measured(samples.size(), 0);
    parallel(samples.size(), [&](std::size_t i) {
      const LayoutMap::Preimage from = composed.of(samples[i].triangle, samples[i].barycentric);
      measured[i] = from.measured;
      found[i] = scaled(from.stretches);
    });
    collect(1, samples, found, measured);
  }

  void collect(int side, const std::vector<AreaSample>& samples,
               const std::vector<Stretches>& found, const std::vector<char>& measured) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (measured[i]) {
        energy_[side] += samples[i].area * found[i].symmetricDirichlet();
        weight_[side] += samples[i].area;
      } else {
        missed_ += samples[i].area / (side == 0 ? areaA_ : areaB_);
      }
    }
  }

  // Of B's triangles between the places on A that their corners come from.
  std::vector<double> preimageAreas(const LayoutMap& composed, const ClosedSurface& b) {
    std::vector<std::array<int, 2>> use(b.vertices.size());  // a triangle and corner of each vertex
    for (std::size_t t = 0; t < b.triangles.size(); ++t)
      for (int k = 0; k < 3; ++k) use[b.triangles[t][k]] = {static_cast<int>(t), k};
    Points from(b.vertices.size());
    parallel(b.vertices.size(), [&](std::size_t v) {
      std::array<double, 3> corner{};
      corner[use[v][1]] = 1;
      from[v] = composed.of(use[v][0], corner).position;
    });
    return triangleAreas(from, b.triangles);
  }

  void measureTriangles(const ShellCorrespondence& shell, const LayoutMap& composed,
                        const ClosedSurface& b) {
    const ClosedSurface& a = shell.surface;
    std::vector<Weighted> stretch(a.triangles.size(), {0, 0});
    std::vector<char> inverted(a.triangles.size(), 0);
    const auto normal = [&](const Points& at, const Triangle& t) {
      return cross(at[t[1]] - at[t[0]], at[t[2]] - at[t[0]]);
    };
    parallel(a.triangles.size(), [&](std::size_t i) {
      const Triangle& t = a.triangles[i];
      const Points &x = a.vertices, &y = shell.positions;
      const FlatTriangle flat(x[t[0]], x[t[1]], x[t[2]]);
      if (!flat.sliver) {
        std::array<Vec3, 2> moved;
        for (int d = 0; d < 2; ++d)
          moved[d] =
              flat.along[d][1] * (y[t[1]] - y[t[0]]) + flat.along[d][2] * (y[t[2]] - y[t[0]]);
        stretch[i] = {scaled(stretchesOf(moved[0], moved[1])).worst(), flat.area};
      }
      const Vec3 own = normal(y, t);
      bool against = norm(own) > 1e-14 * diagonal_ * diagonal_;
      for (int k = 0; k < 3 && against; ++k)
        against = dot(own, normal(b.vertices, b.triangles[shell.onTarget[t[k]].triangle])) < 0;
      if (against) {
        const int middle = composed.at(static_cast<int>(i), {1. / 3, 1. / 3, 1. / 3}).triangle;
        against = dot(own, normal(b.vertices, b.triangles[middle])) < 0;
      }
      inverted[i] = against;
    });
    for (std::size_t i = 0; i < stretch.size(); ++i) {
      if (stretch[i].weight > 0)
        triangleStretch_.push_back({std::min(stretch[i].value, kCollapsed), stretch[i].weight});
      if (inverted[i]) ++result_.invertedTriangles;
    }
  }

  // Samples in the triangles, and their corners and the middles of their edges without weight.
  Quantiles deviationOf(const JoinedShells& of, const JoinedShells& from) {
    const TriangleTree tree(from.vertices, from.triangles);
    ClosedSurface surface;
    surface.vertices = of.vertices;
    surface.triangles = of.triangles;
    std::vector<AreaSample> samples = areaSamples(surface, triangleAreas(of.vertices, of.triangles),
                                                  static_cast<double>(settings_.samples));
    for (std::size_t t = 0; t < of.triangles.size(); ++t)
      for (int k = 0; k < 3; ++k) {
        AreaSample s{static_cast<int>(t), 0, {}};
        s.barycentric[k] = s.barycentric[(k + 1) % 3] = 0.5;
        samples.push_back(s);
        s.barycentric = {};
        s.barycentric[k] = 1;
        if (of.triangles[t][k] < of.triangles[t][(k + 1) % 3]) samples.push_back(s);
      }
    std::vector<Weighted> distances(samples.size());
    parallel(samples.size(), [&](std::size_t i) {
      const Triangle& t = of.triangles[samples[i].triangle];
      Vec3 p;
      for (int k = 0; k < 3; ++k) p += samples[i].barycentric[k] * of.vertices[t[k]];
      distances[i] = {tree.closest(p).distance / diagonal_, samples[i].area};
    });
    return quantilesOf(distances);
  }

  std::size_t crossingsOf(const JoinedShells& surfaces) {
    std::size_t count = 0;
    forEachSelfIntersection(surfaces.vertices, surfaces.triangles,
                            [&](const Crossing&) { ++count; });
    return count;
  }

  const Correspondence& map_;
  const MapQualitySettings& settings_;
  JoinedShells from_, image_, onto_;
  double areaA_ = 0, areaB_ = 0, scale_ = 1, diagonal_ = 0;
  std::array<double, 2> energy_{}, weight_{};
  double missed_ = 0;
  std::vector<Weighted> stretch_, triangleStretch_;
  MapQuality result_;
};

}  // namespace

MapQuality mapQuality(const Correspondence& map, const MapQualitySettings& settings) {
  requireNumber("samples", settings.samples, {1, 1e8});
  reportProgress(kMeasuring, 0);
  return Measurement(map, settings).run();
}

}  // namespace innermap
