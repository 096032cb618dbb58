#include "surface/detail/handles/cut_handles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <unordered_map>

#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "surface/detail/topology/half_edges.h"
#include "surface/detail/topology/homology.h"
#include "surface/detail/topology/knot.h"
#include "surface/detail/topology/meridians.h"
#include "surface/detail/topology/shortest_meridian.h"

namespace innermap {
namespace {

using Barycentric = std::array<double, 3>;
constexpr int kRefinements = 2;
constexpr double kLongest = 3;  // of further loops, in the longest of those needed

Barycentric between(const Barycentric& a, const Barycentric& b, double f) {
  Barycentric out;
  for (std::size_t k = 0; k < 3; ++k) out[k] = (1 - f) * a[k] + f * b[k];
  return out;
}

CutSurface uncut(const ClosedSurface& surface) {
  CutSurface out;
  out.surface = surface;
  for (std::size_t v = 0; v < surface.vertices.size(); ++v)
    out.vertexOf.push_back(static_cast<int>(v));
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    out.triangleOf.push_back(static_cast<int>(t));
  out.cornerIn.assign(surface.triangles.size(), {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}});
  return out;
}

// Each triangle cut in four.
CutSurface finer(const CutSurface& coarse) {
  CutSurface out = coarse;
  out.surface.triangles.clear();
  out.triangleOf.clear();
  out.cornerIn.clear();
  std::map<std::pair<int, int>, int> middles;
  const auto middle = [&](int a, int b) {
    const auto [found, isNew] =
        middles.try_emplace(std::minmax(a, b), static_cast<int>(out.vertexOf.size()));
    if (isNew) {
      out.surface.vertices.push_back(0.5 * (out.surface.vertices[a] + out.surface.vertices[b]));
      out.vertexOf.push_back(-1);
    }
    return found->second;
  };
  for (std::size_t t = 0; t < coarse.surface.triangles.size(); ++t) {
    const Triangle& tri = coarse.surface.triangles[t];
    const auto& in = coarse.cornerIn[t];
    std::array<int, 3> m;
    std::array<Barycentric, 3> mid;
    for (std::size_t k = 0; k < 3; ++k) {
      m[k] = middle(tri[k], tri[(k + 1) % 3]);
      mid[k] = between(in[k], in[(k + 1) % 3], 0.5);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      out.surface.triangles.push_back({tri[k], m[k], m[(k + 2) % 3]});
      out.cornerIn.push_back({in[k], mid[k], mid[(k + 2) % 3]});
    }
    out.surface.triangles.push_back({m[0], m[1], m[2]});
    out.cornerIn.push_back(mid);
    out.triangleOf.insert(out.triangleOf.end(), 4, coarse.triangleOf[t]);
  }
  return out;
}

int addVertex(CutSurface& cut, const Vec3& position, int original) {
  cut.surface.vertices.push_back(position);
  cut.vertexOf.push_back(original);
  return static_cast<int>(cut.surface.vertices.size()) - 1;
}

// The triangles to the right of the loop get vertices of their own.
void cutLoop(CutSurface& cut, const HalfEdges& edges, const Loop& loop) {
  CutHandle handle;
  std::vector<Triangle> renamed = cut.surface.triangles;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const int out = loop[i], in = loop[(i + loop.size() - 1) % loop.size()];
    const int v = edges.tail(out);
    const int copy = addVertex(cut, cut.surface.vertices[v], cut.vertexOf[v]);
    for (int h = out; h != edges.opposite(in);) {
      h = edges.clockwise(h);
      renamed[static_cast<std::size_t>(h / 3)][static_cast<std::size_t>(h % 3)] = copy;
    }
    handle.loop[0].push_back(v);
    handle.loop[1].push_back(copy);
  }
  // `edges` keeps looking at the triangles as they are: all loops are cut before caps are made.
  cut.handles.push_back(std::move(handle));
  cut.surface.triangles = std::move(renamed);
}

void cap(CutSurface& cut, CutHandle& handle) {
  Vec3 mean;
  double length = 0;
  const std::vector<int>& loop = handle.loop[0];
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec3 &p = cut.surface.vertices[loop[i]],
               &q = cut.surface.vertices[loop[(i + 1) % loop.size()]];
    mean += norm(q - p) * (0.5 * (p + q));
    length += norm(q - p);
  }
  mean = length > 0 ? mean / length : cut.surface.vertices[loop[0]];
  for (std::size_t side = 0; side < 2; ++side) {
    const int centre = handle.centre[side] = addVertex(cut, mean, -1);
    const std::vector<int>& rim = handle.loop[side];
    for (std::size_t i = 0; i < rim.size(); ++i) {
      int from = rim[i], to = rim[(i + 1) % rim.size()];
      if (side == 0) std::swap(from, to);
      cut.surface.triangles.push_back({from, to, centre});
      cut.triangleOf.push_back(-1);
      cut.cornerIn.push_back({{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}});
    }
  }
}

