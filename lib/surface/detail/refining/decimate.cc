#include "surface/detail/refining/decimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>

#include "innermap/core/run.h"

namespace innermap {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr std::size_t kHub = 48;  // larger stars wait until their rims have been thinned

// Squared distance from planes, weighted by area: p^T A p + 2 b p + c.
struct Quadric {
  std::array<double, 10> q{};

  void addPlane(const Vec3& n, double d, double weight) {
    const double v[4] = {n.x, n.y, n.z, d};
    int i = 0;
    for (int r = 0; r < 4; ++r)
      for (int c = r; c < 4; ++c) q[i++] += weight * v[r] * v[c];
  }
  void add(const Quadric& other) {
    for (std::size_t i = 0; i < q.size(); ++i) q[i] += other.q[i];
  }
  double at(const Vec3& p) const {
    return p.x * (q[0] * p.x + 2 * (q[1] * p.y + q[2] * p.z + q[3])) +
           p.y * (q[4] * p.y + 2 * (q[5] * p.z + q[6])) + p.z * (q[7] * p.z + 2 * q[8]) + q[9];
  }
};

class Decimator {
 public:
  Decimator(ProgressiveMesh& mesh, const Points& vertices, const DecimateSettings& settings)
      : mesh_(mesh), settings_(settings), quadrics_(vertices.size()), best_(vertices.size()) {
    const Box3 box = boundingBox(vertices);
    const double scale = box.diagonal() > 0 ? 1 / box.diagonal() : 1;
    for (const Vec3& p : vertices) points_.push_back(scale * (p - box.center()));
    for (int t = 0; t < static_cast<int>(mesh.triangleCount()); ++t) {
      const Triangle& tri = mesh.triangle(t);
      const Vec3& a = points_[tri[0]];
      const Vec3 n = cross(points_[tri[1]] - a, points_[tri[2]] - a);
      const double twice = norm(n);
      if (!(twice > 0)) continue;
      Quadric plane;
      plane.addPlane(n / twice, -dot(n, a) / twice, twice);
      for (const int v : tri) quadrics_[v].add(plane);
    }
    stamp_.assign(vertices.size(), 0);
  }

  void run() {
    for (int v = 0; v < static_cast<int>(points_.size()); ++v) update(v);
    const std::size_t start = mesh_.vertexCount();
    bool retried = false;
    while (mesh_.vertexCount() > settings_.vertices) {
      if (heap_.empty()) {
        if (retried) break;
        retried = hubsToo_ = true;
        for (int v = 0; v < static_cast<int>(points_.size()); ++v)
          if (mesh_.present(v)) update(v);
        if (heap_.empty()) break;
      }
      const Entry top = heap_.top();
      heap_.pop();
      if (!mesh_.present(top.vertex) || top.stamp != stamp_[top.vertex]) continue;
      apply(top.vertex);
      retried = false;
      if (mesh_.collapses() % 256 == 0)
        reportProgress("coarsening", static_cast<double>(start - mesh_.vertexCount()) /
                                         static_cast<double>(start));
    }
  }

 private:
  struct Entry {
    double cost;
    int vertex, stamp;
    bool operator<(const Entry& o) const {  // the queue's top is the least
      return cost != o.cost ? cost > o.cost : vertex > o.vertex;
    }
  };

  void update(int v) {
    ++stamp_[v];
    if (!mesh_.present(v) || (!settings_.keep.empty() && settings_.keep[v])) return;
    if (mesh_.around(v).size() > kHub && !hubsToo_) return;
    mesh_.ring(v, ring_);
    double least = kNever;
    for (std::size_t w = 0; w < ring_.size(); ++w) {
      const double c = cost(v, w, least);
      if (c >= least || !mesh_.collapsible(ring_, w) || !staysPositive(w)) continue;
      least = c;
      best_[v] = ring_[w];
    }
    if (least < kNever) heap_.push({least, v, stamp_[v]});
  }

  double cost(int v, std::size_t w, double bound) const {
    const std::size_t n = ring_.size();
    const Vec3 &from = points_[v], &to = points_[ring_[w].vertex];
    const double length = squaredNorm(to - from);
    const Quadric& q = quadrics_[v];
    double error = std::max(q.at(to), 0.0);
    error += 1e-3 * length * length + 1e-14;
    if (error >= bound) return kNever;
    double worst = 1;
    for (std::size_t i = (w + 1) % n; (i + 1) % n != w; i = (i + 1) % n) {
      const Vec3 &a = points_[ring_[i].vertex], &b = points_[ring_[(i + 1) % n].vertex];
      const Vec3 normal = cross(a - to, b - to);
      const double sum = squaredNorm(a - to) + squaredNorm(b - to) + squaredNorm(b - a);
      double quality = sum > 0 ? 2 * std::sqrt(3.0) * norm(normal) / sum : 0;
      if (dot(normal, cross(a - from, b - from)) < 0) quality *= 0.1;  // turned over
      worst = std::min(worst, quality);
    }
    const double valence =
        static_cast<double>(mesh_.around(ring_[w].vertex).size() + mesh_.around(v).size()) - 4;
    error /= std::max(worst, 1e-3);
    return valence > 8 ? error * std::pow(2.0, std::min(valence - 8, 60.0)) : error;
  }

  bool staysPositive(std::size_t w) const {
    if (!settings_.layout) return true;
    const Layout& layout = *settings_.layout;
    const std::size_t n = ring_.size();
    const auto place = [&](std::size_t i) {
      const RingVertex& r = ring_[i % n];
      return layout.moved(layout.place[r.vertex], r.shift);
    };
    const Vec3 to = place(w);
    for (std::size_t i = w + 1; i + 1 < w + n; ++i)
      if (!(tripleProduct(to, place(i), place(i + 1)) > 1e-12)) return false;
    return true;
  }

  void apply(int v) {
    const RingVertex w = best_[v];
    mesh_.ring(v, ring_);
    // Neighbours may have changed since: the entry is from the last change of v's own ring, but the
    // link condition looks one ring farther.
    const std::size_t at = static_cast<std::size_t>(
        std::find_if(ring_.begin(), ring_.end(),
                     [&](const RingVertex& r) { return r.vertex == w.vertex; }) -
        ring_.begin());
    if (at == ring_.size() || !mesh_.collapsible(ring_, at) || !staysPositive(at)) {
      update(v);
      return;
    }
    quadrics_[w.vertex].add(quadrics_[v]);
    mesh_.collapse(v, ring_[at]);
    mesh_.ring(w.vertex, ring_);
    const Ring changed = ring_;
    update(w.vertex);
    for (const RingVertex& r : changed) update(r.vertex);
  }

  ProgressiveMesh& mesh_;
  const DecimateSettings& settings_;
  Points points_;
  std::vector<Quadric> quadrics_;
  std::vector<RingVertex> best_;
  std::vector<int> stamp_;
  std::priority_queue<Entry> heap_;
  Ring ring_;
  bool hubsToo_ = false;
};

}  // namespace

void decimate(ProgressiveMesh& mesh, const Points& vertices, const DecimateSettings& settings) {
  Decimator(mesh, vertices, settings).run();
}

}  // namespace innermap
