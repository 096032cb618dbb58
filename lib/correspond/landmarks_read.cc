// Landmark files in.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include "core/file_bytes.h"
#include "innermap/core/error.h"
#include "innermap/correspond/mesh_correspondence.h"

namespace innermap {
namespace {

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

}  // namespace

const char kLandmarkFormat[] =
    "A landmark file has a pair of places a line, first on SOURCE, then on TARGET: two vertices "
    "(`12 240`), "
    "two points of three coordinates, or one of each with the vertex marked by a v (`v12 0.1 0.5 "
    "2`). Vertices are counted from 0 in the file's order (in OBJ files, their number less 1). "
    "Commas may stand between the numbers, # starts a comment. A point on SOURCE is taken as the "
    "nearest vertex.";

LandmarkList readLandmarks(const std::string& path) {
  const FileBytes file = readFileBytes(path, "a text file of landmarks");
  LandmarkList list;
  list.name = path;
  std::string_view rest = file.bytes;
  for (std::size_t number = 1; !rest.empty(); ++number) {
    const std::string_view text = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(text.size() + 1, rest.size()));
    if (text.size() > kLongestLine || number > kMostLines)
      fail(path, number, "is too long for a landmark file; give a text file");
    std::vector<std::string> tokens = tokensOf(std::string(text));
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

}  // namespace innermap
