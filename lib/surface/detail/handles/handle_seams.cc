#include <algorithm>
#include <cmath>
#include <limits>

#include "surface/detail/handles/match_handles.h"
#include "surface/detail/sphere/rotation_search.h"
#include "surface/detail/topology/half_edges.h"

namespace innermap {
namespace {

constexpr int kPhases = 256;
constexpr double kJoin = 0.15;  // of the shorter edge beside: vertices nearer than this coincide

// Where each vertex of a rim lies along it: shares of its length, the first 0.
std::vector<double> shares(const Points& vertices, const std::vector<int>& rim) {
  std::vector<double> at{0};
  for (std::size_t i = 0; i < rim.size(); ++i)
    at.push_back(at.back() + norm(vertices[rim[(i + 1) % rim.size()]] - vertices[rim[i]]));
  const double length = at.back();
  at.pop_back();
  // A rim of no length: by number.
  for (std::size_t i = 0; i < at.size(); ++i)
    at[i] = length > 0 ? at[i] / length : static_cast<double>(i) / static_cast<double>(at.size());
  // Vertices at one place are told apart.
  const double least = 1e-4 / static_cast<double>(at.size());
  for (std::size_t i = 1; i < at.size(); ++i) at[i] = std::max(at[i], at[i - 1] + least);
  const double end = std::max(1.0, at.back() + least);
  for (double& s : at) s /= end;
  return at;
}

struct RimPoint {
  std::size_t edge = 0;  // from rim[edge] to the next
  double fraction = 0;
};

RimPoint pointAt(const std::vector<double>& at, double share) {
  share -= std::floor(share);
  const auto after = std::upper_bound(at.begin(), at.end(), share);
  const auto i = static_cast<std::size_t>(after - at.begin()) - 1;
  const double end = i + 1 < at.size() ? at[i + 1] : 1;
  return {i, std::clamp((share - at[i]) / (end - at[i]), 0.0, 1.0)};
}

Vec3 placeAt(const Layout& layout, const std::vector<int>& rim, const RimPoint& p) {
  const Vec3 x = (1 - p.fraction) * layout.place[rim[p.edge]] +
                 p.fraction * layout.place[rim[(p.edge + 1) % rim.size()]];
  return x / norm(x);
}

Vec3 unit(const Vec3& v) { return v / std::max(norm(v), 1e-300); }

// The rotation of least angle that takes one unit vector to another.
Mat3 leastRotation(const Vec3& from, const Vec3& to) {
  const Vec3 axis = cross(from, to);
  const double sine = norm(axis), angle = std::atan2(sine, dot(from, to));
  if (sine > 1e-12) return rotationAbout((angle / sine) * axis);
  if (angle < 1) return rotationAbout({});
  const Vec3 side = std::abs(from.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  return rotationAbout(angle * unit(cross(from, side)));
}

struct Rims {
  const CutHandle &a, &b;
  bool swapped;
  std::vector<double> atA, atB;

  std::size_t sideOfB(std::size_t side) const { return swapped ? 1 - side : side; }
  // Side 0 of both has the surface on its left: swapped, the rims run against one another.
  double onB(double share, double phase) const { return swapped ? phase - share : phase + share; }
};

double bestPhase(const Rims& rims, const Layout& la, const Layout& lb, const Mat3& rotation) {
  double best = 0, most = -std::numeric_limits<double>::infinity();
  std::array<Mat3, 2> turn;
  for (std::size_t side = 0; side < 2; ++side)
    turn[side] = product(leastRotation(rotation * la.place[rims.a.centre[side]],
                                       lb.place[rims.b.centre[rims.sideOfB(side)]]),
                         rotation);
  for (int step = 0; step < kPhases; ++step) {
    const double phase = static_cast<double>(step) / kPhases;
    double agreement = 0;
    for (std::size_t side = 0; side < 2; ++side) {
      const std::vector<int>&rimA = rims.a.loop[side], &rimB = rims.b.loop[rims.sideOfB(side)];
      const Vec3 &centreA = la.place[rims.a.centre[side]],
                 &centreB = lb.place[rims.b.centre[rims.sideOfB(side)]];
      for (std::size_t i = 0; i < rimA.size(); ++i) {
        const Vec3 from = unit(turn[side] * (la.place[rimA[i]] - centreA));
        const RimPoint p = pointAt(rims.atB, rims.onB(rims.atA[i], phase));
        agreement += dot(from, unit(placeAt(lb, rimB, p) - centreB));
      }
    }
    if (agreement > most) {
      most = agreement;
      best = phase;
    }
  }
  return best;
}

// A vertex of A's rim (or of one to be put in) and where it goes on B's.
struct Stop {
  double share = 0;  // along A's rim
  int vertexA = -1;  // number in A's rim, or -1
  int vertexB = -1;  // number in B's rim, or -1: between two
};

std::vector<Stop> stopsAlong(const Rims& rims, double phase) {
  std::vector<Stop> stops;
  for (std::size_t i = 0; i < rims.atA.size(); ++i)
    stops.push_back({rims.atA[i], static_cast<int>(i), -1});
  for (std::size_t j = 0; j < rims.atB.size(); ++j) {
    double share = rims.swapped ? phase - rims.atB[j] : rims.atB[j] - phase;
    share -= std::floor(share);
    stops.push_back({share, -1, static_cast<int>(j)});
  }
  std::stable_sort(stops.begin(), stops.end(),
                   [](const Stop& x, const Stop& y) { return x.share < y.share; });
  // A vertex of A and one of B that are neighbours and much nearer to one another than to their own
  // neighbours are one.
  const auto gap = [](const std::vector<double>& at, std::size_t i) {
    const std::size_t n = at.size();
    const double before = i > 0 ? at[i] - at[i - 1] : at[0] + 1 - at[n - 1];
    const double after = i + 1 < n ? at[i + 1] - at[i] : at[0] + 1 - at[i];
    return std::min(before, after);
  };
  const std::size_t n = stops.size();
  std::vector<char> gone(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t k = (i + 1) % n;
    if (gone[i] || gone[k] || (stops[i].vertexA >= 0) == (stops[k].vertexA >= 0)) continue;
    if (stops[i].vertexA >= 0 && stops[i].vertexB >= 0) continue;
    if (stops[k].vertexA >= 0 && stops[k].vertexB >= 0) continue;
    const std::size_t ofA = stops[i].vertexA >= 0 ? i : k, ofB = ofA == i ? k : i;
    double apart = stops[k].share - stops[i].share;
    if (k == 0) apart += 1;
    const double room = std::min(gap(rims.atA, static_cast<std::size_t>(stops[ofA].vertexA)),
                                 gap(rims.atB, static_cast<std::size_t>(stops[ofB].vertexB)));
    if (apart > kJoin * room) continue;
    stops[ofA].vertexB = stops[ofB].vertexB;
    gone[ofB] = 1;
  }
  std::vector<Stop> out;
  for (std::size_t i = 0; i < n; ++i)
    if (!gone[i]) out.push_back(stops[i]);
  // Beginning at A's first vertex.
  const auto first =
      std::find_if(out.begin(), out.end(), [](const Stop& s) { return s.vertexA == 0; });
  std::rotate(out.begin(), first, out.end());
  return out;
}

// Triangles of a surface by their corners, for points at vertices and on edges.
class PointsOn {
 public:
  explicit PointsOn(const ClosedSurface& surface)
      : edges_(surface.triangles), outgoing_(edges_.outgoing(surface.vertices.size())) {}

  SurfacePoint on(int from, int to, double fraction) const {
    int h = outgoing_[from];
    while (edges_.head(h) != to) h = edges_.counterclockwise(h);
    SurfacePoint p{h / 3, {0, 0, 0}};
    p.barycentric[static_cast<std::size_t>(h % 3)] = 1 - fraction;
    p.barycentric[static_cast<std::size_t>(HalfEdges::next(h) % 3)] = fraction;
    return p;
  }
  SurfacePoint at(int vertex) const { return on(vertex, edges_.head(outgoing_[vertex]), 0); }

 private:
  HalfEdges edges_;
  std::vector<int> outgoing_;
};

}  // namespace

SeamedSurface seamed(const CutSurface& a, const Layout& layoutOfA, const CutSurface& b,
                     const Layout& layoutOfB, const HandleMatch& match) {
  SeamedSurface out{a, layoutOfA, {}};
  const PointsOn pointsOnB(b.surface);
  for (std::size_t i = 0; i < a.handles.size(); ++i) {
    const CutHandle &ha = a.handles[i], &hb = b.handles[static_cast<std::size_t>(match.target[i])];
    const Rims rims{ha, hb, match.swapped[i] != 0, shares(a.surface.vertices, ha.loop[0]),
                    shares(b.surface.vertices, hb.loop[0])};
    const double phase = bestPhase(rims, layoutOfA, layoutOfB, match.rotation);
    const std::vector<Stop> stops = stopsAlong(rims, phase);
    for (std::size_t side = 0; side < 2; ++side) {
      const std::vector<int>&rimA = ha.loop[side], &rimB = hb.loop[rims.sideOfB(side)];
      std::vector<int>& rim = out.cut.handles[i].loop[side];
      rim.clear();
      std::vector<EdgeSplit> splits;
      int made = static_cast<int>(out.cut.surface.vertices.size());
      std::size_t last = 0;  // vertex of A before
      double done = 0;       // share where the edge still to be split begins
      for (const Stop& s : stops) {
        if (s.vertexA >= 0) {
          last = static_cast<std::size_t>(s.vertexA);
          done = rims.atA[last];
          rim.push_back(rimA[last]);
        } else {
          const double end = last + 1 < rimA.size() ? rims.atA[last + 1] : 1;
          const double share = s.share < rims.atA[last] ? s.share + 1 : s.share;
          splits.push_back({rim.back(), rimA[(last + 1) % rimA.size()],
                            std::clamp((share - done) / (end - done), 1e-6, 1 - 1e-6)});
          done = share;
          rim.push_back(made++);
        }
        const int v = rim.back();
        if (s.vertexB >= 0) {
          out.fixed.push_back({v, pointsOnB.at(rimB[static_cast<std::size_t>(s.vertexB)])});
        } else {
          const RimPoint p = pointAt(rims.atB, rims.onB(s.share, phase));
          out.fixed.push_back(
              {v, pointsOnB.on(rimB[p.edge], rimB[(p.edge + 1) % rimB.size()], p.fraction)});
        }
      }
      splitEdges(out.cut, out.layout, splits);
      out.fixed.push_back({ha.centre[side], pointsOnB.at(hb.centre[rims.sideOfB(side)])});
    }
  }
  return out;
}

}  // namespace innermap
