#include "innermap/boundary/landmarks.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <map>
#include <string_view>

#include "innermap/core/error.h"
#include "innermap/mesh/triangle_tree.h"

namespace innermap {
namespace {

constexpr double kOnSurface = 1e-3, kFarVertex = 0.02, kSamePlace = 1e-9;  // of the diagonal
constexpr std::size_t kLongestLine = 4096, kMostLines = 1000000;

[[noreturn]] void fail(const std::string& path, std::size_t line, const std::string& what) {
  throw FileError(path, fmt::format("line {}: {}", line, what));
}

std::vector<std::string> tokensOf(std::string text) {
  text.resize(std::min(text.find('#'), text.size()));
  for (char& c : text)
    if (c == ',' || c == ';' || static_cast<unsigned char>(c) < 32) c = ' ';
  std::vector<std::string> tokens;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t space = std::min(text.find(' ', from), text.size());
    if (space > from) tokens.push_back(text.substr(from, space - from));
    from = space + 1;
  }
  return tokens;
}

template <class Number>
std::optional<Number> numberIn(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string shown(const std::string& token) {
  std::string text = token.substr(0, 24);
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 32 || static_cast<unsigned char>(c) > 126) c = '?';
  return "'" + text + "'";
}

// One line's tokens, taken place by place.
class LineReader {
 public:
  LineReader(const std::string& path, std::size_t line, std::vector<std::string> tokens)
      : path_(path), line_(line), tokens_(std::move(tokens)) {
    const bool pairOfNumbers = tokens_.size() == 2, pairOfPoints = tokens_.size() == 6;
    const bool marked = tokens_.size() == 4 && (isMarked(tokens_[0]) || isMarked(tokens_[3]));
    if (!pairOfNumbers && !pairOfPoints && !marked)
      fail(path, line,
           fmt::format("{} numbers make no pair of places; give two vertices, two points of three "
                       "numbers, or one of each with the vertex written as v12",
                       tokens_.size()));
    pointsOnly_ = pairOfPoints;
  }

  LandmarkPlace next() {
    LandmarkPlace place;
    if (!pointsOnly_ && (tokens_.size() == 2 || isMarked(tokens_[at_]))) {
      place.vertex = vertex(tokens_[at_++]);
      return place;
    }
    for (int axis = 0; axis < 3; ++axis) {
      const std::optional<double> value = numberIn<double>(tokens_[at_]);
      if (!value || !std::isfinite(*value))
        fail(path_, line_, shown(tokens_[at_]) + " is no coordinate");
      place.point[axis] = *value;
      ++at_;
    }
    return place;
  }

 private:
  static bool isMarked(const std::string& token) { return token[0] == 'v' || token[0] == 'V'; }

  int vertex(const std::string& token) const {
    const std::optional<int> value =
        numberIn<int>(std::string_view(token).substr(isMarked(token) ? 1 : 0));
    if (!value || *value < 0)
      fail(path_, line_, shown(token) + " is no vertex; vertices are counted from 0");
    return *value;
  }

  const std::string& path_;
  std::size_t line_, at_ = 0;
  std::vector<std::string> tokens_;
  bool pointsOnly_ = false;
};

std::string whereIs(const LandmarkList& list, std::size_t pair) {
  const std::size_t line = list.pairs[pair].line;
  return line > 0 ? fmt::format("line {}", line) : fmt::format("pair {}", pair + 1);
}

[[noreturn]] void failAt(const LandmarkList& list, std::size_t pair, const std::string& what) {
  throw FileError(list.name, whereIs(list, pair) + ": " + what);
}

// A surface's shells to find places on.
class Finder {
 public:
  Finder(const LandmarkList& list, const LaidOutMesh& input)
      : list_(list),
        input_(input),
        diagonal_(boundingBox(input.mesh).diagonal()),
        file_(input.mesh.vertices, input.mesh.triangles),
        inShells_(trianglesOf(input.shells())),
        shells_(input.shells().mesh.vertices, corners(input.shells(), inShells_)) {}

