#include "mesh/winding_number.h"

#include <array>
#include <mutex>
#include <utility>

#include "core/pi.h"
#include "mesh/detail/local_triangles.h"
#include "mesh/detail/ray_crossings.h"
#include "mesh/triangle_tree.h"

namespace innermap {
namespace {

// Clusters farther than this many radii are expanded.
constexpr double kBeta = 2.1;

// Complex number whose argument is half the solid angle of a triangle seen from the origin
// (van Oosterom and Strackee 1983).
struct HalfAngle {
  double re = 1, im = 0;
};

HalfAngle halfAngle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double la = norm(a), lb = norm(b), lc = norm(c);
  // a . (b x c) about one corner: the differences are exact where the point is near.
  const double im = dot(a, cross(b - a, c - a));
  const double re = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
  return {re, im};
}

// Adds up half angles as a product of complex numbers, with one arctangent at the end; whole turns
// are counted apart.
class AngleSum {
 public:
  void add(const HalfAngle& h) {
    const double size = std::max(std::abs(h.re), std::abs(h.im));
    if (!(size > 0)) return;
    const double re = h.re / size, im = h.im / size;
    const double newRe = re_ * re - im_ * im, newIm = re_ * im + im_ * re;
    // Two arguments of the same sign whose sum has the other sign went past half a turn.
    if (im_ >= 0 && im >= 0 && newIm < 0) ++turns_;
    if (im_ < 0 && im < 0 && newIm >= 0) --turns_;
    re_ = newRe;
    im_ = newIm;
    if (++count_ == 256) {
      rest_ += std::atan2(im_, re_);
      re_ = 1;
      im_ = 0;
      count_ = 0;
    }
  }
  double angle() const { return rest_ + std::atan2(im_, re_) + 2 * kPi * turns_; }

 private:
  double re_ = 1, im_ = 0, rest_ = 0;
  int turns_ = 0, count_ = 0;
};

// Moments of a set of triangles about `center`, to the second order. The kernel is harmonic, so
// only symmetric, trace-free parts of the moments count.
struct Expansion {
  double center[3]{};     // double: small clusters stand anywhere
  float openRadius2 = 0;  // squared distance from which the expansion holds
  float dipole[3]{};
  float second[6]{};  // xx yy zz xy xz yz; the off-diagonal ones count twice
  float third[10]{};  // xxx yyy zzz xxy xxz xyy yyz xzz yzz xyz, multiplicities included

  // Solid angle seen from a point; d from the point to the center, r2 its squared length. Powers
  // of the distance are taken of the unit vector, or small clusters would underflow.
  float at(float dx, float dy, float dz, float r2) const {
    const float inverse = 1 / std::sqrt(r2);
    const float x = dx * inverse, y = dy * inverse, z = dz * inverse;
    const float xx = x * x, yy = y * y, zz = z * z;
    const float one = dipole[0] * x + dipole[1] * y + dipole[2] * z;
    const float two = second[0] * xx + second[1] * yy + second[2] * zz + second[3] * x * y +
                      second[4] * x * z + second[5] * y * z;
    const float three = x * (third[0] * xx + third[5] * yy + third[7] * zz) +
                        y * (third[1] * yy + third[3] * xx + third[8] * zz) +
                        z * (third[2] * zz + third[4] * xx + third[6] * yy) + third[9] * x * y * z;
    return inverse * inverse * (one + inverse * (two + inverse * three));
  }
};

// Sums over one node's triangles, in double, about the node's centre.
struct Moments {
  Vec3 center;
  Vec3 normal;               // sum of area vectors
  double first[3][3]{};      // [i][j]: sum of n_i times the mean of x_j
  double second[3][3][3]{};  // [i][j][k]: sum of n_i times the mean of x_j x_k

  void add(const LocalTriangles::Corners& t) {
    const Vec3 n = 0.5 * cross(t.b - t.a, t.c - t.a);
    const Vec3 a = t.a - center, b = t.b - center, c = t.c - center;
    const Vec3 m = (a + b + c) / 3;
    normal += n;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        first[i][j] += n[i] * m[j];
        for (int k = 0; k < 3; ++k) {
          // Mean over a triangle: (9 m_j m_k + sum over corners of v_j v_k) / 12.
          second[i][j][k] +=
              n[i] * (9 * m[j] * m[k] + a[j] * a[k] + b[j] * b[k] + c[j] * c[k]) / 12;
        }
      }
    }
  }

  void add(const Moments& child) {
    const Vec3 d = child.center - center;
    normal += child.normal;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        first[i][j] += child.first[i][j] + child.normal[i] * d[j];
        for (int k = 0; k < 3; ++k) {
          second[i][j][k] += child.second[i][j][k] + child.first[i][j] * d[k] +
                             child.first[i][k] * d[j] + child.normal[i] * d[j] * d[k];
        }
      }
    }
  }
};

