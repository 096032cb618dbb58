#include "tetra/detail/turn_fields.h"

#include <algorithm>
#include <cmath>

#include "lattice/untangle.h"

namespace innermap {
namespace {

Mat3 sumOf(const Mat3& a, const Mat3& b, double weight) {
  Mat3 out = a;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) out[r][c] += weight * b[r][c];
  return out;
}

Mat3 jacobianOfTet(const Points& source, const Points& at, const Tetrahedron& t) {
  return jacobianOf({at[t[0]], at[t[1]], at[t[2]], at[t[3]]},
                    inverseEdges({source[t[0]], source[t[1]], source[t[2]], source[t[3]]}));
}

// Of each cell; of a hexahedron the mean of its corners'.
std::vector<Mat3> jacobiansOf(const CellMesh& mesh, const Points& source) {
  std::vector<Mat3> out;
  for (const Tetrahedron& t : mesh.tetrahedra)
    out.push_back(jacobianOfTet(source, mesh.vertices, t));
  for (const Hexahedron& h : mesh.hexahedra) {
    Mat3 mean{};
    for (const Tetrahedron& t : cornerTetrahedra(h))
      mean = sumOf(mean, jacobianOfTet(source, mesh.vertices, t), 0.125);
    out.push_back(mean);
  }
  return out;
}

// By volume.
std::vector<Mat3> atVertices(const CellMesh& mesh, const Points& source,
                             const std::vector<Mat3>& ofCells) {
  std::vector<Mat3> sums(mesh.vertices.size(), Mat3{});
  std::vector<double> weights(mesh.vertices.size(), 0);
  const auto add = [&](int v, std::size_t cell, double volume) {
    if (!std::isfinite(determinant(ofCells[cell]))) return;
    sums[v] = sumOf(sums[v], ofCells[cell], volume);
    weights[v] += volume;
  };
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
    for (const int v : mesh.tetrahedra[t])
      add(v, t, std::abs(signedVolume(source, mesh.tetrahedra[t])));
  for (std::size_t h = 0; h < mesh.hexahedra.size(); ++h)
    for (const Tetrahedron& t : cornerTetrahedra(mesh.hexahedra[h]))
      add(t[0], mesh.tetrahedra.size() + h, std::abs(signedVolume(source, t)));
  for (std::size_t v = 0; v < sums.size(); ++v)
    for (auto& row : sums[v])
      for (double& x : row) x /= weights[v] > 0 ? weights[v] : 1;
  return sums;
}

CellField turned(const CellField& field, const std::vector<int>& rows,
                 const std::vector<Mat3>& jacobians) {
  CellField out = field;
  out.values.clear();
  const auto width = static_cast<std::size_t>(field.components);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double* row = &field.values[static_cast<std::size_t>(rows[i]) * width];
    if (field.kind == CellField::Kind::scalar) {
      out.values.insert(out.values.end(), row, row + width);
      continue;
    }
    const Vec3 given{row[0], row[1], row[2]};
    const Mat3& j = jacobians[i];
    Vec3 v = field.kind == CellField::Kind::vector ? j * given : transposed(inverse(j)) * given;
    if (!isFinite(v)) v = given;
    if (field.kind == CellField::Kind::normal && norm(v) > 0) v = (norm(given) / norm(v)) * v;
    out.values.insert(out.values.end(), {v.x, v.y, v.z});
  }
  return out;
}

bool anyDirection(const std::vector<CellField>& fields) {
  return std::any_of(fields.begin(), fields.end(),
                     [](const CellField& f) { return f.kind != CellField::Kind::scalar; });
}

}  // namespace

void turnFields(const CellMesh& given, const std::vector<int>& vertices,
                const std::vector<int>& cells, const Points& source, CellMesh& made) {
  std::vector<Mat3> ofCells, ofVertices;
  if (anyDirection(given.cellFields) || anyDirection(given.vertexFields))
    ofCells = jacobiansOf(made, source);
  if (anyDirection(given.vertexFields)) ofVertices = atVertices(made, source, ofCells);
  for (const CellField& field : given.vertexFields)
    made.vertexFields.push_back(turned(field, vertices, ofVertices));
  for (const CellField& field : given.cellFields)
    made.cellFields.push_back(turned(field, cells, ofCells));
}

}  // namespace innermap