  double diagonal() const { return diagonal_; }

  // World position; throws when it is not on the surface.
  Vec3 positionOf(const LandmarkPlace& place, std::size_t pair) const {
    const Mesh& mesh = input_.mesh;
    if (place.vertex) {
      if (*place.vertex >= static_cast<int>(mesh.vertices.size()))
        failAt(list_, pair,
               fmt::format("there is no vertex {} in {}, which has {}, counted from 0",
                           *place.vertex, mesh.name, mesh.vertices.size()));
      if (input_.ownNumbers() && input_.shells().shellVertex[*place.vertex].shell < 0)
        failAt(list_, pair,
               fmt::format("vertex {} of {} belongs to no closed part", *place.vertex, mesh.name));
      requireOnShells(mesh.vertices[*place.vertex], pair);
      return mesh.vertices[*place.vertex];
    }
    const double distance = file_.closest(place.point).distance / diagonal_;
    if (!(distance <= kOnSurface))
      failAt(list_, pair,
             fmt::format(
                 "the point ({:.6g}, {:.6g}, {:.6g}) is {:.2g} of the diagonal away from {}; "
                 "at most {} is taken for the surface",
                 place.point.x, place.point.y, place.point.z, distance, mesh.name, kOnSurface));
    requireOnShells(place.point, pair);
    return place.point;
  }

  // Vertex of shells().mesh.
  int vertexAt(const LandmarkPlace& place, std::size_t pair, double& distance) const {
    distance = 0;
    const Vec3 p = positionOf(place, pair);
    if (place.vertex && input_.ownNumbers()) return *place.vertex;
    const SurfaceShells& shells = input_.shells();
    int best = -1;
    double least = 0;
    for (int v = 0; v < static_cast<int>(shells.mesh.vertices.size()); ++v) {
      if (shells.shellVertex[v].shell < 0) continue;
      const double d = squaredNorm(shells.mesh.vertices[v] - p);
      if (best >= 0 && d >= least) continue;
      best = v;
      least = d;
    }
    distance = std::sqrt(least) / diagonal_;
    return best;
  }

  SurfacePoint pointAt(const LandmarkPlace& place, std::size_t pair) const {
    const Vec3 p = positionOf(place, pair);
    if (place.vertex && input_.ownNumbers())
      for (const int t : inShells_)
        for (int k = 0; k < 3; ++k)
          if (input_.shells().mesh.triangles[t][k] == *place.vertex) {
            SurfacePoint corner{t, {0, 0, 0}};
            corner.barycentric[k] = 1;
            return corner;
          }
    SurfacePoint point = shells_.closest(p).address;
    point.triangle = inShells_[point.triangle];
    return point;
  }

 private:
  static std::vector<int> trianglesOf(const SurfaceShells& shells) {
    std::vector<int> all;
    for (const std::vector<int>& numbers : shells.meshTriangle)
      all.insert(all.end(), numbers.begin(), numbers.end());
    return all;
  }
  static std::vector<Triangle> corners(const SurfaceShells& shells, const std::vector<int>& list) {
    std::vector<Triangle> triangles;
    for (const int t : list) triangles.push_back(shells.mesh.triangles[t]);
    return triangles;
  }

  // What lies inside the solid, or in a part that was left out, has no image.
  void requireOnShells(const Vec3& p, std::size_t pair) const {
    if (input_.ownNumbers()) return;
    const double distance = shells_.closest(p).distance;
    if (distance > 3 * input_.voxelSize)
      failAt(
          list_, pair,
          fmt::format("is {:.2g} of the diagonal away from the surface that is mapped instead of "
                      "{}; choose a place on the outside",
                      distance / diagonal_, input_.mesh.name));
  }

