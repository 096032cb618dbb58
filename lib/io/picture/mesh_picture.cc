#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/require_number.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/io/solid_pictures.h"
#include "io/picture/detail/picture.h"

namespace innermap {
namespace {

constexpr char kStage[] = "drawing the surfaces";
constexpr int kMargin = 24, kTitle = 44, kFooter = 40, kSubsamples = 3;
constexpr int kTogether = 1 << 19;  // subsamples that are coloured together
constexpr std::size_t kRows = 16;   // of them that a thread looks at together
constexpr double kWidest = 1.6;     // a view, in its heights

// Right, up and towards the viewer.
struct View {
  Vec3 right, up, towards;

  explicit View(const Vec3& from) : towards(from / norm(from)) {
    const Vec3 pole = std::abs(towards.y) > 0.999 ? Vec3{0, 0, -1} : Vec3{0, 1, 0};
    right = cross(pole, towards);
    right = right / norm(right);
    up = cross(towards, right);
  }
  Vec3 operator()(const Vec3& p) const { return {dot(p, right), dot(p, up), dot(p, towards)}; }
};

// What is seen at each subsample of a view.
struct Seen {
  int width = 0, height = 0;
  std::vector<int> triangle;  // -1: the ground
  std::vector<float> u, v;    // barycentric coordinates of corners 1 and 2
};

struct Flat {
  Points at;  // vertices in pixels of the subsampled view; z towards the viewer
};

Flat project(const PictureSurface& surface, const View& view, int width, int height) {
  Flat flat;
  Box3 box;
  for (const Vec3& p : surface.vertices) flat.at.push_back(view(p));
  for (const auto& t : surface.triangles)
    for (const int v : t) box.add(flat.at[v]);
  const Vec3 extent = box.extent(), middle = box.center();
  const double scale =
      0.94 * std::min(width / std::max(extent.x, 1e-300), height / std::max(extent.y, 1e-300));
  for (Vec3& p : flat.at)
    p = {0.5 * width + scale * (p.x - middle.x), 0.5 * height - scale * (p.y - middle.y),
         scale * (p.z - middle.z)};
  return flat;
}

// The nearest triangle wins, of equal ones the first.
void drawTriangle(const std::array<Vec3, 3>& c, int number, int firstRow, int endRow, Seen& seen,
                  std::vector<double>& depth) {
  const double area = (c[1].x - c[0].x) * (c[2].y - c[0].y) - (c[2].x - c[0].x) * (c[1].y - c[0].y);
  if (!(std::abs(area) > 1e-12)) return;
  const auto [low, high] = std::minmax({c[0].y, c[1].y, c[2].y});
  const auto [left, right] = std::minmax({c[0].x, c[1].x, c[2].x});
  const int y0 = std::max(firstRow, static_cast<int>(std::floor(low - 0.5))),
            y1 = std::min(endRow - 1, static_cast<int>(std::ceil(high))),
            x0 = std::max(0, static_cast<int>(std::floor(left - 0.5))),
            x1 = std::min(seen.width - 1, static_cast<int>(std::ceil(right)));
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const double px = x + 0.5 - c[0].x, py = y + 0.5 - c[0].y;
      const double u = (px * (c[2].y - c[0].y) - py * (c[2].x - c[0].x)) / area,
                   v = (py * (c[1].x - c[0].x) - px * (c[1].y - c[0].y)) / area;
      if (u < 0 || v < 0 || u + v > 1) continue;
      const double z = c[0].z + u * (c[1].z - c[0].z) + v * (c[2].z - c[0].z);
      const std::size_t i = static_cast<std::size_t>(y) * static_cast<std::size_t>(seen.width) +
                            static_cast<std::size_t>(x);
      if (!(z > depth[i])) continue;
      depth[i] = z;
      seen.triangle[i] = number;
      seen.u[i] = static_cast<float>(u);
      seen.v[i] = static_cast<float>(v);
    }
}

Seen rasterise(const PictureSurface& surface, const View& view, int width, int height) {
  Seen seen;
  seen.width = width;
  seen.height = height;
  const std::size_t count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  seen.triangle.assign(count, -1);
  seen.u.assign(count, 0);
  seen.v.assign(count, 0);
  std::vector<double> depth(count, -std::numeric_limits<double>::infinity());
  const Flat flat = project(surface, view, width, height);
  parallelBlocks(static_cast<std::size_t>(height), 48, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
      const auto& [a, b, c] = surface.triangles[t];
      const auto [low, high] = std::minmax({flat.at[a].y, flat.at[b].y, flat.at[c].y});
      if (high < static_cast<double>(begin) - 1 || low > static_cast<double>(end) + 1) continue;
      drawTriangle({flat.at[a], flat.at[b], flat.at[c]}, static_cast<int>(t),
                   static_cast<int>(begin), static_cast<int>(end), seen, depth);
    }
  });
  return seen;
}