void setSecond(const double (&m)[3][3], Expansion& e) {
  const double trace = (m[0][0] + m[1][1] + m[2][2]) / 3;
  for (int i = 0; i < 3; ++i) e.second[i] = static_cast<float>(-3 * (m[i][i] - trace));
  e.second[3] = static_cast<float>(-3 * (m[0][1] + m[1][0]));
  e.second[4] = static_cast<float>(-3 * (m[0][2] + m[2][0]));
  e.second[5] = static_cast<float>(-3 * (m[1][2] + m[2][1]));
}

void setThird(const double (&t)[3][3][3], Expansion& e) {
  const auto sym = [&](int i, int j, int k) {
    // t is symmetric in its last two indices already.
    return (t[i][j][k] + t[j][i][k] + t[k][i][j]) / 3;
  };
  double trace[3];
  for (int i = 0; i < 3; ++i) trace[i] = (sym(0, 0, i) + sym(1, 1, i) + sym(2, 2, i)) / 5;
  const auto free = [&](int i, int j, int k) {
    return sym(i, j, k) - (i == j ? trace[k] : 0) - (i == k ? trace[j] : 0) -
           (j == k ? trace[i] : 0);
  };
  const double f = 7.5;  // 15 / 2!
  const auto set = [&](int slot, double multiplicity, int i, int j, int k) {
    e.third[slot] = static_cast<float>(f * multiplicity * free(i, j, k));
  };
  for (int i = 0; i < 3; ++i) set(i, 1, i, i, i);
  set(3, 3, 0, 0, 1);
  set(4, 3, 0, 0, 2);
  set(5, 3, 0, 1, 1);
  set(6, 3, 1, 1, 2);
  set(7, 3, 0, 2, 2);
  set(8, 3, 1, 2, 2);
  set(9, 6, 0, 1, 2);
}

Expansion expansionOf(const Moments& m) {
  Expansion e;
  for (int a = 0; a < 3; ++a) {
    e.center[a] = m.center[a];
    e.dipole[a] = static_cast<float>(m.normal[a]);
  }
  setSecond(m.first, e);
  setThird(m.second, e);
  return e;
}

}  // namespace

struct WindingNumber::Implementation {
  const std::shared_ptr<const LocalTriangles> local;
  const LocalFrame& frame = local->frame;
  const Bvh& bvh = local->bvh;
  const std::vector<LocalTriangles::Corners>& triangles = local->corners;
  const bool balanced;  // see isBalanced()
  mutable std::once_flag expanded;
  mutable std::vector<Expansion> expansions;  // one a node

  Implementation(std::shared_ptr<const LocalTriangles> shared, const std::vector<Triangle>& given)
      : local(std::move(shared)),
        balanced(local->index.size() == given.size() && isBalanced(given)) {}

  void expand() const {
    const Points centers = areaCentroids();
    expansions.resize(bvh.nodes.size());
    std::vector<Moments> moments(bvh.nodes.size());
    // Children stand behind their parents.
    for (std::size_t n = bvh.nodes.size(); n-- > 0;) {
      const Bvh::Node& node = bvh.nodes[n];
      moments[n].center = centers[n];
      if (node.leaf()) {
        for (int i = node.first; i < node.first + node.count; ++i) moments[n].add(triangles[i]);
      } else {
        moments[n].add(moments[node.first]);
        moments[n].add(moments[node.first + 1]);
      }
      expansions[n] = expansionOf(moments[n]);
    }
    setRadii();
  }

  Points areaCentroids() const {
    Points centers(bvh.nodes.size());
    std::vector<double> area(bvh.nodes.size(), 0);
    for (std::size_t n = bvh.nodes.size(); n-- > 0;) {
      const Bvh::Node& node = bvh.nodes[n];
      Vec3 weighted;
      if (node.leaf()) {
        for (int i = node.first; i < node.first + node.count; ++i) {
          const auto& [a, b, c] = triangles[i];
          const double size = norm(cross(b - a, c - a));
          area[n] += size;
          weighted += size * ((a + b + c) / 3);
        }
      } else {
        for (const int child : {node.first, node.first + 1}) {
          area[n] += area[child];
          weighted += area[child] * centers[child];
        }
      }
      const Vec3 lower{node.lower[0], node.lower[1], node.lower[2]};
      const Vec3 upper{node.upper[0], node.upper[1], node.upper[2]};
      centers[n] = area[n] > 0 ? weighted / area[n] : 0.5 * (lower + upper);
    }
    return centers;
  }

