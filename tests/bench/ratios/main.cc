// innermap_ratios: what innermap costs beside other ways, measured in one run.
#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>

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
                                 {"jobs", jobs}};

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

Json measure(const std::vector<std::string>& wanted, const Options& options) {
  Json out{{"machine", machine()}, {"threads", options.threads}, {"quick", options.quick}};
  fmt::print("{}, {} threads\n", out["machine"].dump(), options.threads);
  for (const Section& section : kSections) {
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), section.name) == wanted.end())
      continue;
    out["sections"][section.name] = section.run(options);
  }
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
  std::string json;
  app.add_option("sections", wanted, "what to measure; everything unless given")
      ->check(CLI::IsMember(names));
  app.add_option("--models", options.models, "folder of the test models")
      ->check(CLI::ExistingDirectory);
  app.add_option("--program", options.program, "the innermap program")->check(CLI::ExistingFile);
  app.add_option("--threads", options.threads, "for all that is measured")
      ->check(CLI::Range(1, 1024));
  app.add_option("--json", json, "also write all figures into this file");
  app.add_flag("--quick", options.quick, "tiny sizes: shows that it runs, not how fast");
  CLI11_PARSE(app, argc, argv);
  try {
    openvdb::initialize();
    const innermap::ThreadLimit limit(options.threads);
    const Scratch scratch;
    options.scratch = scratch.path();
    const Json figures = measure(wanted, options);
    if (!json.empty()) std::ofstream(json) << figures.dump(1) << "\n";
  } catch (const std::exception& error) {
    fmt::print(stderr, "innermap_ratios: {}\n", error.what());
    return 1;
  }
  return 0;
}
