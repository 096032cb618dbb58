#include "study/detail/kept_runs.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <map>
#include <ostream>

#include "core/file.h"
#include "core/unfinished.h"
#include "innermap/core/version.h"

namespace innermap {
namespace {

constexpr const char* kFirstLine = "innermap study run 1";
constexpr std::uintmax_t kLargestFile = 64 << 10;

struct Figure {
  const char* name;
  double StudyRow::*value;
};
constexpr Figure kFigures[] = {{"c_error", &StudyRow::cError},
                               {"collocation_rms", &StudyRow::collocationRms},
                               {"rms", &StudyRow::rms},
                               {"p99", &StudyRow::p99},
                               {"max", &StudyRow::max},
                               {"harmonic_energy", &StudyRow::harmonicEnergy},
                               {"deformation_energy", &StudyRow::deformationEnergy},
                               {"jacobian_min", &StudyRow::jacobianMin},
                               {"folded", &StudyRow::folded},
                               {"weights", &StudyRow::weights},
                               {"condition", &StudyRow::condition},
                               {"regularization", &StudyRow::regularization},
                               {"seconds", &StudyRow::seconds},
                               {"seconds_overall", &StudyRow::secondsOverall}};

template <class T>
std::uint64_t hashOfAll(const std::vector<T>& values) {
  return hashOf({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)});
}

std::string oneLine(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return text;
}

template <class Number>
bool parse(const std::map<std::string, std::string>& fields, const char* name, Number& value) {
  const auto found = fields.find(name);
  if (found == fields.end()) return false;
  const std::string& text = found->second;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && stop == text.data() + text.size();
}

// "name value" lines up to "end"; nothing when the file is not whole.
std::optional<std::map<std::string, std::string>> readFields(const std::string& path) {
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  if (error || size > kLargestFile) return {};
  std::ifstream file(path);
  std::string line;
  if (!std::getline(file, line) || line != kFirstLine) return {};
  std::map<std::string, std::string> fields;
  while (std::getline(file, line)) {
    if (line == "end") return fields;
    const std::size_t space = line.find(' ');
    if (space == std::string::npos) return {};
    fields[line.substr(0, space)] = line.substr(space + 1);
  }
  return {};
}

}  // namespace

KeptRuns::KeptRuns(const BoundaryPair& pair, const StudySettings& settings)
    : folder_(settings.folder) {
  if (folder_.empty()) return;
  common_ = fmt::format(
      "version={} source={:016x}-{:016x} target={:016x} interpolation={} method={} "
      "regularization={} resolution={} lambda={} mu={} seed={}",
      versionText(), hashOfAll(pair.source.mesh.vertices), hashOfAll(pair.source.mesh.triangles),
      hashOfAll(pair.targetMesh.vertices), static_cast<int>(settings.interpolation),
      static_cast<int>(settings.method),
      settings.regularization ? fmt::format("{}", *settings.regularization) : "chosen",
      settings.resolution, settings.lame.lambda, settings.lame.mu, settings.seed);
}

std::string KeptRuns::keyOf(const StudyRun& run) const {
  return fmt::format("{} sources={} points={} {}={}", common_, run.sources, collocationOf(run),
                     run.placement == ChargePlacement::sphere ? "sphere" : "offset", run.at);
}

std::string KeptRuns::pathOf(const std::string& key) const {
  return (std::filesystem::path(folder_) / fmt::format("{:016x}.run", hashOf(key))).string();
}

std::optional<StudyRow> KeptRuns::find(const StudyRun& run) const {
  if (folder_.empty()) return {};
  const std::string key = keyOf(run);
  const auto fields = readFields(pathOf(key));
  if (!fields || fields->count("key") == 0 || fields->at("key") != key) return {};
  StudyRow row;
  static_cast<StudyRun&>(row) = run;
  row.kept = true;
  row.points = collocationOf(run);
  if (fields->count("failure")) {
    row.failure = fields->at("failure");
    return row;
  }
  for (const Figure& figure : kFigures)
    if (!parse(*fields, figure.name, row.*figure.value)) return {};
  if (!parse(*fields, "rank", row.rank)) return {};
  return row;
}

void KeptRuns::keep(const StudyRow& row) const {
  if (folder_.empty()) return;
  const std::string key = keyOf(row);
  makeFolder(folder_);
  const KeptWork guard;
  writeWholeFile(pathOf(key), [&](std::ostream& file) {
    file << kFirstLine << "\nkey " << key << "\n";
    if (!row.failure.empty()) {
      file << "failure " << oneLine(row.failure) << "\n";
    } else {
      for (const Figure& figure : kFigures)
        file << figure.name << " " << fmt::format("{}", row.*figure.value) << "\n";
      file << "rank " << row.rank << "\n";
    }
    file << "end\n";
  });
}

}  // namespace innermap
