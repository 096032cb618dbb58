#include <algorithm>
#include <cmath>

#include "core/pi.h"
#include "core/random.h"
#include "fit/detail/problem_samples.h"
#include "fit/detail/streams.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/fit/surface_problem.h"
#include "sample/surface_samples.h"

namespace innermap {
namespace {

constexpr std::size_t kMostVertices = 200000;
constexpr std::size_t kPeaks = 48, kAbout = 16;  // places searched about at once, points about each
// The first time, when a random point may stand on the foot of a peak narrower than their spacing.
constexpr std::size_t kFirstPeaks = 480, kFirstAbout = 8;
constexpr int kRounds = 6;
constexpr double kNearer = 1.0 / 2.5;       // of the radius, from round to round
constexpr double kMargin = 0.1;             // beyond the largest that was found
constexpr std::uint64_t kFirstDraw = 1900;  // draws of `fresh` that no adaptive fit comes to

struct Place {
  SurfacePoint onSurface;
  Vec3 position;
  double error = 0;
};

}  // namespace

std::vector<SurfacePoint> vertexPlaces(const Mesh& mesh) {
  std::vector<char> met(mesh.vertices.size(), 0);
  std::vector<SurfacePoint> out;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t c = 0; c < 3; ++c) {
      char& known = met[static_cast<std::size_t>(mesh.triangles[t][c])];
      if (known) continue;
      known = 1;
      SurfacePoint p{static_cast<int>(t), {0, 0, 0}};
      p.barycentric[c] = 1;
      out.push_back(p);
    }
  if (out.size() <= kMostVertices) return out;
  const CounterRandom random(1, 11);
  for (std::size_t i = 0; i < kMostVertices; ++i)
    std::swap(out[i], out[i + random.bits(i) % (out.size() - i)]);
  out.resize(kMostVertices);
  return out;
}

namespace {

class Search {
 public:
  Search(const Solid& solid, const SurfaceErrors& errors, const CertificateSettings& settings)
      : solid_(solid), errors_(errors), settings_(settings) {}

  // Adds the places with their errors.
  std::vector<double> measure(const std::vector<SurfacePoint>& places) {
    std::vector<double> found = errors_(places);
    const Points at = positionsOf(solid_, places);
    for (std::size_t i = 0; i < places.size(); ++i) places_.push_back({places[i], at[i], found[i]});
    return found;
  }

  void about(double radius, int round) {
    const std::size_t about = round == 0 ? kFirstAbout : kAbout;
    const std::vector<Place> from = peaks(radius, round == 0 ? kFirstPeaks : kPeaks);
    std::vector<Vec3> wanted;
    const CounterRandom random(seedOf(settings_.seed, Stream::fresh, kFirstDraw), 13 + round);
    for (std::size_t i = 0; i < from.size() * about; ++i)
      wanted.push_back(from[i / about].position + radius * inBall(random, 3 * i));
    std::vector<SurfacePoint> places(wanted.size());
    parallelBlocks(wanted.size(), 8, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const Solid::Closest closest = solid_.closest(wanted[i], 2 * radius);
        places[i] = closest.onSurface.triangle >= 0 ? closest.onSurface : from[i / about].onSurface;
      }
    });
    measure(places);
    // What is not among the largest is of no more use.
    keepLargest(4 * kPeaks * kAbout);
  }

  // The first of several.
  Place largest() const {
    return *std::max_element(places_.begin(), places_.end(),
                             [](const Place& a, const Place& b) { return a.error < b.error; });
  }

  std::size_t count() const { return count_ + places_.size(); }

 private:
  static Vec3 inBall(const CounterRandom& random, std::size_t i) {
    const double z = 2 * random.uniform(i) - 1, angle = 2 * kPi * random.uniform(i + 1);
    const double across = std::sqrt(1 - z * z), r = std::sqrt(random.uniform(i + 2));
    return r * Vec3{across * std::cos(angle), across * std::sin(angle), z};
  }

  void keepLargest(std::size_t most) {
    std::stable_sort(places_.begin(), places_.end(),
                     [](const Place& a, const Place& b) { return a.error > b.error; });
    if (places_.size() <= most) return;
    count_ += places_.size() - most;
    places_.resize(most);
  }

  // The largest errors, none within `apart` of a larger one.
  std::vector<Place> peaks(double apart, std::size_t most) {
    keepLargest(std::max(places_.size() / 8, 4 * kPeaks * kAbout));
    std::vector<Place> out;
    for (const Place& p : places_) {
      if (out.size() == most) break;
      const bool isFar = std::all_of(out.begin(), out.end(), [&](const Place& q) {
        return norm(p.position - q.position) > apart;
      });
      if (isFar) out.push_back(p);
    }
    return out;
  }

  const Solid& solid_;
  const SurfaceErrors& errors_;
  const CertificateSettings& settings_;
  std::vector<Place> places_;
  std::size_t count_ = 0;
};

}  // namespace

BoundaryError certify(const Solid& solid, const SurfaceErrors& errors,
                      const CertificateSettings& settings) {
  if (settings.samples < 1 || settings.samples > 10'000'000)
    throw SettingError("samples", "must lie in [1, 1e7]");
  SampleSettings sample;
  sample.seed = seedOf(settings.seed, Stream::fresh);
  Search search(solid, errors, settings);
  const std::vector<double> random =
      search.measure(randomSamples(solid.surface(), settings.samples, sample));
  BoundaryError out = summarizeErrors(random);
  const auto missed =
      std::count_if(random.begin(), random.end(), [&](double e) { return e > settings.tolerance; });
  out.missed = static_cast<double>(missed) / static_cast<double>(random.size());
  search.measure(vertexPlaces(solid.surface()));
  double radius = std::sqrt(solid.area() / static_cast<double>(settings.samples));
  for (int round = 0; round < kRounds; ++round, radius *= kNearer) search.about(radius, round);
  const Place largest = search.largest();
  out.max = largest.error;
  out.maxAt = largest.position;
  out.searched = search.count() - out.samples;
  out.bound = std::max(out.bound, (1 + kMargin) * out.max);
  return out;
}

}  // namespace innermap
