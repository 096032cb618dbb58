#include "surface/detail/refining/coarse_to_fine.h"

#include <algorithm>

#include "innermap/core/run.h"

namespace innermap {

// Backtracking; the share of the energy that was won.
double CoarseToFine::relax(int v, int steps) {
  if (!fixed_.empty() && fixed_[v]) return 0;
  energy_.gather(v);
  Vec3& q = layout_.place[v];
  double now = energy_.at(q);
  const double start = now;
  if (energy_.squeezed()) {
    mesh_.ring(v, starRing_);
    ringPlaces(layout_, starRing_, starPlaces_);
    const Vec3 to = kernelCentroid(layout_.space, q, starPlaces_);
    const double e = energy_.below(now, to);
    if (e < now) {
      q = to;
      now = e;
    }
  }
  for (int i = 0; i < steps; ++i) {
    const Vec3 step = energy_.step(q, now);
    if (!(norm(step) > 1e-14)) break;
    const double before = now;
    double share = 1;
    for (int k = 0; k < 12; ++k, share *= 0.4) {
      const Vec3 to = moveAlong(layout_.space, q, share * step);
      const double e = energy_.below(now, to);
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

void CoarseToFine::relaxAll(int sweeps) {
  energy_.grown(mesh_.vertexCount());
  for (int t = 0; t < static_cast<int>(mesh_.triangleCount()); ++t)
    if (mesh_.alive(t)) energy_.changed(t);
  // After the first sweep only those are visited around which something moved, or all that the
  // energy changed for.
  std::vector<char> active(mesh_.capacity(), 1), next(mesh_.capacity());
  for (int s = 0; s < sweeps; ++s) {
    bool moved = false;
    if (energy_.sweeps()) std::fill(active.begin(), active.end(), 1);
    std::fill(next.begin(), next.end(), 0);
    for (int v = 0; v < static_cast<int>(mesh_.capacity()); ++v) {
      if (v % 512 == 0) {
        throwIfCancelled();
        if (outOfTime()) return;
      }
      if (!mesh_.present(v) || !active[v]) continue;
      if (!(relax(v, settings_.steps) > settings_.enough)) continue;
      moved = true;
      for (const int t : mesh_.around(v))
        for (const int w : mesh_.triangle(t)) next[w] = 1;
    }
    if (!moved) break;
    active.swap(next);
  }
}

bool CoarseToFine::insert(int v, int into) {
  mesh_.ring(v, ring_);
  ringPlaces(layout_, ring_, places_);
  for (const int t : mesh_.around(v)) energy_.changed(t);
  std::size_t w = 0;
  while (ring_[w].vertex != into) ++w;
  Vec3 near;
  if (!placeNear(layout_.space, places_, w, near)) return false;
  energy_.gather(v);
  Vec3 mean;
  for (const Vec3& p : places_) mean += p;
  mean = mean / (layout_.space == ModelSpace::sphere ? std::max(norm(mean), 1e-300)
                                                     : static_cast<double>(places_.size()));
  Vec3& place = layout_.place[v];
  place = near;
  double least = energy_.at(near);
  for (const Vec3& candidate : {kernelCentroid(layout_.space, near, places_), mean}) {
    const double e = energy_.below(least, candidate);
    if (!(e < least)) continue;
    least = e;
    place = candidate;
  }
  if (outOfTime()) return true;
  relax(v, settings_.steps + 1);
  for (const RingVertex& r : ring_) relax(r.vertex, 1);
  return true;
}

int CoarseToFine::refine(std::size_t vertices) {
  vertices = std::min(vertices, mesh_.capacity());
  double next = settings_.growth * static_cast<double>(mesh_.vertexCount());
  while (mesh_.vertexCount() < vertices) {
    const int into = mesh_.lastInto();
    const int v = mesh_.split();
    if (!insert(v, into)) return v;
    const bool last = mesh_.vertexCount() == vertices;
    if (static_cast<double>(mesh_.vertexCount()) < next && !last) continue;
    next = settings_.growth * static_cast<double>(mesh_.vertexCount());
    relaxAll(last ? settings_.lastSweeps : settings_.sweeps);
    reportProgress(settings_.stage, static_cast<double>(mesh_.vertexCount()) /
                                        static_cast<double>(mesh_.capacity()));
  }
  return -1;
}

}  // namespace innermap