struct Meridians {
  std::vector<Loop> loops;
  IntegerMatrix classes;
};

bool boundsDisc(const ClosedSurface& surface, const HalfEdges& edges, const Loop& loop) {
  Points polygon;
  for (const int h : loop) polygon.push_back(surface.vertices[edges.tail(h)]);
  return !isKnotted(polygon);
}

// Fewer than handles where edges leave no room.
Meridians disjointMeridians(const ClosedSurface& surface, const HalfEdges& edges) {
  const HomologyBasis basis = homologyBasis(surface, edges);
  const std::size_t handles = basis.size() / 2, most = std::max(handles, 3 * handles - 3);
  MeridianQuery query;
  if (handles > 0) query.bounding = boundingClasses(surface, edges, basis).inside;
  query.blocked.assign(surface.vertices.size(), 0);
  Meridians out;
  double longest = 0;
  while (out.loops.size() < most && handles > 0) {
    reportProgress("cutting handles",
                   static_cast<double>(out.loops.size()) / static_cast<double>(most));
    query.independent = out.loops.size() < handles;
    query.longest = query.independent ? 0 : kLongest * longest;
    MeridianLoop found = shortestMeridian(surface.vertices, edges, basis, query);
    if (found.loop.empty()) break;
    for (const int h : found.loop) query.blocked[edges.tail(h)] = 1;
    query.taken.push_back(found.cycle);
    if (!boundsDisc(surface, edges, found.loop)) {
      if (!query.independent) continue;
      const Vec3& p = surface.vertices[edges.tail(found.loop[0])];
      throw DataError(fmt::format(
          "{}: its handles are knotted or linked near ({:.6g}, {:.6g}, {:.6g}): the loop there "
          "that should bound a disc inside the solid is a knot; such solids cannot be mapped",
          surface.name, p.x, p.y, p.z));
    }
    longest = std::max(longest, found.length);
    out.loops.push_back(std::move(found.loop));
    out.classes.push_back(std::move(found.cycle));
  }
  return out;
}

}  // namespace

HandleLoops handleLoops(const ClosedSurface& surface) {
  HandleLoops out;
  out.uncut = uncut(surface);
  out.handles = static_cast<std::size_t>(surface.genus);
  for (int refinement = 0;; ++refinement) {
    const HalfEdges edges(out.uncut.surface.triangles);
    const Meridians found = disjointMeridians(out.uncut.surface, edges);
    if (found.loops.size() >= out.handles) {
      for (const Loop& loop : found.loops) {
        out.loops.emplace_back();
        for (const int h : loop) out.loops.back().push_back(edges.tail(h));
      }
      out.classes = found.classes;
      return out;
    }
    if (refinement == kRefinements)
      throw DataError(fmt::format(
          "{}: only {} of its {} handles can be cut open by discs inside the solid; the others "
          "are knotted or linked, or the surface passes through itself (see `innermap check`)",
          surface.name, found.loops.size(), out.handles));
    out.uncut = finer(out.uncut);
  }
}

CutSurface cutAlong(const HandleLoops& loops, const std::vector<int>& chosen) {
  CutSurface cut = loops.uncut;
  const HalfEdges edges(loops.uncut.surface.triangles);
  const std::vector<int> outgoing = edges.outgoing(cut.surface.vertices.size());
  for (const int number : chosen) {
    const std::vector<int>& vertices = loops.loops[static_cast<std::size_t>(number)];
    Loop loop;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      int h = outgoing[vertices[i]];
      while (edges.head(h) != vertices[(i + 1) % vertices.size()]) h = edges.counterclockwise(h);
      loop.push_back(h);
    }
    cutLoop(cut, edges, loop);
  }
  for (CutHandle& handle : cut.handles) cap(cut, handle);
  cut.surface.genus = 0;
  return cut;
}