  // Exact radii of leaves; of inner nodes the lesser of what the children and what the box give.
  void setRadii() const {
    std::vector<double> radius(bvh.nodes.size(), 0);
    for (std::size_t n = bvh.nodes.size(); n-- > 0;) {
      const Bvh::Node& node = bvh.nodes[n];
      const Vec3 o = centerOf(n);
      double corner2 = 0;
      for (int a = 0; a < 3; ++a) {
        const double d = std::max(o[a] - node.lower[a], node.upper[a] - o[a]);
        corner2 += d * d;
      }
      double r = 0;
      if (node.leaf()) {
        for (int i = node.first; i < node.first + node.count; ++i) {
          for (const Vec3& v : {triangles[i].a, triangles[i].b, triangles[i].c}) {
            r = std::max(r, norm(v - o));
          }
        }
      } else {
        for (const int child : {node.first, node.first + 1}) {
          r = std::max(r, norm(centerOf(child) - o) + radius[child]);
        }
      }
      radius[n] = std::min(r, std::sqrt(corner2));
      // At least 1e-8, so that no power of the distance leaves float's range.
      const double open = std::max(1.0001 * kBeta * radius[n], 1e-8);
      expansions[n].openRadius2 = static_cast<float>(open * open);
    }
  }

  Vec3 centerOf(std::size_t node) const {
    const double* c = expansions[node].center;
    return {c[0], c[1], c[2]};
  }

  double at(const Vec3& world) const {
    if (bvh.nodes.empty() || !isFinite(world)) return 0;
    std::call_once(expanded, [&] { expand(); });
    const Vec3 p = frame.toLocal(world);
    AngleSum near;
    double far = 0;
    std::array<int, Bvh::kMaxDepth + 2> stack;
    int top = 0;
    stack[top++] = 0;
    while (top > 0) {
      const int n = stack[--top];
      const Expansion& e = expansions[n];
      const float dx = static_cast<float>(e.center[0] - p.x);
      const float dy = static_cast<float>(e.center[1] - p.y);
      const float dz = static_cast<float>(e.center[2] - p.z);
      const float r2 = dx * dx + dy * dy + dz * dz;
      if (r2 > e.openRadius2) {
        far += e.at(dx, dy, dz, r2);
        continue;
      }
      const Bvh::Node& node = bvh.nodes[n];
      if (node.leaf()) {
        for (int i = node.first; i < node.first + node.count; ++i) {
          near.add(halfAngle(triangles[i].a - p, triangles[i].b - p, triangles[i].c - p));
        }
      } else {
        stack[top++] = node.first + 1;
        stack[top++] = node.first;
      }
    }
    return (2 * near.angle() + far) / (4 * kPi);
  }

  double exactAt(const Vec3& world) const {
    const Vec3 p = frame.toLocal(world);
    double sum = 0;
    for (const auto& [a, b, c] : triangles) {
      const HalfAngle h = halfAngle(a - p, b - p, c - p);
      sum += std::atan2(h.im, h.re);
    }
    return sum / (2 * kPi);
  }
};

WindingNumber::WindingNumber(const Points& vertices, const std::vector<Triangle>& triangles)
    : implementation_(std::make_shared<const Implementation>(
          std::make_shared<const LocalTriangles>(vertices, triangles), triangles)) {}

WindingNumber::WindingNumber(const TriangleTree& tree, const std::vector<Triangle>& triangles)
    : implementation_(std::make_shared<const Implementation>(tree.local(), triangles)) {}

double WindingNumber::at(const Vec3& p) const { return implementation_->at(p); }

int WindingNumber::wholeAt(const Vec3& p) const {
  const Implementation& i = *implementation_;
  if (!isFinite(p)) return 0;
  const std::optional<int> counted =
      i.balanced ? rayCrossings(*i.local, i.frame.toLocal(p)) : std::nullopt;
  return counted ? *counted : static_cast<int>(std::lround(at(p)));
}

double WindingNumber::exactAt(const Vec3& p) const { return implementation_->exactAt(p); }

}  // namespace innermap
