// Landmark files in.
#include <fmt/format.h>

#include <limits>

#include "core/text_scanner.h"
#include "innermap/core/error.h"
#include "innermap/correspond/mesh_correspondence.h"

namespace innermap {
namespace {

constexpr std::size_t kLongestLine = 4096, kMostLines = 1000000;

std::vector<std::string_view> tokensOf(TextScanner& scanner) {
  std::vector<std::string_view> tokens;
  for (std::string_view token; scanner.token(token); tokens.push_back(token))
    if (scanner.position() - scanner.lineBegin() > kLongestLine)
      scanner.fail("is too long for a landmark file; give a text file");
  return tokens;
}

// One line's tokens, taken place by place.
class LineReader {
 public:
  LineReader(const TextScanner& scanner, std::vector<std::string_view> tokens)
      : scanner_(scanner), tokens_(std::move(tokens)) {
    const bool pairOfNumbers = tokens_.size() == 2, pairOfPoints = tokens_.size() == 6;
    const bool marked = tokens_.size() == 4 && (isMarked(tokens_[0]) || isMarked(tokens_[3]));
    if (!pairOfNumbers && !pairOfPoints && !marked)
      scanner.fail(
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
    for (int axis = 0; axis < 3; ++axis) place.point[axis] = scanner_.number(tokens_[at_++]);
    return place;
  }

 private:
  static bool isMarked(std::string_view token) { return token[0] == 'v' || token[0] == 'V'; }

  int vertex(std::string_view token) const {
    const std::optional<std::int64_t> value = parseInteger(token.substr(isMarked(token) ? 1 : 0));
    if (!value || *value < 0 || *value > std::numeric_limits<int>::max())
      scanner_.fail(inQuotes(token) + " is no vertex; vertices are counted from 0");
    return static_cast<int>(*value);
  }

  const TextScanner& scanner_;
  std::size_t at_ = 0;
  std::vector<std::string_view> tokens_;
  bool pointsOnly_ = false;
};

}  // namespace

const char kLandmarkFormat[] =
    "A landmark file has one pair of places on each line, first on SOURCE, then on TARGET: two "
    "vertices (`12 240`), two points of three coordinates, or one of each with the vertex marked "
    "by a v (`v12 0.1 0.5 2`). Vertices are counted from 0 in the file's order (in OBJ files, "
    "their number less 1). Commas may stand between the numbers; # starts a comment. A point on "
    "SOURCE stands for the nearest vertex.";

LandmarkList readLandmarks(const std::string& path) {
  FileBytes file = readFileBytes(path, "a text file of landmarks");
  // What may stand between numbers.
  for (char& c : file.bytes)
    if (c == ',' || c == ';' || (static_cast<unsigned char>(c) < 32 && c != '\n' && c != '\r'))
      c = ' ';
  TextScanner scanner(file, {true, false});
  LandmarkList list;
  list.name = path;
  for (std::size_t number = 1; scanner.nextLine(); ++number) {
    if (number > kMostLines) scanner.fail("is too long for a landmark file; give a text file");
    std::vector<std::string_view> tokens = tokensOf(scanner);
    if (tokens.empty()) continue;
    LineReader reader(scanner, std::move(tokens));
    LandmarkPair pair;
    pair.line = number;
    pair.onA = reader.next();
    pair.onB = reader.next();
    list.pairs.push_back(pair);
  }
  if (list.pairs.empty()) throw FileError(path, "has no landmarks; give a pair of places a line");
  return list;
}

}  // namespace innermap
