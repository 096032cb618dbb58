#include "lattice/untangle.h"

#include <lbfgs.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>

#include "innermap/core/run.h"

namespace innermap {
namespace {

constexpr int kPairs = 8;
constexpr double kLeastGain = 1e-2;  // of a round; below it no more is to be had
constexpr int kStepsLookedAt = 3;    // for UntangleSettings::leastStepGain
constexpr std::size_t kTetsABlock = 512, kVerticesABlock = 1024;
constexpr double kSmallest = 1e-9;  // regularisation of patches without folds

struct LbfgsFree {
  void operator()(lbfgsfloatval_t* p) const { lbfgs_free(p); }
};

// Derivative of the determinant.
Mat3 cofactors(const Mat3& m) {
  Mat3 out;
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
      out[r][c] = m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1];
    }
  return out;
}

// The determinant, made positive, and its slope.
struct Lifted {
  double value, slope;

  Lifted(double det, double eps) {
    const double root = std::sqrt(det * det + eps * eps);
    // Of numbers that do not cancel.
    value = det > 0 ? 0.5 * (det + root) : 0.5 * eps * eps / (root - det);
    slope = value / root;
  }
};

class Energy {
 public:
  Energy(TetPatch& patch, const UntangleSettings& settings)
      : patch_(patch),
        settings_(settings),
        unknownOf_(patch.vertices.size(), -1),
        forces_(patch.tets.size()) {
    for (std::size_t v = 0; v < patch.vertices.size(); ++v)
      if (patch.free[v]) {
        unknownOf_[v] = static_cast<int>(unknowns_.size());
        unknowns_.push_back(static_cast<int>(v));
      }
    firstCorner_.assign(unknowns_.size() + 1, 0);
    forCorners([&](std::size_t u, const Corner&) { ++firstCorner_[u + 1]; });
    std::partial_sum(firstCorner_.begin(), firstCorner_.end(), firstCorner_.begin());
    corners_.resize(firstCorner_.back());
    std::vector<std::size_t> next(firstCorner_.begin(), firstCorner_.end() - 1);
    forCorners([&](std::size_t u, const Corner& corner) { corners_[next[u]++] = corner; });
  }

  std::size_t size() const { return 3 * unknowns_.size(); }

  void read(lbfgsfloatval_t* x) const {
    for (std::size_t u = 0; u < unknowns_.size(); ++u)
      for (int k = 0; k < 3; ++k) x[3 * u + k] = patch_.vertices[unknowns_[u]][k];
  }

  void write(const lbfgsfloatval_t* x) {
    for (std::size_t u = 0; u < unknowns_.size(); ++u)
      for (int k = 0; k < 3; ++k) patch_.vertices[unknowns_[u]][k] = x[3 * u + k];
  }

