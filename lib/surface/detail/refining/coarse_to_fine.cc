#include "surface/detail/refining/coarse_to_fine.h"

#include <algorithm>
#include <cmath>

#include "innermap/core/run.h"

namespace innermap {
namespace {

constexpr std::size_t kTogether = 4;    // vertices that a thread moves at a time
constexpr std::size_t kHandedOut = 12;  // of a level at least, for other threads to be woken
constexpr std::size_t kCheck = 512;     // vertices between looks at the time

}  // namespace

// Backtracking; the share of the energy that was won.
double CoarseToFine::relax(Relaxer& relaxer, int v, int steps) {
  if (!fixed_.empty() && fixed_[v]) return 0;
  Star& star = *relaxer.star;
  star.gather(v);
  Vec3& q = layout_.place[v];
  double now = star.at(q);
  const double start = now;
  if (star.squeezed()) {
    mesh_.ring(v, relaxer.ring);
    ringPlaces(layout_, relaxer.ring, relaxer.places);
    const Vec3 to = kernelCentroid(layout_.space, q, relaxer.places);
    const double e = star.below(now, to);
    if (e < now) {
      q = to;
      now = e;
    }
  }
  for (int i = 0; i < steps; ++i) {
    const Vec3 step = star.step(q, now);
    if (!(norm(step) > 1e-14)) break;
    const double before = now;
    double share = 1;
    for (int k = 0; k < 12; ++k, share *= 0.4) {
      const Vec3 to = moveAlong(layout_.space, q, share * step);
      const double e = star.below(now, to);
      if (e < now) {
        q = to;
        now = e;
        break;
      }
    }
    if (!(now < before * (1 - 1e-3))) break;
  }
  return start > 0 ? 1 - now / start : 0;
}

// Active vertices by how many wait for one another, each for its neighbours of lower numbers: each
// then moves after and before the same ones as in the order of the numbers.
void CoarseToFine::findLevels(const std::vector<char>& active) {
  for (std::vector<int>& level : levels_) level.clear();
  levelOf_.assign(mesh_.capacity(), -1);
  for (int v = 0; v < static_cast<int>(mesh_.capacity()); ++v) {
    if (!mesh_.present(v) || !active[v]) continue;
    int level = 0;
    if (settings_.parallel)
      for (const int t : mesh_.around(v))
        for (const int w : mesh_.triangle(t)) level = std::max(level, levelOf_[w] + 1);
    levelOf_[v] = level;
    if (levels_.size() <= static_cast<std::size_t>(level)) levels_.emplace_back();
    levels_[static_cast<std::size_t>(level)].push_back(v);
  }
}

// Marks in `moved` those of a level that won enough.
void CoarseToFine::relaxLevel(const std::vector<int>& level, std::vector<char>& moved) {
  const auto some = [&](std::size_t begin, std::size_t end) {
    Relaxer& relaxer = relaxers_.local();
    for (std::size_t i = begin; i < end; ++i)
      moved[level[i]] = relax(relaxer, level[i], settings_.steps) > settings_.enough;
  };
  if (settings_.parallel && level.size() >= kHandedOut) {
    parallelBlocks(level.size(), kTogether, some);
    return;
  }
  for (std::size_t i = 0; i < level.size() && !outOfTime(); i += kCheck) {
    throwIfCancelled();
    some(i, std::min(level.size(), i + kCheck));
  }
}

void CoarseToFine::relaxAll(int sweeps) {
  energy_.grown(mesh_.vertexCount());
  for (int t = 0; t < static_cast<int>(mesh_.triangleCount()); ++t)
    if (mesh_.alive(t)) energy_.changed(t);
  // After the first sweep only those are visited around which something moved, or all that the
  // energy changed for.
  std::vector<char> active(mesh_.capacity(), 1), moved(mesh_.capacity());
  for (int s = 0; s < sweeps; ++s) {
    if (energy_.sweeps()) std::fill(active.begin(), active.end(), 1);
    std::fill(moved.begin(), moved.end(), 0);
    findLevels(active);
    for (const std::vector<int>& level : levels_) {
      if (outOfTime()) return;
      relaxLevel(level, moved);
    }
    std::fill(active.begin(), active.end(), 0);
    bool some = false;
    for (int v = 0; v < static_cast<int>(mesh_.capacity()); ++v) {
      if (!moved[v]) continue;
      some = true;
      for (const int t : mesh_.around(v))
        for (const int w : mesh_.triangle(t)) active[w] = 1;
    }
    if (!some) break;
  }
}

bool CoarseToFine::insert(Relaxer& relaxer, const Returned& returned) {
  const int v = returned.vertex;
  Ring ring;
  RingPlaces places;
  mesh_.ring(v, ring);
  ringPlaces(layout_, ring, places);
  std::size_t w = 0;
  while (ring[w].vertex != returned.into) ++w;
  Vec3 near;
  if (!placeNear(layout_.space, places, w, near)) return false;
  Star& star = *relaxer.star;
  star.gather(v);
  Vec3 mean;
  for (const Vec3& p : places) mean += p;
  mean = mean / (layout_.space == ModelSpace::sphere ? std::max(norm(mean), 1e-300)
                                                     : static_cast<double>(places.size()));
  Vec3& place = layout_.place[v];
  place = near;
  double least = star.at(near);
  for (const Vec3& candidate : {kernelCentroid(layout_.space, near, places), mean}) {
    const double e = star.below(least, candidate);
    if (!(e < least)) continue;
    least = e;
    place = candidate;
  }
  if (outOfTime()) return true;
  relax(relaxer, v, settings_.steps + 1);
  for (const RingVertex& r : ring) relax(relaxer, r.vertex, 1);
  return true;
}

// Returns vertices, at most up to so many, as long as what one and its ring move by is not what
// another moves.
std::vector<CoarseToFine::Returned> CoarseToFine::splitApart(std::size_t vertices) {
  std::vector<Returned> out;
  touched_.resize(mesh_.capacity(), 0);
  ++round_;
  while (mesh_.vertexCount() < vertices && (out.empty() || settings_.parallel)) {
    mesh_.nextStar(star_);
    const bool meets =
        std::any_of(star_.begin(), star_.end(), [&](int v) { return touched_[v] == round_; });
    if (meets) break;
    const int into = mesh_.lastInto();
    const int v = mesh_.split();
    out.push_back({v, into});
    for (const int t : mesh_.around(v)) {
      energy_.changed(t);
      for (const int w : mesh_.triangle(t))
        for (const int u : mesh_.around(w))
          for (const int x : mesh_.triangle(u)) touched_[x] = round_;
    }
  }
  return out;
}

// The first for which there is no room, or -1.
int CoarseToFine::insertAll(const std::vector<Returned>& returned) {
  std::vector<char> placed(returned.size(), 0);
  const auto some = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) placed[i] = insert(relaxers_.local(), returned[i]);
  };
  if (returned.size() > 1)
    parallelBlocks(returned.size(), 1, some);
  else
    some(0, 1);
  const auto stuck = std::find(placed.begin(), placed.end(), 0);
  return stuck == placed.end() ? -1
                               : returned[static_cast<std::size_t>(stuck - placed.begin())].vertex;
}

int CoarseToFine::refine(std::size_t vertices) {
  vertices = std::min(vertices, mesh_.capacity());
  while (mesh_.vertexCount() < vertices) {
    const double grown = std::ceil(settings_.growth * static_cast<double>(mesh_.vertexCount()));
    const std::size_t next = std::min(vertices, static_cast<std::size_t>(grown));
    while (mesh_.vertexCount() < next) {
      const int stuck = insertAll(splitApart(next));
      if (stuck >= 0) return stuck;
    }
    relaxAll(next == vertices ? settings_.lastSweeps : settings_.sweeps);
    reportProgress(settings_.stage, static_cast<double>(mesh_.vertexCount()) /
                                        static_cast<double>(mesh_.capacity()));
  }
  return -1;
}

}  // namespace innermap
