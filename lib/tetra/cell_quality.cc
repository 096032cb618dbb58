#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/pi.h"
#include "innermap/core/run.h"
#include "innermap/tetra/cells.h"
#include "lattice/cell_signs.h"

namespace innermap {
namespace {

constexpr std::size_t kQualityBlock = 4096;
constexpr char kMeasuringCells[] = "measuring cells";

double degrees(double cosine) { return std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / kPi; }

double unitDeterminant(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double lengths = norm(a) * norm(b) * norm(c);
  return lengths > 0 ? dot(a, cross(b, c)) / lengths : 0;
}

QualitySummary summaryOf(const std::vector<float>& values, double lower, double binWidth,
                         std::size_t bins) {
  QualitySummary s;
  s.lower = lower;
  s.binWidth = binWidth;
  s.histogram.assign(bins, 0);
  if (values.empty()) return s;
  double sum = 0;
  for (const float value : values) {
    const double v = static_cast<double>(value);
    sum += v;
    const double bin = std::floor((v - lower) / binWidth);
    ++s.histogram[static_cast<std::size_t>(std::clamp(bin, 0.0, static_cast<double>(bins - 1)))];
  }
  std::vector<float> sorted = values;
  const std::size_t rank = values.size() / 100;
  std::nth_element(sorted.begin(), sorted.begin() + rank, sorted.end());
  s.onePercent = static_cast<double>(sorted[rank]);
  const auto [least, greatest] = std::minmax_element(values.begin(), values.end());
  s.least = static_cast<double>(*least);
  s.greatest = static_cast<double>(*greatest);
  s.mean = sum / static_cast<double>(values.size());
  return s;
}

}  // namespace

DihedralRange dihedralRange(const Points& vertices, const Tetrahedron& cell) {
  if (isInverted(vertices, cell)) return {};
  static constexpr int kFaces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  std::array<Vec3, 4> normal;
  for (int f = 0; f < 4; ++f) {
    const Vec3& a = vertices[cell[kFaces[f][0]]];
    normal[f] = cross(vertices[cell[kFaces[f][1]]] - a, vertices[cell[kFaces[f][2]]] - a);
    const double length = norm(normal[f]);
    if (!(length > 0)) return {};  // underflow
    normal[f] = normal[f] / length;
  }
  double least = 1, greatest = -1;  // cosines of the angles between the normals
  for (int f = 0; f < 4; ++f)
    for (int g = 0; g < f; ++g) {
      const double cosine = dot(normal[f], normal[g]);
      least = std::min(least, cosine);
      greatest = std::max(greatest, cosine);
    }
  return {degrees(-least), degrees(-greatest)};
}

double scaledJacobian(const Points& vertices, const Hexahedron& cell) {
  const auto at = [&](int k) { return vertices[cell[k]]; };
  const Vec3 x = at(1) - at(0) + (at(2) - at(3)) + (at(5) - at(4)) + (at(6) - at(7));
  const Vec3 y = at(3) - at(0) + (at(2) - at(1)) + (at(7) - at(4)) + (at(6) - at(5));
  const Vec3 z = at(4) - at(0) + (at(5) - at(1)) + (at(6) - at(2)) + (at(7) - at(3));
  double least = unitDeterminant(x, y, z);
  for (const Tetrahedron& t : cornerTetrahedra(cell)) {
    const Vec3& a = vertices[t[0]];
    least = std::min(least,
                     unitDeterminant(vertices[t[1]] - a, vertices[t[2]] - a, vertices[t[3]] - a));
  }
  return least;
}

CellQuality cellQuality(const CellMesh& mesh) {
  CellQuality q;
  q.leastDihedral.resize(mesh.tetrahedra.size());
  q.greatestDihedral.resize(mesh.tetrahedra.size());
  q.scaledJacobian.resize(mesh.hexahedra.size());
  std::atomic<std::uint64_t> tetrahedra{0}, hexahedra{0};
  parallelBlocks(
      mesh.tetrahedra.size(), kQualityBlock,
      [&](std::size_t begin, std::size_t end) {
        std::uint64_t inverted = 0;
        for (std::size_t t = begin; t < end; ++t) {
          inverted += isInverted(mesh.vertices, mesh.tetrahedra[t]);
          const DihedralRange range = dihedralRange(mesh.vertices, mesh.tetrahedra[t]);
          q.leastDihedral[t] = static_cast<float>(range.least);
          q.greatestDihedral[t] = static_cast<float>(range.greatest);
        }
        tetrahedra += inverted;
      },
      kMeasuringCells);
  parallelBlocks(
      mesh.hexahedra.size(), kQualityBlock,
      [&](std::size_t begin, std::size_t end) {
        std::uint64_t inverted = 0;
        for (std::size_t h = begin; h < end; ++h) {
          inverted += isInverted(mesh.vertices, mesh.hexahedra[h]);
          q.scaledJacobian[h] =
              static_cast<float>(scaledJacobian(mesh.vertices, mesh.hexahedra[h]));
        }
        hexahedra += inverted;
      },
      kMeasuringCells);
  q.invertedTetrahedra = tetrahedra;
  q.invertedHexahedra = hexahedra;
  q.dihedral = summaryOf(q.leastDihedral, 0, 5, 15);
  q.jacobian = summaryOf(q.scaledJacobian, -1, 0.1, 20);
  if (!q.greatestDihedral.empty())
    q.greatestAngle = static_cast<double>(
        *std::max_element(q.greatestDihedral.begin(), q.greatestDihedral.end()));
  return q;
}

void setQualityFields(CellMesh& mesh, const CellQuality& quality) {
  const std::size_t tetrahedra = mesh.tetrahedra.size(), hexahedra = mesh.hexahedra.size();
  auto& fields = mesh.cellFields;
  const auto set = [&](const char* name, const std::vector<float>& values, std::size_t first) {
    fields.erase(std::remove_if(fields.begin(), fields.end(),
                                [&](const CellField& f) { return f.name == name; }),
                 fields.end());
    if (values.empty()) return;
    CellField field;
    field.name = name;
    field.values.assign(tetrahedra + hexahedra, 0);
    for (std::size_t i = 0; i < values.size(); ++i)
      field.values[first + i] = static_cast<double>(values[i]);
    fields.push_back(std::move(field));
  };
  set("least_dihedral", quality.leastDihedral, 0);
  set("greatest_dihedral", quality.greatestDihedral, 0);
  set("scaled_jacobian", quality.scaledJacobian, tetrahedra);
}

}  // namespace innermap
