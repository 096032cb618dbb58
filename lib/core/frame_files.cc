#include "core/frame_files.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <map>

#include "innermap/core/error.h"

namespace innermap {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostDigits = 15;
constexpr int kMostPadding = 15;

bool isDigit(char c) { return c >= '0' && c <= '9'; }

// A minus sign, not a hyphen between words.
bool isSign(const std::string& text, std::size_t at) {
  return text[at] == '-' && (at == 0 || text[at - 1] == '.' || text[at - 1] == '_');
}

// A place for a number in a pattern: [begin, end) of the text.
struct NumberPlace {
  std::size_t begin = 0, end = 0;
  int width = 1;
};

std::optional<NumberPlace> percentPlace(const std::string& text, std::size_t at) {
  std::size_t i = at + 1;
  const bool zeros = i < text.size() && text[i] == '0';
  int width = 0;
  for (; i < text.size() && isDigit(text[i]) && width <= kMostPadding; ++i)
    width = 10 * width + (text[i] - '0');
  if (i == text.size() || text[i] != 'd' || width > kMostPadding) return {};
  if (width > 0 && !zeros) return {};  // padded with blanks
  return NumberPlace{at, i + 1, std::max(width, 1)};
}

// #### and %04d in a file's name.
std::vector<NumberPlace> numberPlaces(const std::string& name) {
  std::vector<NumberPlace> places;
  for (std::size_t i = 0; i < name.size(); ++i) {
    if (name[i] == '#') {
      std::size_t end = name.find_first_not_of('#', i);
      if (end == std::string::npos) end = name.size();
      places.push_back({i, end, static_cast<int>(std::min<std::size_t>(end - i, kMostPadding))});
    } else if (name[i] == '%') {
      if (const auto place = percentPlace(name, i)) places.push_back(*place);
    }
    if (!places.empty() && places.back().end > i) i = places.back().end - 1;
  }
  return places;
}

// The end of a number that stands at `from`, as one padded to `width` is written; 0 when none does.
std::size_t numberEnd(const std::string& text, std::size_t from, int width) {
  std::size_t digits = from;
  if (digits < text.size() && isSign(text, digits)) ++digits;
  std::size_t end = digits;
  while (end < text.size() && isDigit(text[end])) ++end;
  const bool padded =
      end - from > static_cast<std::size_t>(width) && end - digits > 1 && text[digits] == '0';
  if (end == digits || end - digits > kMostDigits || padded) return 0;
  return end - from >= static_cast<std::size_t>(width) ? end : 0;
}

std::int64_t numberOf(const std::string& text, std::size_t begin, std::size_t end) {
  std::int64_t value = 0;
  std::from_chars(text.data() + begin, text.data() + end, value);
  return value;
}

// Matches names against a pattern with *, ? and at most one place for a number.
class NamePattern {
 public:
  explicit NamePattern(std::string pattern) : pattern_(std::move(pattern)) {
    const std::vector<NumberPlace> places = numberPlaces(pattern_);
    if (!places.empty()) place_ = places.back();
  }

  bool matches(const std::string& name) {
    number_.reset();
    // As in a shell, names that begin with a dot are found by patterns that do.
    if (!name.empty() && name[0] == '.' && pattern_[0] != '.') return false;
    return matches(name, 0, 0);
  }
  std::optional<std::int64_t> number() const { return number_; }
  bool numbered() const { return place_.has_value(); }

 private:
  bool matches(const std::string& name, std::size_t n, std::size_t p) {
    while (p < pattern_.size()) {
      if (place_ && p == place_->begin) {
        const std::size_t end =
            n > 0 && isDigit(name[n - 1]) ? 0 : numberEnd(name, n, place_->width);
        if (end == 0 || !matches(name, end, place_->end)) return false;
        number_ = numberOf(name, n, end);
        return true;
      }
      if (pattern_[p] == '*') {
        while (p + 1 < pattern_.size() && pattern_[p + 1] == '*') ++p;
        for (std::size_t i = n; i <= name.size(); ++i)
          if (matches(name, i, p + 1)) return true;
        return false;
      }
      if (n == name.size() || (pattern_[p] != '?' && pattern_[p] != name[n])) return false;
      ++n;
      ++p;
    }
    return n == name.size();
  }