// Normals for shading: smooth, but not across sharp edges.
class Normals {
 public:
  explicit Normals(const PictureSurface& surface) : surface_(surface) {
    vertex_.resize(surface.vertices.size());
    for (const auto& t : surface.triangles)
      for (const int v : t) vertex_[v] += faceNormal(t);
    for (Vec3& n : vertex_)
      if (norm(n) > 0) n = n / norm(n);
  }

  Vec3 at(int triangle, double u, double v) const {
    const auto& t = surface_.triangles[triangle];
    Vec3 face = faceNormal(t);
    if (!(norm(face) > 0)) return {0, 0, 0};
    face = face / norm(face);
    const double weight[3] = {1 - u - v, u, v};
    Vec3 sum;
    for (int k = 0; k < 3; ++k) {
      const Vec3& n = vertex_[t[k]];
      sum += weight[k] * (dot(n, face) > 0.7 ? n : face);
    }
    return sum / norm(sum);
  }

 private:
  Vec3 faceNormal(const std::array<int, 3>& t) const {
    const Vec3& a = surface_.vertices[t[0]];
    return cross(surface_.vertices[t[1]] - a, surface_.vertices[t[2]] - a);
  }

  const PictureSurface& surface_;
  Points vertex_;
};

// A key light over the viewer's left shoulder, a weak one from the right, and the sky.
double light(Vec3 normal, const View& view) {
  if (dot(normal, view.towards) < 0) normal = -normal;
  const Vec3 key{-0.45, 0.6, 0.66}, fill{0.8, 0.1, 0.59};
  const Vec3 n = view(normal);
  return 0.24 + 0.10 * (0.5 + 0.5 * n.y) + 0.62 * std::max(0.0, dot(n, key)) +
         0.14 * std::max(0.0, dot(n, fill));
}

// Where the points of each row begin among those of all rows, and how many there are.
std::vector<std::size_t> pointsBefore(const Seen& seen, int firstRow, int endRow) {
  const auto width = static_cast<std::size_t>(seen.width);
  std::vector<std::size_t> out(static_cast<std::size_t>(endRow - firstRow) + 1, 0);
  parallelBlocks(out.size() - 1, kRows, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      const int* row = &seen.triangle[(static_cast<std::size_t>(firstRow) + r) * width];
      out[r + 1] = width - static_cast<std::size_t>(std::count(row, row + width, -1));
    }
  });
  std::partial_sum(out.begin(), out.end(), out.begin());
  return out;
}

// The rows of a view, whole pixels of which lie in them.
void drawRows(const PictureSurface& surface, const View& view, const Normals& normals,
              const Seen& seen, int firstRow, int endRow, int x0, int y0, Picture& picture) {
  const std::vector<std::size_t> before = pointsBefore(seen, firstRow, endRow);
  const auto visit = [&](std::size_t row, const auto& body) {
    const std::size_t first =
        (static_cast<std::size_t>(firstRow) + row) * static_cast<std::size_t>(seen.width);
    std::size_t point = before[row];
    for (std::size_t x = 0; x < static_cast<std::size_t>(seen.width); ++x)
      if (seen.triangle[first + x] >= 0) body(first + x, x, point++);
  };
  std::vector<VisiblePoint> points(before.back());
  parallelBlocks(before.size() - 1, kRows, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row)
      visit(row, [&](std::size_t i, std::size_t, std::size_t point) {
        const double u = static_cast<double>(seen.u[i]), v = static_cast<double>(seen.v[i]);
        points[point] = {seen.triangle[i], {std::max(0.0, 1 - u - v), u, v}};
      });
  });
  const std::vector<Vec3> colours = surface.colours(points);
  if (colours.size() != points.size())
    throw DataError(surface.label + ": not as many colours as points");
  const auto width = static_cast<std::size_t>(seen.width / kSubsamples);
  const std::size_t pixelRows = (before.size() - 1) / kSubsamples;
  const int firstPixelRow = firstRow / kSubsamples;
  parallelBlocks(pixelRows, 4, [&](std::size_t begin, std::size_t end) {
    std::vector<Vec3> sum(width);
    std::vector<int> covered(width);
    for (std::size_t y = begin; y < end; ++y) {
      std::fill(sum.begin(), sum.end(), Vec3{});
      std::fill(covered.begin(), covered.end(), 0);
      for (std::size_t row = y * kSubsamples; row < (y + 1) * kSubsamples; ++row)
        visit(row, [&](std::size_t, std::size_t x, std::size_t point) {
          const auto& b = points[point].barycentric;
          const Vec3 normal = normals.at(points[point].triangle, b[1], b[2]);
          sum[x / kSubsamples] += light(normal, view) * colours[point];
          ++covered[x / kSubsamples];
        });
      for (std::size_t x = 0; x < width; ++x) {
        if (covered[x] == 0) continue;
        Rgb colour;
        for (int c = 0; c < 3; ++c)
          colour[static_cast<std::size_t>(c)] = encoded(sum[x][c] / covered[x]);
        picture.blend(x0 + static_cast<int>(x), y0 + firstPixelRow + static_cast<int>(y), colour,
                      static_cast<float>(covered[x]) / (kSubsamples * kSubsamples));
      }
    }
  });
}