  double leastDeterminant() const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t t = 0; t < patch_.tets.size(); ++t)
      least = std::min(least, determinant(jacobianOf(patch_, t)));
    return least;
  }

  // With its derivatives by the corners of each tetrahedron. Not cancelled: it is called from C.
  double at(double eps) {
    const std::size_t count = patch_.tets.size();
    std::vector<double> parts((count + kTetsABlock - 1) / kTetsABlock, 0.0);
    parallelBlocks(count, kTetsABlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t) parts[begin / kTetsABlock] += of(t, eps);
    });
    double sum = std::accumulate(parts.begin(), parts.end(), 0.0);
    for (const Spring& spring : patch_.springs) {
      const Vec3 way = patch_.vertices[spring.vertex] - spring.place;
      const double along = dot(spring.normal, way);
      sum += spring.stiffness * (tied(spring) ? squaredNorm(way) : along * along);
    }
    return sum;
  }

  // One round at a fixed eps.
  void minimise(double eps, lbfgsfloatval_t* x) {
    eps_ = eps;
    lbfgs_parameter_t settings;
    lbfgs_parameter_init(&settings);
    settings.m = kPairs;
    settings.max_iterations = settings_.stepsARound;
    settings.epsilon = 1e-6;
    if (settings_.leastStepGain > 0) {
      settings.past = kStepsLookedAt;
      settings.delta = settings_.leastStepGain;
    }
    // Beyond the wall that the energy then is, its values tell nothing: only shorter steps help.
    if (eps <= kSmallest) settings.linesearch = LBFGS_LINESEARCH_BACKTRACKING_WOLFE;
    // What it returns says no more than x does: the round ended by its steps, or no line search
    // gained anything.
    lbfgs(static_cast<int>(size()), x, nullptr, &evaluate, &keepOn, this, &settings);
    write(x);
    throwIfCancelled();
  }

 private:
  struct Corner {
    std::size_t tet, corner;
  };

  // In every direction, not along a normal alone.
  static bool tied(const Spring& spring) { return !(squaredNorm(spring.normal) > 0); }

  template <class Visit>
  void forCorners(const Visit& visit) const {
    for (std::size_t t = 0; t < patch_.tets.size(); ++t)
      for (std::size_t c = 0; c < 4; ++c)
        if (const int u = unknownOf_[static_cast<std::size_t>(patch_.tets[t][c])]; u >= 0)
          visit(static_cast<std::size_t>(u), Corner{t, c});
  }

  void addSprings(lbfgsfloatval_t* g) const {
    for (const Spring& spring : patch_.springs) {
      const int u = unknownOf_[static_cast<std::size_t>(spring.vertex)];
      if (u < 0) continue;
      const Vec3 way = patch_.vertices[spring.vertex] - spring.place;
      const Vec3 pull =
          2 * spring.stiffness * (tied(spring) ? way : dot(spring.normal, way) * spring.normal);
      for (int k = 0; k < 3; ++k) g[3 * u + k] += pull[k];
    }
  }

  double of(std::size_t t, double eps) {
    const Mat3 j = jacobianOf(patch_, t);
    const double det = determinant(j);
    const Lifted chi(det, eps);
    double squares = 0;
    for (const auto& row : j)
      for (const double x : row) squares += x * x;
    const double weight = patch_.weights.empty() ? 1.0 : patch_.weights[t];
    const double root = std::cbrt(chi.value), shape = 1 / (root * root),
                 size = (1 + det * det) / chi.value;
    const double byDet =
        -2.0 / 3 * squares * shape / chi.value * chi.slope +
        settings_.volumeShare * (2 * det / chi.value - size / chi.value * chi.slope);
    Mat3 byJ = cofactors(j);
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t c = 0; c < 3; ++c) byJ[r][c] = byDet * byJ[r][c] + 2 * shape * j[r][c];
    const Mat3 byEdges = product(byJ, transposed(patch_.rest[t]));
    std::array<Vec3, 4>& force = forces_[t];
    force[0] = {};
    for (std::size_t e = 0; e < 3; ++e) {
      force[e + 1] = weight * Vec3{byEdges[0][e], byEdges[1][e], byEdges[2][e]};
      force[0] += -1.0 * force[e + 1];
    }
    return weight * (squares * shape + settings_.volumeShare * size);
  }

  static lbfgsfloatval_t evaluate(void* self, const lbfgsfloatval_t* x, lbfgsfloatval_t* g, int,
                                  lbfgsfloatval_t) {
    Energy& energy = *static_cast<Energy*>(self);
    energy.write(x);
    const double value = energy.at(energy.eps_);
    parallelBlocks(
        energy.unknowns_.size(), kVerticesABlock, [&](std::size_t begin, std::size_t end) {
          for (std::size_t u = begin; u < end; ++u) {
            Vec3 sum;
            for (std::size_t i = energy.firstCorner_[u]; i < energy.firstCorner_[u + 1]; ++i)
              sum += energy.forces_[energy.corners_[i].tet][energy.corners_[i].corner];
            for (int k = 0; k < 3; ++k) g[3 * u + static_cast<std::size_t>(k)] = sum[k];
          }
        });
    energy.addSprings(g);
    return value;
  }

  // No exception may pass through the optimiser, which is C.
  static int keepOn(void*, const lbfgsfloatval_t*, const lbfgsfloatval_t*, lbfgsfloatval_t,
                    lbfgsfloatval_t, lbfgsfloatval_t, lbfgsfloatval_t, int, int, int) {
    const RunContext* run = currentRun();
    return run && (run->cancelled() || outOfTime()) ? 1 : 0;
  }

  TetPatch& patch_;
  const UntangleSettings& settings_;
  std::vector<int> unknowns_;                // vertices
  std::vector<int> unknownOf_;               // each vertex, or -1
  std::vector<Corner> corners_;              // of tetrahedra, at one unknown after the other
  std::vector<std::size_t> firstCorner_;     // of each unknown
  std::vector<std::array<Vec3, 4>> forces_;  // derivatives by the corners
  double eps_ = 1;
};

}  // namespace

namespace {

Mat3 edgesOf(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  Mat3 edges;
  for (std::size_t r = 0; r < 3; ++r) {
    const int axis = static_cast<int>(r);
    edges[r] = {b[axis] - a[axis], c[axis] - a[axis], d[axis] - a[axis]};
  }
  return edges;
}

}  // namespace

Mat3 inverseEdges(const std::array<Vec3, 4>& c) { return inverse(edgesOf(c[0], c[1], c[2], c[3])); }

Mat3 jacobianOf(const std::array<Vec3, 4>& c, const Mat3& rest) {
  return product(edgesOf(c[0], c[1], c[2], c[3]), rest);
}

Mat3 jacobianOf(const TetPatch& patch, std::size_t tet) {
  const std::array<int, 4>& t = patch.tets[tet];
  const Points& v = patch.vertices;
  return product(edgesOf(v[t[0]], v[t[1]], v[t[2]], v[t[3]]), patch.rest[tet]);
}

double untangle(TetPatch& patch, const UntangleSettings& settings) {
  Energy energy(patch, settings);
  double least = energy.leastDeterminant();
  if (energy.size() == 0) return least;
  const std::unique_ptr<lbfgsfloatval_t, LbfgsFree> x(
      lbfgs_malloc(static_cast<int>(energy.size())));
  if (!x) throw std::bad_alloc();
  energy.read(x.get());
  double eps = settings.keep && least > 0 ? kSmallest : 1;
  for (int round = 0; round < settings.rounds; ++round) {
    const double before = energy.at(eps);
    energy.minimise(eps, x.get());
    const double gain = 1 - energy.at(eps) / before;
    least = energy.leastDeterminant();
    if ((least > 0 && gain < kLeastGain) || outOfTime()) break;
    const double mu = (1 - std::max(gain, settings.leastSigma)) * Lifted(least, eps).value;
    eps = least < mu ? 2 * std::sqrt(mu * (mu - least)) : kSmallest;
    if (settings.afterRound) settings.afterRound(patch, round);
  }
  return least;
}

}  // namespace innermap
