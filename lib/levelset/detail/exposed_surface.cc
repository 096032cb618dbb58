#include "levelset/detail/exposed_surface.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <unordered_map>

#include "core/disjoint_sets.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "mesh/connectivity.h"
#include "mesh/self_intersection.h"
#include "mesh/winding_number.h"

namespace innermap {
namespace {

constexpr std::size_t kMaxPieces = 1'500'000;

// Patches: sets of triangles that are connected over edges of exactly two triangles and that
// nothing cuts. The winding number is constant along either side of a patch. In ascending order of
// their first triangle.
std::vector<std::vector<int>> patchesOf(const std::vector<Triangle>& triangles,
                                        const std::vector<char>& cut) {
  DisjointSets sets(triangles.size());
  forEachEdge(sortedEdges(triangles), [&](const EdgeUse* begin, const EdgeUse* end) {
    if (end - begin == 2 && !cut[begin[0].triangle] && !cut[begin[1].triangle])
      sets.unite(begin[0].triangle, begin[1].triangle);
  });
  std::vector<std::vector<int>> patches;
  std::vector<int> slot(triangles.size(), -1);  // of a patch, by its first triangle
  for (int t = 0; t < static_cast<int>(triangles.size()); ++t) {
    if (cut[t]) continue;
    int& s = slot[sets.find(t)];
    if (s < 0) {
      s = static_cast<int>(patches.size());
      patches.emplace_back();
    }
    patches[s].push_back(t);
  }
  return patches;
}

struct Work {
  const Mesh& mesh;
  Points local;  // about the box's centre
  double diagonal;
  WindingNumber winding;
  std::vector<Side> sides;                 // of whole triangles
  std::vector<std::vector<Piece>> pieces;  // of cut triangles
};

double areaOf(const std::array<Vec3, 3>& corners) {
  return 0.5 * norm(cross(corners[1] - corners[0], corners[2] - corners[0]));
}

std::array<Vec3, 3> cornersOf(const Work& work, int t) {
  const auto [i, j, k] = work.mesh.triangles[t];
  return {work.local[i], work.local[j], work.local[k]};
}

void classifyPatches(Work& work, const std::vector<char>& cut) {
  const std::vector<std::vector<int>> patches = patchesOf(work.mesh.triangles, cut);
  std::vector<char> mixed(patches.size(), 0);
  const auto sideOf = [&](int t) {
    return classify(work.winding, cornersOf(work, t), work.diagonal);
  };
  parallelBlocks(patches.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      // The largest triangle and some spread over the patch.
      const std::vector<int>& members = patches[p];
      const auto area = [&](int t) { return norm(areaVector(work.mesh, t)); };
      const int largest = *std::max_element(members.begin(), members.end(),
                                            [&](int s, int t) { return area(s) < area(t); });
      const Side side = sideOf(largest);
      const double enough = 1e-6 * area(largest);  // slivers tell nothing
      const std::size_t step = std::max<std::size_t>(1, members.size() / 6);
      for (std::size_t i = step / 2; i < members.size(); i += step) {
        if (area(members[i]) >= enough && !(sideOf(members[i]) == side)) mixed[p] = 1;
      }
      for (const int t : members) work.sides[t] = side;
    }
  });
  // Something passes exactly along edges: each triangle for itself.
  for (std::size_t p = 0; p < patches.size(); ++p) {
    if (!mixed[p]) continue;
    parallelBlocks(patches[p].size(), 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) work.sides[patches[p][i]] = sideOf(patches[p][i]);
    });
  }
}

using Partners = std::vector<std::pair<int, std::vector<int>>>;  // triangle, those that cut it

Partners partnersOf(const TriangleTree& tree, const Points& vertices,
                    const std::vector<Triangle>& triangles) {
  std::vector<std::pair<int, int>> both;
  forEachSelfIntersection(tree, vertices, triangles, [&](const Crossing& c) {
    both.push_back({c.first, c.second});
    both.push_back({c.second, c.first});
  });
  std::sort(both.begin(), both.end());
  Partners partners;
  for (const auto& [t, other] : both) {
    if (partners.empty() || partners.back().first != t) partners.push_back({t, {}});
    partners.back().second.push_back(other);
  }
  return partners;
}

