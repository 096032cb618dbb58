// innermap_ratios: what innermap costs beside other ways, measured in one run.
#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>

#include "against.h"
#include "growth.h"
#include "innermap/core/run.h"
#include "section.h"

namespace {

using namespace innermap::bench;

struct Section {
  const char* name;
  Tables (*run)(const Options&);
};

constexpr Section kSections[] = {{"placing", placing},   {"sums", sums},
                                 {"solve", solve},       {"tolerance", tolerance},
                                 {"poisson", poisson},   {"sequence", sequence},
                                 {"transfer", transfer}, {"correspond", correspond},
                                 {"levelset", levelset}, {"jobs", jobs}};

// A folder that goes with the object.
class Scratch {
 public:
  Scratch()
      : path_(std::filesystem::temp_directory_path() /
              fmt::format("innermap_ratios.{}", getpid())) {
    std::filesystem::create_directories(path_);
  }
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

Json measure(const std::vector<std::string>& wanted, Options options) {
  options.limits = measureLimits(options.threads, options.quick);
  Json out{{"machine", machine()},
           {"threads", options.threads},
           {"quick", options.quick},
           {"limits", asJson(options.limits)}};
  fmt::print("{}, {} threads\nits limits: {}\n", out["machine"].dump(), options.threads,
             out["limits"].dump());
  for (const Section& section : kSections)
    if (std::find(wanted.begin(), wanted.end(), section.name) != wanted.end())
      out["sections"][section.name] = section.run(options);
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Measures innermap beside other ways; ratios of one run on one machine.");
  Options options;
  options.models = INNERMAP_MODELS;
  options.program = INNERMAP_PROGRAM;
  std::vector<std::string> names, wanted;
  for (const Section& section : kSections) names.push_back(section.name);
  std::string json, chart;
  Against against;
  app.add_option("sections", wanted, "what to measure; everything unless given")
      ->check(CLI::IsMember(names));
  app.add_option("--models", options.models, "folder of the test models")
      ->check(CLI::ExistingDirectory);
  app.add_option("--program", options.program, "the innermap program")->check(CLI::ExistingFile);
  app.add_option("--threads", options.threads, "for all that is measured")
      ->check(CLI::Range(1, 1024));
  app.add_option("--json", json, "also write all figures into this file");
  app.add_option("--chart", chart, "also draw seconds by size into this .svg file");
  app.add_flag("--quick", options.quick, "tiny sizes: shows that it runs, not how fast");
  app.add_option("--against", against.ratios,
                 "innermap_ratios of another build: run it and this one in turn, and print this "
                 "one's seconds over its")
      ->check(CLI::ExistingFile);
  app.add_option("--rounds", against.rounds, "with --against: how often each is run")
      ->check(CLI::Range(1, 100));
  CLI11_PARSE(app, argc, argv);
  if (wanted.empty()) wanted = names;
  try {
    openvdb::initialize();
    const innermap::ThreadLimit limit(options.threads);
    const Scratch scratch;
    options.scratch = scratch.path();
    Json figures;
    if (against.ratios.empty()) {
      figures = measure(wanted, options);
      figures["growth"] = growth(figures["sections"], chart);
    } else {
      figures = compare(against, wanted, options);
    }
    if (!json.empty()) std::ofstream(json) << figures.dump(1) << "\n";
  } catch (const std::exception& error) {
    fmt::print(stderr, "innermap_ratios: {}\n", error.what());
    return 1;
  }
  return 0;
}
