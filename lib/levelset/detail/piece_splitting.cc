#include "levelset/detail/piece_splitting.h"

#include <algorithm>
#include <cmath>

#include "innermap/core/run.h"

namespace innermap {
namespace {

using Corners = std::array<Vec3, 3>;

bool separated(const Vec3& axis, const Corners& a, const Corners& b, double tolerance) {
  const double length = norm(axis);
  if (!(length > 0)) return false;
  double minA = dot(axis, a[0]), maxA = minA, minB = dot(axis, b[0]), maxB = minB;
  for (int k = 1; k < 3; ++k) {
    const double x = dot(axis, a[k]), y = dot(axis, b[k]);
    minA = std::min(minA, x);
    maxA = std::max(maxA, x);
    minB = std::min(minB, y);
    maxB = std::max(maxB, y);
  }
  const double margin = tolerance * length;
  return minA > maxB + margin || minB > maxA + margin;
}

// Whether `piece` lies in the plane of `other` and within it: then `other` treats all of it alike.
bool covers(const Corners& other, const Corners& piece, double tolerance) {
  const Vec3 n = cross(other[1] - other[0], other[2] - other[0]);
  const double size = norm(n);
  if (!(size > 0)) return false;
  for (const Vec3& p : piece) {
    if (std::abs(dot(n, p - other[0])) > tolerance * size) return false;
    for (int k = 0; k < 3; ++k) {
      const Vec3 edge = other[(k + 1) % 3] - other[k];
      if (dot(cross(edge, p - other[k]), n) < -tolerance * norm(edge) * size) return false;
    }
  }
  return true;
}

double longestEdge(const Corners& t, int& edge) {
  double longest = -1;
  for (int k = 0; k < 3; ++k) {
    const double length = norm(t[(k + 1) % 3] - t[k]);
    if (length > longest) {
      longest = length;
      edge = k;
    }
  }
  return longest;
}

}  // namespace

bool trianglesTouch(const Corners& a, const Corners& b, double tolerance) {
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 unit;
    unit[axis] = 1;
    if (separated(unit, a, b, tolerance)) return false;
  }
  const Vec3 na = cross(a[1] - a[0], a[2] - a[0]), nb = cross(b[1] - b[0], b[2] - b[0]);
  if (separated(na, a, b, tolerance) || separated(nb, a, b, tolerance)) return false;
  for (int i = 0; i < 3; ++i) {
    const Vec3 ea = a[(i + 1) % 3] - a[i], eb = b[(i + 1) % 3] - b[i];
    // In-plane normals settle coplanar triangles, for which products of edges vanish.
    if (separated(cross(na, ea), a, b, tolerance)) return false;
    if (separated(cross(nb, eb), a, b, tolerance)) return false;
    for (int j = 0; j < 3; ++j) {
      const Vec3 other = b[(j + 1) % 3] - b[j];
      const Vec3 axis = cross(ea, other);
      // Nearly parallel edges give an axis of rounding errors.
      if (squaredNorm(axis) < 1e-24 * squaredNorm(ea) * squaredNorm(other)) continue;
      if (separated(axis, a, b, tolerance)) return false;
    }
  }
  return true;
}

Side classify(const WindingNumber& winding, const Corners& t, double diagonal) {
  const Vec3 n = cross(t[1] - t[0], t[2] - t[0]);
  const double area = norm(n);
  int edge = 0;
  const double longest = longestEdge(t, edge);
  Side side;
  if (!(area > 0)) {
    side.exposed = false;
    return side;
  }
  // Small against the triangle's height, so that nothing lies between the point and the triangle;
  // not so small that it drowns in rounding.
  const double offset = std::clamp(1e-3 * area / longest, 1e-11 * diagonal, 1e-8 * diagonal);
  const Vec3 m = (t[0] + t[1] + t[2]) / 3;
  const int out = winding.wholeAt(m + (offset / area) * n);
  const int in = winding.wholeAt(m - (offset / area) * n);
  side.exposed = (in > 0) != (out > 0);
  side.reversed = side.exposed && out > 0;
  side.negative = std::min(in, out) < 0 && std::max(in, out) <= 0;
  side.covers = std::abs(in - out);
  return side;
}

Corners pieceTriangle(const Corners& parent, const Piece& piece) {
  Corners result;
  for (int c = 0; c < 3; ++c) {
    const auto& b = piece.corners[c];
    result[c] = b[0] * parent[0] + b[1] * parent[1] + b[2] * parent[2];
  }
  return result;
}

std::vector<Piece> splitTriangle(const Corners& triangle, const std::vector<Corners>& others,
                                 double length, double tolerance, std::size_t limit) {
  struct Task {
    Piece piece;
    std::vector<int> others;
  };
  std::vector<Task> stack(1);
  for (std::size_t i = 0; i < others.size(); ++i) stack[0].others.push_back(static_cast<int>(i));
  std::vector<Piece> done;
  for (std::size_t step = 0; !stack.empty(); ++step) {
    if (step % 1024 == 0) throwIfCancelled();
    Task task = std::move(stack.back());
    stack.pop_back();
    const Corners corners = pieceTriangle(triangle, task.piece);
    std::vector<int> cutting;
    for (const int i : task.others) {
      if (trianglesTouch(corners, others[i], tolerance) && !covers(others[i], corners, tolerance)) {
        cutting.push_back(i);
      }
    }
    int edge = 0;
    if (cutting.empty() || longestEdge(corners, edge) <= length) {
      done.push_back(task.piece);
      if (done.size() > limit) return done;
      continue;
    }
    // Halves of barycentric coordinates are exact.
    const int a = edge, b = (edge + 1) % 3;
    std::array<double, 3> middle;
    for (int k = 0; k < 3; ++k) {
      middle[k] = 0.5 * (task.piece.corners[a][k] + task.piece.corners[b][k]);
    }
    Task first{task.piece, cutting}, second{task.piece, std::move(cutting)};
    first.piece.corners[b] = middle;
    second.piece.corners[a] = middle;
    stack.push_back(std::move(second));
    stack.push_back(std::move(first));
  }
  return done;
}

}  // namespace innermap