// False when more than kMaxPieces result.
bool splitAll(Work& work, const Partners& partners, double pieceLength) {
  std::atomic<std::size_t> count{0};
  parallelBlocks(partners.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end && count <= kMaxPieces; ++i) {
      std::vector<std::array<Vec3, 3>> others;
      for (const int other : partners[i].second) others.push_back(cornersOf(work, other));
      const int t = partners[i].first;
      work.pieces[t] =
          splitTriangle(cornersOf(work, t), others, pieceLength, 1e-12 * work.diagonal, kMaxPieces);
      count += work.pieces[t].size();
    }
  });
  return count <= kMaxPieces;
}

void classifyPieces(Work& work, const Partners& partners) {
  parallelBlocks(partners.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const int t = partners[i].first;
      const auto corners = cornersOf(work, t);
      std::vector<Piece>& pieces = work.pieces[t];
      for (std::size_t p = 0; p < pieces.size(); ++p) {
        if (p % 1024 == 0) throwIfCancelled();
        pieces[p].side = classify(work.winding, pieceTriangle(corners, pieces[p]), work.diagonal);
      }
      const bool alike = std::all_of(pieces.begin(), pieces.end(),
                                     [&](const Piece& p) { return p.side == pieces.front().side; });
      work.sides[t] = pieces.front().side;
      if (alike) pieces.clear();
    }
  });
}

// Sheets that lie on each other: a whole triangle whose winding number jumps by two or more is left
// out when an earlier such triangle has the same centroid.
void dropDoubles(const Work& work, ExposedSurface& result, std::vector<char>& dropped) {
  const double cell = 1e-7 * work.diagonal;
  using Cell = std::array<std::int64_t, 3>;
  const auto centroid = [&](int t) {
    const auto [a, b, c] = cornersOf(work, t);
    return (a + b + c) / 3;
  };
  const auto key = [](const Cell& c) {
    return (static_cast<std::uint64_t>(c[0]) * 0x9e3779b97f4a7c15u) ^
           (static_cast<std::uint64_t>(c[1]) * 0xd1342543de82ef95u) ^
           (static_cast<std::uint64_t>(c[2]) * 0xbf58476d1ce4e5b9u);
  };
  std::unordered_map<std::uint64_t, std::vector<int>> kept;
  std::vector<int> left(work.sides.size(), 0);  // covers beyond the first that no partner explains
  for (std::size_t i = 0; i < work.sides.size(); ++i) {
    const int t = static_cast<int>(i);
    for (const Piece& p : work.pieces[t]) {
      if (!p.side.exposed || p.side.covers < 2) continue;
      result.doubledArea += areaOf(pieceTriangle(cornersOf(work, t), p));
    }
    if (!work.pieces[t].empty() || !work.sides[t].exposed || work.sides[t].covers < 2) continue;
    const Vec3 m = centroid(t);
    Cell base;
    for (int a = 0; a < 3; ++a) base[a] = static_cast<std::int64_t>(std::floor(m[a] / cell));
    int partner = -1;
    for (int n = 0; n < 27; ++n) {
      const auto near =
          kept.find(key({base[0] + n % 3 - 1, base[1] + n / 3 % 3 - 1, base[2] + n / 9 - 1}));
      if (near == kept.end()) continue;
      for (const int s : near->second) {
        if (norm(centroid(s) - m) < cell) partner = s;
      }
    }
    if (partner >= 0) {
      dropped[t] = 1;
      --left[partner];
      result.whole = false;
    } else {
      left[t] = work.sides[t].covers - 1;
      kept[key(base)].push_back(t);
    }
  }
  for (std::size_t t = 0; t < left.size(); ++t) {
    if (left[t] > 0) result.doubledArea += norm(areaVector(work.mesh, static_cast<int>(t)));
  }
}