void drawView(const PictureSurface& surface, const View& view, int x0, int y0, int width,
              int height, Picture& picture) {
  const Seen seen = rasterise(surface, view, width * kSubsamples, height * kSubsamples);
  const Normals normals(surface);
  // Points and colours take much more than what is seen, so not of all rows at once.
  const int rows = kSubsamples * std::max(1, kTogether / (kSubsamples * seen.width));
  for (int first = 0; first < seen.height; first += rows)
    drawRows(surface, view, normals, seen, first, std::min(first + rows, seen.height), x0, y0,
             picture);
}

// Width over height of what the view shows, kept to what fits beside others.
double aspect(const PictureSurface& surface, const std::vector<Vec3>& from) {
  double widest = 0.5;
  for (const Vec3& direction : from) {
    const View view(direction);
    Box3 box;
    for (const auto& t : surface.triangles)
      for (const int v : t) box.add(view(surface.vertices[v]));
    widest = std::max(widest, box.extent().x / std::max(box.extent().y, 1e-300));
  }
  return std::min(widest, kWidest);
}

void check(const std::vector<PictureSurface>& surfaces, const MeshPictureSettings& settings) {
  requireNumber("pixels", settings.pixels, {64, 4096});
  if (settings.from.empty()) throw SettingError("from", "give one direction at least");
  for (const Vec3& direction : settings.from)
    if (!(norm(direction) > 0) || !isFinite(direction))
      throw SettingError("from", "directions must be finite and not 0");
  if (surfaces.empty()) throw DataError("there is no surface to show");
  for (const PictureSurface& surface : surfaces)
    if (surface.triangles.empty()) throw DataError(surface.label + ": has no triangles to show");
}

}  // namespace

std::uint64_t meshPictureMemory(const MeshPictureSettings& settings) {
  // Of a subsample: the triangle, its coordinates, its depth; and of those that are coloured
  // together, what was measured.
  constexpr std::uint64_t kSeen = 20, kColoured = 120;
  const double samples = kWidest * settings.pixels * settings.pixels * kSubsamples * kSubsamples;
  return kSeen * static_cast<std::uint64_t>(samples) + kColoured * kTogether;
}

void writeMeshPicture(const std::string& path, const std::vector<PictureSurface>& surfaces,
                      const MeshPictureSettings& settings) {
  check(surfaces, settings);
  const int height = settings.pixels;
  std::vector<int> widths;
  int total = kMargin;
  for (const PictureSurface& surface : surfaces) {
    widths.push_back(static_cast<int>(height * aspect(surface, settings.from)));
    total += widths.back() + kMargin;
  }
  const int rows = static_cast<int>(settings.from.size());
  total = std::max(total, 2 * kMargin + textWidth(settings.caption, 15));
  Picture picture(
      total, kTitle + rows * (height + kMargin) + (settings.caption.empty() ? 0 : kFooter), kPaper);
  int x = kMargin;
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    for (int r = 0; r < rows; ++r) {
      reportProgress(kStage,
                     static_cast<double>(s * settings.from.size() + static_cast<std::size_t>(r)) /
                         static_cast<double>(surfaces.size() * settings.from.size()));
      drawView(surfaces[s], View(settings.from[static_cast<std::size_t>(r)]), x,
               kTitle + r * (height + kMargin), widths[s], height, picture);
    }
    picture.text(x + widths[s] / 2, 32, surfaces[s].label, 20, kInk, Align::centre);
    x += widths[s] + kMargin;
  }
  if (!settings.caption.empty())
    picture.text(kMargin, picture.height() - 16, settings.caption, 15, kInk);
  picture.write(path);
}

}  // namespace innermap
