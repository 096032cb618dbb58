#include "mesh/detail/orientation.h"

#include <algorithm>
#include <array>

#include "core/disjoint_sets.h"

namespace innermap {
namespace {

// What lies across each side of a triangle, where exactly two triangles meet.
struct Neighbour {
  int triangle = -1;
  bool agrees = true;  // runs along the common edge the other way
};
using Neighbours = std::vector<std::array<Neighbour, 3>>;

Neighbours neighboursOf(std::size_t triangles, const std::vector<EdgeUse>& edges) {
  Neighbours neighbours(triangles);
  forEachEdge(edges, [&](const EdgeUse* begin, const EdgeUse* end) {
    if (end - begin != 2) return;
    const EdgeUse &a = begin[0], &b = begin[1];
    neighbours[a.triangle][a.corner] = {b.triangle, a.forward != b.forward};
    neighbours[b.triangle][b.corner] = {a.triangle, a.forward != b.forward};
  });
  return neighbours;
}

// Maximal sets of triangles connected over edges of exactly two.
struct Patches {
  std::vector<int> of;             // #T
  std::vector<std::size_t> sizes;  // triangles of each
};

Patches flood(const Points& vertices, const std::vector<Triangle>& triangles,
              const Neighbours& neighbours, Orientation& result) {
  Patches patches;
  patches.of.assign(triangles.size(), -1);
  std::vector<int> members;
  for (std::size_t seed = 0; seed < triangles.size(); ++seed) {
    if (patches.of[seed] >= 0) continue;
    const int patch = static_cast<int>(patches.sizes.size());
    members.assign(1, static_cast<int>(seed));
    patches.of[seed] = patch;
    double turnedArea = 0, keptArea = 0;
    for (std::size_t at = 0; at < members.size(); ++at) {
      const int t = members[at];
      const Vec3& origin = vertices[triangles[t][0]];
      const double area =
          norm(cross(vertices[triangles[t][1]] - origin, vertices[triangles[t][2]] - origin));
      (result.turned[t] ? turnedArea : keptArea) += area;
      for (const Neighbour& n : neighbours[t]) {
        if (n.triangle < 0) continue;
        const bool turn = result.turned[t] != !n.agrees;
        if (patches.of[n.triangle] < 0) {
          patches.of[n.triangle] = patch;
          result.turned[n.triangle] = turn;
          members.push_back(n.triangle);
        } else if (result.turned[n.triangle] != turn && t < n.triangle) {
          ++result.conflicts;
        }
      }
    }
    if (turnedArea > keptArea)
      for (const int t : members) result.turned[t] = !result.turned[t];
    patches.sizes.push_back(members.size());
  }
  return patches;
}

// How often each patch runs forward more than backward along an edge of three triangles or more.
struct Junction {
  int edge, patch, net;
};

std::vector<Junction> junctionsOf(const std::vector<EdgeUse>& edges, const Patches& patches,
                                  const Orientation& orientation, int& count) {
  std::vector<Junction> junctions;
  std::vector<std::array<int, 2>> uses;  // patch, direction
  count = 0;
  forEachEdge(edges, [&](const EdgeUse* begin, const EdgeUse* end) {
    if (end - begin < 3) return;
    uses.clear();
    for (const EdgeUse* use = begin; use != end; ++use)
      uses.push_back(
          {patches.of[use->triangle], use->forward != orientation.turned[use->triangle] ? 1 : -1});
    std::sort(uses.begin(), uses.end());
    for (std::size_t i = 0; i < uses.size();) {
      Junction junction{count, uses[i][0], 0};
      for (; i < uses.size() && uses[i][0] == junction.patch; ++i) junction.net += uses[i][1];
      if (junction.net != 0) junctions.push_back(junction);
    }
    ++count;
  });
  return junctions;
}

// Turns patches so that the junctions balance as far as that goes, the largest patch first.
std::vector<bool> balance(std::vector<Junction>& junctions, const Patches& patches, int edgeCount) {
  std::vector<bool> turned(patches.sizes.size(), false);
  std::stable_sort(junctions.begin(), junctions.end(), [&](const Junction& a, const Junction& b) {
    const std::size_t sizeA = patches.sizes[a.patch], sizeB = patches.sizes[b.patch];
    return sizeA != sizeB ? sizeA > sizeB : a.patch < b.patch;
  });
  std::vector<int> net(edgeCount, 0);
  for (std::size_t i = 0; i < junctions.size();) {
    std::size_t j = i;
    long score = 0;
    for (; j < junctions.size() && junctions[j].patch == junctions[i].patch; ++j)
      score += static_cast<long>(junctions[j].net) * net[junctions[j].edge];
    turned[junctions[i].patch] = score > 0;
    for (std::size_t k = i; k < j; ++k)
      net[junctions[k].edge] += score > 0 ? -junctions[k].net : junctions[k].net;
    i = j;
  }
  return turned;
}

}  // namespace

Orientation orient(const Points& vertices, const std::vector<Triangle>& triangles,
                   const std::vector<EdgeUse>& edges) {
  Orientation result;
  result.turned.assign(triangles.size(), false);
  const Patches patches = flood(vertices, triangles, neighboursOf(triangles.size(), edges), result);
  int edgeCount = 0;
  std::vector<Junction> junctions = junctionsOf(edges, patches, result, edgeCount);
  const std::vector<bool> patchTurned = balance(junctions, patches, edgeCount);

  DisjointSets sets(patches.sizes.size());
  std::vector<int> firstAt(edgeCount, -1);
  for (const Junction& junction : junctions) {
    int& first = firstAt[junction.edge];
    if (first < 0) first = junction.patch;
    sets.unite(first, junction.patch);
  }
  std::vector<int> number(patches.sizes.size(), -1);
  result.shell.resize(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const int patch = patches.of[t];
    if (patchTurned[patch]) result.turned[t] = !result.turned[t];
    int& shell = number[sets.find(patch)];
    if (shell < 0) shell = result.shells++;
    result.shell[t] = shell;
  }
  return result;
}

}  // namespace innermap