void addPiece(ExposedSurface& result, const Work& work, int parent, const Piece& piece,
              bool fresh) {
  PieceCorners corners = piece.corners;
  Triangle triangle = work.mesh.triangles[parent];
  if (fresh) {
    const auto [i, j, k] = work.mesh.triangles[parent];
    for (int c = 0; c < 3; ++c) {
      const auto& b = corners[c];
      triangle[c] = static_cast<int>(result.mesh.vertices.size());
      result.mesh.vertices.push_back(b[0] * work.mesh.vertices[i] + b[1] * work.mesh.vertices[j] +
                                     b[2] * work.mesh.vertices[k]);
    }
  }
  if (piece.side.reversed) {
    std::swap(triangle[1], triangle[2]);
    std::swap(corners[1], corners[2]);
  }
  result.mesh.triangles.push_back(triangle);
  result.parent.push_back(parent);
  result.corners.push_back(corners);
}

void assemble(const Work& work, const std::vector<char>& dropped, ExposedSurface& result) {
  result.mesh.name = work.mesh.name;
  result.mesh.vertices = work.mesh.vertices;
  for (std::size_t i = 0; i < work.sides.size(); ++i) {
    const int t = static_cast<int>(i);
    if (work.pieces[t].empty()) {
      if (dropped[t] || !work.sides[t].exposed) continue;
      Piece all;
      all.side = work.sides[t];
      addPiece(result, work, t, all, false);
      continue;
    }
    for (const Piece& piece : work.pieces[t]) {
      if (piece.side.exposed) addPiece(result, work, t, piece, true);
    }
  }
}

double negativeShareOf(const Work& work) {
  double all = 0, negative = 0;
  for (std::size_t t = 0; t < work.pieces.size(); ++t) {
    const auto corners = cornersOf(work, static_cast<int>(t));
    all += areaOf(corners);
    if (work.pieces[t].empty() && work.sides[t].negative) negative += areaOf(corners);
    for (const Piece& piece : work.pieces[t])
      if (piece.side.negative) negative += areaOf(pieceTriangle(corners, piece));
  }
  return all > 0 ? negative / all : 0;
}

}  // namespace

ExposedSurface exposedSurface(const Mesh& mesh, double pieceSize) {
  const Box3 box = boundingBox(mesh);
  const Vec3 center = box.center();
  Points local;
  local.reserve(mesh.vertices.size());
  for (const Vec3& v : mesh.vertices) local.push_back(v - center);
  const TriangleTree tree(local, mesh.triangles);
  WindingNumber winding(tree, mesh.triangles);
  Work work{mesh, std::move(local), box.diagonal(), std::move(winding), {}, {}};
  work.sides.resize(mesh.triangles.size());
  work.pieces.resize(mesh.triangles.size());

  throwIfCancelled();
  const Partners partners = partnersOf(tree, work.local, mesh.triangles);
  std::vector<char> cut(mesh.triangles.size(), 0);
  for (const auto& [t, others] : partners) cut[t] = 1;
  classifyPatches(work, cut);
  double length = pieceSize * work.diagonal;
  while (!splitAll(work, partners, length)) length *= 2;
  classifyPieces(work, partners);

  ExposedSurface result;
  result.winding = work.winding;
  result.center = center;
  std::vector<char> dropped(mesh.triangles.size(), 0);
  dropDoubles(work, result, dropped);
  bool anyExposed = false;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const bool split = !work.pieces[t].empty();
    anyExposed |= split || work.sides[t].exposed;
    if (split || !work.sides[t].exposed || work.sides[t].reversed) result.whole = false;
    if (split) result.gap = length;
  }
  result.negativeShare = negativeShareOf(work);
  if (!anyExposed) {
    throw DataError(mesh.name +
                    ": has no inside: no part of its surface bounds a region of winding "
                    "number over 0.5; check the orientation of its parts");
  }
  if (!result.whole) assemble(work, dropped, result);
  return result;
}

}  // namespace innermap
