#include "proof/detail/surface_pieces.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace innermap::proof {

void cut(const SurfacePiece& piece, int times, std::vector<SurfacePiece>& out) {
  if (times == 0) {
    out.push_back(piece);
    return;
  }
  int longest = 0;
  double length = -1;
  for (int i = 0; i < 3; ++i) {
    const double l = squaredNorm(piece.at[(i + 1) % 3] - piece.at[i]);
    if (l > length) {
      length = l;
      longest = i;
    }
  }
  const int a = longest, b = (longest + 1) % 3;
  const Vec3 middle = 0.5 * (piece.at[a] + piece.at[b]), goes = 0.5 * (piece.to[a] + piece.to[b]);
  for (const int replaced : {a, b}) {
    SurfacePiece half = piece;
    ++half.halvings;
    half.at[replaced] = middle;
    half.to[replaced] = goes;
    cut(half, times - 1, out);
  }
}

double largestCoordinate(const Vec3& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

LaneSets setsOf(const SurfacePiece* pieces, std::size_t count) {
  LaneSets out{};
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const std::array<Vec3, 3>& at = pieces[std::min(lane, count - 1)].at;
    const Vec3 center = centroid(at);
    double radius = 0;
    for (int i = 0; i < 4; ++i) {
      const Vec3 v = at[i % 3] - center;
      radius = std::max(radius, norm(v));
      for (int a = 0; a < 3; ++a) out.vertex[i][a][lane] = v[a];
    }
    for (int a = 0; a < 3; ++a) out.center[a][lane] = center[a];
    out.slack[lane] = 4e-15 * (largestCoordinate(center) + radius);
    out.radius[lane] = (radius + out.slack[lane]) * (1 + 1e-14);
  }
  return out;
}

std::uint32_t curveKey(const Vec3& p, const Box3& box) {
  const Vec3 extent = box.extent();
  const double cells = 1023 / std::max({extent.x, extent.y, extent.z, 1e-300});
  std::uint32_t key = 0;
  for (int bit = 9; bit >= 0; --bit)
    for (int a = 0; a < 3; ++a) {
      const double place = std::clamp(cells * (p[a] - box.lower[a]), 0.0, 1023.0);
      key = key << 1 | (static_cast<std::uint32_t>(place) >> bit & 1);
    }
  return key;
}

Box3 boxOf(const std::vector<SurfacePiece>& pieces) {
  Box3 out;
  for (const SurfacePiece& piece : pieces)
    for (const Vec3& v : piece.at) out.add(v);
  return out;
}

void sortAlongCurve(const Box3& box, std::vector<SurfacePiece>& pieces) {
  std::vector<std::pair<std::uint32_t, std::size_t>> keyed;
  for (std::size_t i = 0; i < pieces.size(); ++i)
    keyed.emplace_back(curveKey(centroid(pieces[i].at), box), i);
  std::sort(keyed.begin(), keyed.end());
  std::vector<SurfacePiece> sorted;
  for (const auto& [key, i] : keyed) sorted.push_back(pieces[i]);
  pieces.swap(sorted);
}

std::vector<SurfacePiece> piecesOf(const Mesh& surface, const Points& target, double scale) {
  std::vector<SurfacePiece> out;
  for (const Triangle& t : surface.triangles) {
    SurfacePiece& piece = out.emplace_back();
    for (int i = 0; i < 3; ++i) {
      piece.at[i] = scale * surface.vertices[t[i]];
      piece.to[i] = scale * target[t[i]];
    }
  }
  return out;
}

}  // namespace innermap::proof