  const LandmarkList& list_;
  const LaidOutMesh& input_;
  double diagonal_;
  TriangleTree file_;
  std::vector<int> inShells_;  // triangles of shells().mesh
  TriangleTree shells_;
};

void requireDistinct(const LandmarkList& list, const std::vector<Landmark>& landmarks,
                     const LaidOutMesh& a, const LaidOutMesh& b, double diagonalB) {
  std::map<std::array<int, 2>, std::size_t> onA;
  std::map<std::array<long long, 3>, std::size_t> onB;
  const double cell = kSamePlace * diagonalB;
  const Vec3 origin = boundingBox(b.mesh).lower;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const ShellVertex v = a.shells().shellVertex[landmarks[i].vertex];
    const auto [first, isNew] = onA.try_emplace({v.shell, v.vertex}, i);
    if (!isNew)
      failAt(list, i,
             fmt::format("its place on {} is vertex {}, like that of {}; leave one out",
                         a.mesh.name, landmarks[i].vertex, whereIs(list, first->second)));
    const Vec3 p = (positionOf(b.shells().mesh, landmarks[i].onTarget) - origin) / cell;
    const auto [same, isOther] =
        onB.try_emplace({std::llround(p.x), std::llround(p.y), std::llround(p.z)}, i);
    if (!isOther)
      failAt(list, i,
             fmt::format("its place on {} is that of {}; leave one out", b.mesh.name,
                         whereIs(list, same->second)));
  }
}

}  // namespace

const char kLandmarkFormat[] =
    "A landmark file has a pair of places a line, first on SOURCE, then on TARGET: two vertices "
    "(`12 240`), "
    "two points of three coordinates, or one of each with the vertex marked by a v (`v12 0.1 0.5 "
    "2`). Vertices are counted from 0 in the file's order (in OBJ files, their number less 1). "
    "Commas may stand between the numbers, # starts a comment. A point on SOURCE is taken as the "
    "nearest vertex.";

LandmarkList readLandmarks(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw FileError(path, "cannot be opened; check the name and its permissions");
  LandmarkList list;
  list.name = path;
  std::string text;
  for (std::size_t number = 1; std::getline(file, text); ++number) {
    if (text.size() > kLongestLine || number > kMostLines)
      fail(path, number, "is too long for a landmark file; give a text file");
    std::vector<std::string> tokens = tokensOf(text);
    if (tokens.empty()) continue;
    LineReader reader(path, number, std::move(tokens));
    LandmarkPair pair;
    pair.line = number;
    pair.onA = reader.next();
    pair.onB = reader.next();
    list.pairs.push_back(pair);
  }
  if (list.pairs.empty()) throw FileError(path, "has no landmarks; give a pair of places a line");
  return list;
}

PlacedLandmarks placeLandmarks(const LandmarkList& list, const LaidOutMesh& a,
                               const LaidOutMesh& b) {
  const Finder onA(list, a), onB(list, b);
  PlacedLandmarks placed;
  double farthest = 0;
  std::size_t farthestPair = 0, moved = 0;
  for (std::size_t i = 0; i < list.pairs.size(); ++i) {
    double distance = 0;
    Landmark landmark;
    landmark.vertex = onA.vertexAt(list.pairs[i].onA, i, distance);
    landmark.onTarget = onB.pointAt(list.pairs[i].onB, i);
    placed.landmarks.push_back(landmark);
    if (distance > 1e-9) ++moved;
    if (distance > farthest) {
      farthest = distance;
      farthestPair = i;
    }
  }
  requireDistinct(list, placed.landmarks, a, b, onB.diagonal());
  if (moved > 0)
    placed.note = fmt::format(
        "{}: {} taken as the nearest vertex of {}, {:.2g} of the diagonal away at most ({})",
        list.name, moved == 1 ? "1 point is" : fmt::format("{} points are", moved), a.mesh.name,
        farthest, whereIs(list, farthestPair));
  placed.far = farthest > kFarVertex;
  return placed;
}

}  // namespace innermap
