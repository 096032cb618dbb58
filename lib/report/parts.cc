#include "report/parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <ostream>
#include <set>
#include <sstream>

#include "core/file.h"
#include "core/unfinished.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/core/version.h"
#include "report/detail/part_json.h"
#include "solve/vector_code.h"

namespace innermap {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFolder = "parts";
constexpr std::uintmax_t kMostBytes = 64'000'000;  // of one file

std::string partsOf(const std::string& folder) { return (fs::path(folder) / kFolder).string(); }

std::string readText(const fs::path& path) {
  std::error_code failed;
  const std::uintmax_t size = fs::file_size(path, failed);
  if (failed) throw FileError(path.string(), "cannot be read (" + failed.message() + ")");
  if (size > kMostBytes) throw FileError(path.string(), "is too large to be a part of a run");
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) throw FileError(path.string(), "cannot be read to its end");
  return text.str();
}

// Names of the files that begin so and end in .json, sorted.
std::vector<std::string> filesOf(const std::string& folder, const std::string& prefix) {
  std::vector<std::string> names;
  std::error_code failed;
  for (fs::directory_iterator at(folder, failed), end; !failed && at != end; at.increment(failed)) {
    const std::string name = at->path().filename().string();
    if (name.rfind(prefix, 0) == 0 && at->path().extension() == ".json") names.push_back(name);
  }
  if (failed) throw FileError(folder, "cannot be listed (" + failed.message() + ")");
  std::sort(names.begin(), names.end());
  return names;
}

std::string framePrefix(std::int64_t frame) { return fmt::format("frame.{:04}.", frame); }

PartRun readRun(const fs::path& path) {
  PartRun run = parseRun(path.string(), readText(path));
  if (run.version != versionText())
    throw DataError(
        fmt::format("{}: innermap {} made these parts, and this is {}; use that version, or remove "
                    "{} and make them again",
                    path.string(), run.version, versionText(), path.parent_path().string()));
  if (path.filename() != runName(fingerprintOf(run)))
    throw DataError(path.string() +
                    ": has changed since it was written (its name does not fit); remove it, and "
                    "make a share again");
  return run;
}

Part readPart(const fs::path& path, const std::string& run) {
  Part part = parsePart(path.string(), readText(path), run);
  if (path.filename() != partName(part, run))
    throw DataError(path.string() +
                    ": has changed since it was written (its name does not fit); remove it, and "
                    "make its share again");
  return part;
}

void writeText(const std::string& path, const std::string& text) {
  const KeptWork kept;
  writeWholeFile(path, [&](std::ostream& file) { file << text; });
}

// What tells two runs apart, in words.
std::string difference(const PartRun& a, const PartRun& b) {
  if (a.command != b.command) return fmt::format("{} and {}", a.command, b.command);
  for (std::size_t i = 0; i < std::min(a.settings.size(), b.settings.size()); ++i) {
    const std::string one = valueText(a.settings[i].second), two = valueText(b.settings[i].second);
    if (a.settings[i].first != b.settings[i].first || one != two)
      return fmt::format("{} {} and {}", a.settings[i].first, one, two);
  }
  if (a.inputs != b.inputs) return "the content of the files that they read";
  return fmt::format("{} and {} {}s, or their numbers", a.frames.size(), b.frames.size(),
                     unitOf(a));
}

}  // namespace

std::string unitOf(const PartRun& run) {
  return run.command == "sequence" || run.command == "deform" ? "frame" : "block";
}

PartFolder::PartFolder(const std::string& folder, const PartRun& run)
    : folder_(partsOf(folder)), fingerprint_(fingerprintOf(run)) {
  makeFolder(folder_);
  for (const std::string& name : filesOf(folder_, "run.")) {
    if (name == runName(fingerprint_)) continue;
    const PartRun other = readRun(fs::path(folder_) / name);
    throw DataError(fmt::format(
        "{}: holds parts of another run (they differ in {}); give another --output, or remove it",
        folder_, difference(other, run)));
  }
  // Without the run, it is made from the beginning.
  std::error_code none;
  if (fs::exists(fs::path(folder_) / runName(fingerprint_), none))
    there_ = filesOf(folder_, "frame.");
}

std::optional<Part> PartFolder::find(std::int64_t frame, const std::string& input) const {
  const std::string prefix = framePrefix(frame);
  for (const std::string& name : there_) {
    if (name.rfind(prefix, 0) != 0) continue;
    try {
      Part part = readPart(fs::path(folder_) / name, fingerprint_);
      if (part.broken.empty() && part.input == input) return part;
    } catch (const Error&) {  // as if it were not there
    }
  }
  return {};
}

void PartFolder::writeRun(const PartRun& run) {
  const std::string path = (fs::path(folder_) / runName(fingerprint_)).string();
  try {
    readRun(path);
  } catch (const Error&) {
    writeText(path, runJson(run));
  }
}

void PartFolder::write(const Part& part) {
  writeText((fs::path(folder_) / partName(part, fingerprint_)).string(),
            partJson(part, fingerprint_));
}