  std::string pattern_;
  std::optional<NumberPlace> place_;
  std::optional<std::int64_t> number_;
};

bool hasWildcards(const std::string& text) { return text.find_first_of("*?") != text.npos; }

// Sorted names of what stands in a folder; empty when it cannot be read.
std::vector<fs::path> entries(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code error;
  for (fs::directory_iterator it(folder.empty() ? "." : folder, error), end; !error && it != end;
       it.increment(error))
    found.push_back(it->path().filename());
  std::sort(found.begin(), found.end());
  return found;
}

bool isFile(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

bool isFolder(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

// The folders that a path with wildcards names.
std::vector<fs::path> foldersLike(const fs::path& pattern) {
  std::vector<fs::path> folders{""};
  for (const fs::path& part : pattern) {
    std::vector<fs::path> next;
    for (const fs::path& folder : folders) {
      if (!hasWildcards(part.string())) {
        next.push_back(folder / part);
        continue;
      }
      NamePattern names(part.string());
      for (const fs::path& name : entries(folder))
        if (names.matches(name.string()) && isFolder(folder / name)) next.push_back(folder / name);
    }
    folders = std::move(next);
  }
  return folders;
}

class Finder {
 public:
  explicit Finder(const std::vector<std::string>& extensions) : extensions_(extensions) {}

  void add(const std::string& argument) {
    if (isFile(argument)) return addNamed(argument);
    if (isFolder(argument)) return addFolder(argument);
    const fs::path path(argument);
    if (!hasWildcards(argument) && numberPlaces(path.filename().string()).empty())
      throw FileError(argument,
                      "does not exist; give frames as files, a folder or a pattern such "
                      "as 'frames/*.obj'");
    addPattern(path);
  }

  FrameList list() const {
    FrameList out;
    for (const auto& [number, path] : frames_) out.frames.push_back({number, path});
    out.unnumbered = unnumbered_;
    return out;
  }

 private:
  void put(std::int64_t number, const std::string& path) {
    const auto [at, isNew] = frames_.emplace(number, path);
    if (!isNew && at->second != path)
      throw FileError(path, "has the frame number " + std::to_string(number) + ", as has " +
                                at->second + "; give a pattern that fits one of them");
  }

  void addNamed(const std::string& path) {
    const auto number = frameNumber(path);
    if (!number)
      throw FileError(path, "has no frame number in its name; rename it, as in frame.0001.obj");
    put(*number, path);
  }

  void addFound(const std::string& path, std::optional<std::int64_t> number) {
    if (number)
      put(*number, path);
    else
      unnumbered_.push_back(path);
  }

  void addFolder(const fs::path& folder) {
    bool any = false;
    for (const fs::path& name : entries(folder)) {
      std::string extension = name.extension().string();
      for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
      if (name.string()[0] == '.' || !isFile(folder / name) ||
          std::find(extensions_.begin(), extensions_.end(), extension) == extensions_.end())
        continue;
      addFound((folder / name).string(), frameNumber(name.string()));
      any = true;
    }
    if (!any) throw FileError(folder.string(), "is a folder without meshes; give one with frames");
  }

  void addPattern(const fs::path& pattern) {
    NamePattern names(pattern.filename().string());
    bool any = false;
    for (const fs::path& folder : foldersLike(pattern.parent_path()))
      for (const fs::path& name : entries(folder)) {
        if (!names.matches(name.string()) || !isFile(folder / name)) continue;
        addFound((folder / name).string(),
                 names.numbered() ? names.number() : frameNumber(name.string()));
        any = true;
      }
    if (!any) throw FileError(pattern.string(), "fits no file; check the folder and the pattern");
  }

  const std::vector<std::string>& extensions_;
  std::map<std::int64_t, std::string> frames_;
  std::vector<std::string> unnumbered_;
};

// A whole number at `at`, which moves behind it.
std::optional<std::int64_t> readNumber(const std::string& text, std::size_t& at) {
  std::int64_t value = 0;
  const auto [stop, error] = std::from_chars(text.data() + at, text.data() + text.size(), value);
  if (error != std::errc()) return {};
  at = static_cast<std::size_t>(stop - text.data());
  return value;
}

}  // namespace

std::optional<std::int64_t> frameNumber(const std::string& path) {
  const std::string name = fs::path(path).stem().string();
  std::size_t end = name.size();
  while (end > 0 && !isDigit(name[end - 1])) --end;
  std::size_t begin = end;
  while (begin > 0 && isDigit(name[begin - 1])) --begin;
  if (begin == end || end - begin > kMostDigits) return {};
  if (begin > 0 && isSign(name, begin - 1)) --begin;
  return numberOf(name, begin, end);
}

FrameList findFrames(const std::vector<std::string>& arguments,
                     const std::vector<std::string>& extensions) {
  Finder finder(extensions);
  for (const std::string& argument : arguments) finder.add(argument);
  return finder.list();
}

FrameRanges::FrameRanges(const std::string& setting, const std::string& text) {
  const auto refuse = [&] {
    throw SettingError(setting, "'" + text +
                                    "' is not a range of frames; write 12, 1-48, 1-48x2, "
                                    "or several with commas between");
  };
  for (std::size_t at = 0;;) {
    Range range;
    const auto first = readNumber(text, at);
    if (!first) refuse();
    range.first = range.last = *first;
    if (at < text.size() && text[at] == '-') {
      const auto last = readNumber(text, ++at);
      if (!last || *last < range.first) refuse();
      range.last = *last;
      if (at < text.size() && text[at] == 'x') {
        const auto step = readNumber(text, ++at);
        if (!step || *step < 1) refuse();
        range.step = *step;
      }
    }
    ranges_.push_back(range);
    if (at == text.size()) return;
    if (text[at++] != ',') refuse();
  }
}

bool FrameRanges::contains(std::int64_t number) const {
  return std::any_of(ranges_.begin(), ranges_.end(), [number](const Range& r) {
    // Unsigned: the distance between two numbers may pass the largest.
    return number >= r.first && number <= r.last &&
           (static_cast<std::uint64_t>(number) - static_cast<std::uint64_t>(r.first)) %
                   static_cast<std::uint64_t>(r.step) ==
               0;
  });
}

FramePattern::FramePattern(const std::string& setting, const std::string& text) {
  const fs::path path(text);
  const std::string name = path.filename().string();
  if (name.empty()) throw SettingError(setting, "'" + text + "' names no file; add one");
  folder_ = path.has_parent_path() ? path.parent_path().string() : ".";
  const std::vector<NumberPlace> places = numberPlaces(name);
  if (places.size() > 1)
    throw SettingError(setting, "'" + text + "' has two places for the frame number; keep one");
  const std::string prefix = path.has_parent_path() ? (path.parent_path() / "").string() : "";
  if (places.empty()) {
    before_ = prefix + path.stem().string() + ".";
    after_ = path.extension().string();
    return;
  }
  before_ = prefix + name.substr(0, places[0].begin);
  after_ = name.substr(places[0].end);
  width_ = places[0].width;
}

std::string FramePattern::path(std::int64_t number) const {
  std::string digits = std::to_string(number < 0 ? -number : number);
  const std::size_t wanted = static_cast<std::size_t>(width_) - (number < 0 ? 1 : 0);
  if (digits.size() < wanted) digits.insert(0, wanted - digits.size(), '0');
  return before_ + (number < 0 ? "-" : "") + digits + after_;
}

}  // namespace innermap
