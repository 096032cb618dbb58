#include "against.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>

#include "innermap/core/error.h"
#include "program.h"

namespace innermap::bench {
namespace {

using Strings = std::vector<std::string>;

struct Figure {
  std::string row, column;
  std::vector<double> here, there;
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return 0.5 * (values[(n - 1) / 2] + values[n / 2]);
}

bool isTime(const std::string& column) {
  constexpr const char* kOthers[] = {"limit s", "direct s", "meshToVolume s", "meshToVolume cpu s"};
  const auto ends = [&](const std::string& end) {
    return column.size() >= end.size() &&
           column.compare(column.size() - end.size(), end.size(), end) == 0;
  };
  return (column == "seconds" || ends(" s")) &&
         std::find(std::begin(kOthers), std::end(kOthers), column) == std::end(kOthers);
}

Json readJson(const std::string& file) {
  std::ifstream in(file);
  Json out = Json::parse(in, nullptr, false);
  if (!out.is_object()) throw Error(file + ": innermap_ratios wrote no figures");
  return out;
}

class Builds {
 public:
  Builds(const Against& against, const Options& options) : against_(against), options_(options) {
    const std::filesystem::path folder =
        std::filesystem::canonical(against.ratios).parent_path() / "../../tools/innermap";
    otherProgram_ = folder.lexically_normal().string();
    if (!std::filesystem::is_regular_file(otherProgram_))
      throw Error(otherProgram_ + ": the other build's program is not there; build it");
    const std::string help = options.scratch + "/help";
    runProcess({against.ratios, "--help"}, help);
    std::ifstream in(help);
    std::getline(std::getline(in, otherSections_, '{'), otherSections_, '}');
  }

  Json here(const std::string& section) const {
    return run("/proc/self/exe", options_.program, section);
  }

  // Empty if it has not the section.
  Json there(const std::string& section) const {
    if (otherSections_.find(section) == std::string::npos) return Json::array();
    return run(against_.ratios, otherProgram_, section);
  }

  Json thereByProgram(const std::string& section) const {
    return run("/proc/self/exe", otherProgram_, section);
  }

 private:
  Json run(const std::string& ratios, const std::string& program,
           const std::string& section) const {
    const std::string file = options_.scratch + "/turn.json";
    std::remove(file.c_str());
    Strings words{
        ratios,          section,     "--json", file,        "--models",
        options_.models, "--program", program,  "--threads", std::to_string(options_.threads)};
    if (options_.quick) words.push_back("--quick");
    if (runProcess(words).exitCode != 0) throw Error(ratios + " " + section + ": failed");
    return readJson(file)["sections"][section];
  }

  const Against& against_;
  const Options& options_;
  std::string otherProgram_, otherSections_;
};

// The row of the other's table that this one's row `r` means: the same first cell, as often seen.
const Json* sameRow(const Json& rows, std::size_t r, const Json& others) {
  const auto first = [](const Json& row) { return row.begin().value(); };
  std::size_t before = 0;
  for (std::size_t i = 0; i < r; ++i) before += first(rows[i]) == first(rows[r]);
  for (const Json& row : others)
    if (first(row) == first(rows[r]) && before-- == 0) return &row;
  return nullptr;
}

void add(std::vector<Figure>& figures, const std::string& row, const std::string& column,
         double here, double there) {
  auto at = std::find_if(figures.begin(), figures.end(),
                         [&](const Figure& f) { return f.row == row && f.column == column; });
  if (at == figures.end()) at = figures.insert(at, {row, column, {}, {}});
  at->here.push_back(here);
  at->there.push_back(there);
}

// Table t of a section, of both.
void collect(std::size_t t, const Json& here, const Json& there, std::vector<Figure>& figures) {
  for (std::size_t r = 0; r < here.size(); ++r) {
    const Json* other = sameRow(here, r, there);
    if (!other) continue;
    const Json& name = here[r].begin().value();
    const std::string row = fmt::format("{}.{} {}", t + 1, r + 1,
                                        name.is_string() ? name.get<std::string>() : name.dump());
    for (const auto& [column, value] : here[r].items()) {
      // Earlier builds called it so.
      const std::string their =
          column == "process s" && !other->contains(column) ? "seconds" : column;
      if (!isTime(column) || !other->contains(their)) continue;
      const double a = value.get<double>(), b = (*other)[their].get<double>();
      if (a > 0 && b > 0) add(figures, row, column, a, b);
    }
  }
}

// Once each. A table that the other lacks is measured with its program, if it runs the program.
void takeTurn(const Builds& builds, const std::string& section, bool otherFirst,
              std::vector<Figure>& figures) {
  Json there;
  if (otherFirst) there = builds.there(section);
  const Json here = builds.here(section);
  if (!otherFirst) there = builds.there(section);
  Json more;
  for (std::size_t t = 0; t < here.size(); ++t) {
    const Json& rows = here[t]["rows"];
    if (t < there.size()) {
      collect(t, rows, there[t]["rows"], figures);
    } else if (rows[0].contains("process s")) {
      if (more.is_null()) more = builds.thereByProgram(section);
      collect(t, rows, more[t]["rows"], figures);
    }
  }
}

}  // namespace

Json compare(const Against& against, const Strings& sections, const Options& options) {
  const Builds builds(against, options);
  std::map<std::string, std::vector<Figure>> figures;
  for (int round = 0; round < against.rounds; ++round)
    for (const std::string& section : sections)
      takeTurn(builds, section, round % 2 == 1, figures[section]);
  Table table("This build over " + against.ratios);
  for (const std::string& section : sections) {
    for (const Figure& f : figures[section]) {
      std::vector<double> ratios;
      for (std::size_t i = 0; i < f.here.size(); ++i) ratios.push_back(f.here[i] / f.there[i]);
      const auto [least, most] = std::minmax_element(ratios.begin(), ratios.end());
      table.add({{"table, row", section + " " + f.row},
                 {"figure", f.column},
                 {"this", median(f.here)},
                 {"other", median(f.there)},
                 {"ratio", median(ratios)},
                 {"least", *least},
                 {"most", *most}});
    }
  }
  table.note(fmt::format("medians of {} rounds in turn", against.rounds));
  return {{"against", table.json()}};
}

}  // namespace innermap::bench