namespace {

PartRun theRun(const std::string& folder) {
  std::error_code none;
  if (!fs::is_directory(folder, none))
    throw FileError(folder, "is not there; give the output folder of a run with --share");
  const std::vector<std::string> names = filesOf(folder, "run.");
  if (names.empty())
    throw FileError(folder, "holds no parts of a run yet; give the output of a run with --share");
  const PartRun run = readRun(fs::path(folder) / names.front());
  if (names.size() > 1) {
    const PartRun other = readRun(fs::path(folder) / names[1]);
    throw DataError(fmt::format(
        "{}: holds parts of {} runs ({}, {}; they differ in {}); remove the parts of one", folder,
        names.size(), names[0], names[1], difference(run, other)));
  }
  return run;
}

// One of a frame: a good one rather than a broken one.
void keep(std::map<std::int64_t, std::pair<Part, std::string>>& found, Part part,
          const std::string& path, const std::string& unit) {
  const std::int64_t frame = part.frame;
  const auto at = found.find(frame);
  if (at == found.end()) {
    found.emplace(frame, std::make_pair(std::move(part), path));
    return;
  }
  const bool newIsGood = part.broken.empty(), oldIsGood = at->second.first.broken.empty();
  if (newIsGood && oldIsGood)
    throw DataError(fmt::format(
        "{} {} was made twice with different results: {} ({}, {}) and {} ({}, {}); {}", unit, frame,
        at->second.second, at->second.first.host, at->second.first.code, path, part.host, part.code,
        at->second.first.input != part.input
            ? "its file was changed in between: remove the older one"
            : "remove one of them, and make all with one --cpu-target"));
  const std::uint64_t failures = at->second.first.failures + 1;
  if (newIsGood) at->second = {std::move(part), path};
  at->second.first.failures = failures;
}

}  // namespace

JoinedParts readParts(const std::string& folder) {
  const std::string place = partsOf(folder);
  JoinedParts out{theRun(place), {}, {}};
  const std::string fingerprint = fingerprintOf(out.run);
  std::set<std::int64_t> wanted;
  for (const FrameFile& frame : out.run.frames) wanted.insert(frame.number);
  std::map<std::int64_t, std::pair<Part, std::string>> found;
  const std::vector<std::string> names = filesOf(place, "frame.");
  for (std::size_t i = 0; i < names.size(); ++i) {
    reportProgress("read", static_cast<double>(i) / static_cast<double>(names.size()));
    throwIfCancelled();
    const fs::path path = fs::path(place) / names[i];
    Part part = readPart(path, fingerprint);
    if (wanted.count(part.frame) == 0)
      throw DataError(fmt::format("{}: {} {} is none of the run's; remove it", path.string(),
                                  unitOf(out.run), part.frame));
    keep(found, std::move(part), path.string(), unitOf(out.run));
  }
  for (const FrameFile& frame : out.run.frames)
    if (const auto at = found.find(frame.number); at != found.end())
      out.parts.push_back(std::move(at->second.first));
    else
      out.missing.push_back(frame.number);
  return out;
}

bool isWhole(const std::string& path, const std::string& fingerprint) {
  std::error_code failed;
  const std::uintmax_t size = fs::file_size(path, failed);
  return !failed && fingerprint.rfind(fmt::format("{}-", size), 0) == 0;
}

std::string framesText(const std::vector<std::int64_t>& frames) {
  constexpr std::size_t kShown = 20;
  const std::size_t shown = std::min(frames.size(), kShown);
  std::vector<std::int64_t> first(frames.begin(),
                                  frames.begin() + static_cast<std::ptrdiff_t>(shown));
  const std::size_t more = frames.size() - shown;
  return fmt::format("{}{}", fmt::join(first, ", "),
                     more ? fmt::format(" and {} more", more) : std::string());
}

std::string partCode() { return vectorCode(); }

const std::vector<std::string>& cpuNames() { return cpuTargets(); }

void keepToCpu(const std::string& setting, const std::string& name) { setCpuTarget(setting, name); }

namespace {

const FigureValue* valueAt(const PartValues& values, const std::string& key) {
  for (const auto& [name, value] : values)
    if (name == key) return &value;
  return nullptr;
}

}  // namespace

double numberAt(const PartValues& values, const std::string& key) {
  const FigureValue* value = valueAt(values, key);
  if (value) {
    if (const auto* d = std::get_if<double>(value)) return *d;
    if (const auto* i = std::get_if<std::int64_t>(value)) return static_cast<double>(*i);
    if (const auto* u = std::get_if<std::uint64_t>(value)) return static_cast<double>(*u);
  }
  return std::numeric_limits<double>::quiet_NaN();
}

std::uint64_t countAt(const PartValues& values, const std::string& key) {
  const FigureValue* value = valueAt(values, key);
  if (!value) return 0;
  if (const auto* b = std::get_if<bool>(value)) return *b ? 1 : 0;
  const auto* count = std::get_if<std::uint64_t>(value);
  return count ? *count : 0;
}

std::vector<double> numbersAt(const PartValues& values, const std::string& key) {
  const FigureValue* value = valueAt(values, key);
  const auto* numbers = value ? std::get_if<std::vector<double>>(value) : nullptr;
  return numbers ? *numbers : std::vector<double>();
}

std::string textAt(const PartValues& values, const std::string& key) {
  const FigureValue* value = valueAt(values, key);
  const auto* text = value ? std::get_if<std::string>(value) : nullptr;
  return text ? *text : std::string();
}

}  // namespace innermap