void splitEdges(CutSurface& cut, Layout& layout, const std::vector<EdgeSplit>& splits) {
  std::vector<Triangle>& triangles = cut.surface.triangles;
  const auto key = [](int from, int to) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(from)) << 32 |
           static_cast<std::uint32_t>(to);
  };
  std::unordered_map<std::uint64_t, int> triangleAt;
  const auto enter = [&](int t) {
    const Triangle& tri = triangles[static_cast<std::size_t>(t)];
    for (std::size_t k = 0; k < 3; ++k) triangleAt[key(tri[k], tri[(k + 1) % 3])] = t;
  };
  for (std::size_t t = 0; t < triangles.size(); ++t) enter(static_cast<int>(t));
  for (const EdgeSplit& split : splits) {
    const Vec3 &p = cut.surface.vertices[split.from], &q = cut.surface.vertices[split.to];
    const int middle = addVertex(cut, (1 - split.fraction) * p + split.fraction * q, -1);
    const Vec3 place =
        (1 - split.fraction) * layout.place[split.from] + split.fraction * layout.place[split.to];
    layout.place.push_back(place / norm(place));
    for (const bool forward : {true, false}) {
      const int from = forward ? split.from : split.to, to = forward ? split.to : split.from;
      const auto found = triangleAt.find(key(from, to));
      if (found == triangleAt.end())
        throw DataError(cut.surface.name + ": an edge to be split is not there");
      const auto t = static_cast<std::size_t>(found->second);
      triangleAt.erase(found);
      std::size_t k = 0;
      while (triangles[t][k] != from) ++k;
      const std::size_t next = (k + 1) % 3;
      const Barycentric in = between(cut.cornerIn[t][k], cut.cornerIn[t][next],
                                     forward ? split.fraction : 1 - split.fraction);
      triangles.push_back(triangles[t]);
      cut.triangleOf.push_back(cut.triangleOf[t]);
      cut.cornerIn.push_back(cut.cornerIn[t]);
      triangles[t][next] = triangles.back()[k] = middle;
      cut.cornerIn[t][next] = cut.cornerIn.back()[k] = in;
      enter(static_cast<int>(t));
      enter(static_cast<int>(triangles.size()) - 1);
    }
  }
}

Vec3 placeOnSphere(const ClosedSurface& surface, const Layout& layout, const SurfacePoint& point) {
  Vec3 sum;
  for (std::size_t k = 0; k < 3; ++k)
    sum += point.barycentric[k] *
           layout.place[surface.triangles[static_cast<std::size_t>(point.triangle)][k]];
  return sum / std::max(norm(sum), 1e-300);
}

std::vector<SurfacePoint> onCut(const CutSurface& cut, const std::vector<SurfacePoint>& points) {
  std::unordered_map<int, std::vector<std::size_t>> parts;
  for (const SurfacePoint& p : points) parts[p.triangle];
  for (std::size_t t = 0; t < cut.triangleOf.size(); ++t) {
    const auto found = parts.find(cut.triangleOf[t]);
    if (found != parts.end()) found->second.push_back(t);
  }
  std::vector<SurfacePoint> out;
  for (const SurfacePoint& p : points) {
    SurfacePoint best;
    double inside = -std::numeric_limits<double>::infinity();
    for (const std::size_t t : parts[p.triangle]) {
      const auto& c = cut.cornerIn[t];
      const auto vec = [](const Barycentric& b) { return Vec3{b[0], b[1], b[2]}; };
      const Mat3 rows = {c[0], c[1], c[2]};
      const Vec3 w = inverse(transposed(rows)) * vec(p.barycentric);
      const double least = std::min({w.x, w.y, w.z});
      if (!(least > inside)) continue;
      inside = least;
      Vec3 in{std::max(w.x, 0.0), std::max(w.y, 0.0), std::max(w.z, 0.0)};
      in = in / (in.x + in.y + in.z);
      best = {static_cast<int>(t), {in.x, in.y, in.z}};
    }
    out.push_back(best);
  }
  return out;
}

std::vector<SurfacePoint> onUncut(const CutSurface& cut, const std::vector<SurfacePoint>& points) {
  const HalfEdges edges(cut.surface.triangles);
  std::vector<SurfacePoint> out;
  out.reserve(points.size());
  for (const SurfacePoint& point : points) {
    auto t = static_cast<std::size_t>(point.triangle);
    Barycentric w = point.barycentric;
    if (cut.triangleOf[t] < 0) {
      // The rim is the side whose other triangle is in no cap.
      int rim = 3 * point.triangle;
      while (cut.triangleOf[static_cast<std::size_t>(edges.opposite(rim) / 3)] < 0)
        rim = HalfEdges::next(rim);
      const double from = w[static_cast<std::size_t>(rim % 3)],
                   to = w[static_cast<std::size_t>(HalfEdges::next(rim) % 3)];
      const double share = from + to > 0 ? to / (from + to) : 0.5;
      const int other = edges.opposite(rim);
      t = static_cast<std::size_t>(other / 3);
      w = {0, 0, 0};
      w[static_cast<std::size_t>(other % 3)] = share;
      w[static_cast<std::size_t>(HalfEdges::next(other) % 3)] = 1 - share;
    }
    SurfacePoint image{cut.triangleOf[t], {0, 0, 0}};
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t c = 0; c < 3; ++c) image.barycentric[c] += w[k] * cut.cornerIn[t][k][c];
    out.push_back(image);
  }
  return out;
}

}  // namespace innermap
