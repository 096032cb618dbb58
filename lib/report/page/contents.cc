#include "report/page/contents.h"

#include <filesystem>
#include <utility>

namespace innermap {
namespace {

std::string fileName(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

Points pick(const Points& points, const std::vector<int>& kept) {
  Points out;
  out.reserve(kept.size());
  for (const int i : kept) out.push_back(points[static_cast<std::size_t>(i)]);
  return out;
}

PageShape shapeOf(const Mesh& mesh, const std::string& label) {
  PageShape shape;
  shape.triangles = mesh.triangles;
  shape.places.push_back({label, mesh.vertices});
  return shape;
}

PageScalar& scalarOf(PageShape& shape, const std::string& name) {
  for (PageScalar& scalar : shape.scalars)
    if (scalar.name == name) return scalar;
  shape.scalars.push_back({name, {}});
  return shape.scalars.back();
}

void addStretch(PageShape& shape) {
  scalarOf(shape, "stretch")
      .values.push_back(
          stretches(shape.places.front().points, shape.places.back().points, shape.triangles));
}

std::vector<double> distances(const Points& a, const Points& b, double unit) {
  std::vector<double> out;
  out.reserve(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) out.push_back(norm(a[i] - b[i]) / unit);
  return out;
}

EvaluateFieldSettings forDrawing(double diagonal) {
  EvaluateFieldSettings out;
  out.accuracy = 1e-6 * diagonal;  // far below any error that is shown
  return out;
}

}  // namespace

void addMesh(Page& page, const Mesh& mesh) {
  for (const PageShape& shape : page.shapes)
    if (shape.places.size() > 1 || shape.places.front().label == fileName(mesh.name)) return;
  PageShape shape = shapeOf(mesh, fileName(mesh.name));
  simplify(shape, verticesForPlaces(1));
  page.shapes.push_back(std::move(shape));
}

void showPair(Page& page, const Mesh& before, const Points& after) {
  PageShape shape = shapeOf(before, "before: " + fileName(before.name));
  const std::vector<int> kept = simplify(shape, verticesForPlaces(2));
  shape.places.push_back({"after", pick(after, kept)});
  addStretch(shape);
  page.shapes.clear();
  page.shapes.push_back(std::move(shape));
}

void showMap(Page& page, const MappedSolid& mapped) {
  const BoundaryPair& pair = mapped.boundary;
  PageShape shape = shapeOf(pair.source.mesh, "source: " + fileName(pair.source.mesh.name));
  const std::vector<int> kept = simplify(shape, verticesForPlaces(3));
  const Points target = pick(pair.targetMesh.vertices, kept);
  const double unit = pair.target.diagonal;
  const FieldSamples samples = mapped.map.evaluate(shape.places.front().points, forDrawing(unit));
  const Points image = pointsOf(samples.values);
  const std::vector<double> error = distances(image, target, unit);
  scalarOf(shape, "boundary_error").values = {error};
  shape.places.push_back({"where the map takes it", image});
  addStretch(shape);
  shape.places.push_back({"target: " + fileName(pair.targetMesh.name), target});
  page.shapes.clear();
  page.shapes.push_back(std::move(shape));
}

PageFrames::PageFrames(Page& page, const Mesh& rest, std::size_t expected) : page_(page) {
  each_ = frameStep(expected);
  PageShape shape = shapeOf(rest, "rest: " + fileName(rest.name));
  kept_ = simplify(shape, verticesForPlaces(expected / each_ + 1));
  page_.shapes.clear();
  page_.shapes.push_back(std::move(shape));
}

bool PageFrames::wanted() { return seen_++ % each_ == 0; }

void PageFrames::addPlace(std::int64_t number, Points points) {
  PageShape& shape = page_.shapes.front();
  shape.places.push_back({"frame " + std::to_string(number), std::move(points)});
  addStretch(shape);
}

void PageFrames::add(std::int64_t number, const Points& positions) {
  if (wanted()) addPlace(number, pick(positions, kept_));
}

void PageFrames::add(std::int64_t number, const Points& positions, const FrameFit& fit) {
  if (!wanted()) return;
  PageShape& shape = page_.shapes.front();
  const Points given = pick(positions, kept_);
  const double unit = fit.boundary.diagonal;
  Points image = pointsOf(fit.field.evaluate(shape.places.front().points, forDrawing(unit)).values);
  scalarOf(shape, "boundary_error").values.push_back(distances(image, given, unit));
  addPlace(number, std::move(image));
}

}  // namespace innermap
