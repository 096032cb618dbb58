// `innermap report`: the page of an output folder, from its files.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "commands.h"
#include "innermap/core/run.h"
#include "innermap/io/vdb_file.h"
#include "innermap/mesh/mesh_file.h"
#include "inputs.h"
#include "report/page/contents.h"
#include "report_page.h"

namespace innermap::tool {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct ReportOptions {
  std::string folder, output;
};

constexpr std::uintmax_t kMostReportBytes = 64'000'000;
constexpr int kDeepest = 32;  // levels of sections in sections

// Reports may come from anywhere: nothing is taken for granted.
Json readReport(const std::string& path) {
  std::error_code failed;
  const std::uintmax_t size = fs::file_size(path, failed);
  if (failed)
    throw FileError(path, "cannot be read; give a folder that innermap wrote, with a report.json");
  if (size > kMostReportBytes) throw FileError(path, "is too large to be a report of innermap");
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  const auto shallow = [](int depth, Json::parse_event_t, Json&) { return depth <= kDeepest; };
  Json report = Json::parse(text.str(), shallow, false);
  if (!report.is_object()) throw FileError(path, "is no report of innermap (not a JSON object)");
  return report;
}

const Json* at(const Json& report, const char* section, const char* key) {
  const auto found = report.find(section);
  if (found == report.end() || !found->is_object()) return nullptr;
  const auto value = found->find(key);
  return value == found->end() ? nullptr : &*value;
}

std::string sectionText(const Json& report, const char* section, const char* key) {
  const Json* value = at(report, section, key);
  return value && value->is_string() ? value->get<std::string>() : "";
}

// Reads with `body`; what cannot be read is said in the page.
template <class Body>
bool tried(Page& page, const Body& body) {
  try {
    body();
    return true;
  } catch (const FileError& error) {
    page.missing.push_back(error.what());
  } catch (const DataError& error) {
    page.missing.push_back(error.what());
  } catch (const MemoryError& error) {
    page.missing.push_back(error.what());
  }
  return false;
}

// As the report names it, or of that name in the folder.
std::string found(const std::string& path, const fs::path& folder) {
  if (fs::exists(path)) return path;
  const fs::path beside = folder / fs::path(path).filename();
  return fs::exists(beside) ? beside.string() : path;
}

// As the run was told.
SpaceSettings spaceOf(const Json& report) {
  SpaceSettings space;
  const auto axis = [&](const char* key, std::optional<UpAxis>* up) {
    const std::string text = sectionText(report, "settings", key);
    if (text == "y" || text == "z") *up = text == "z" ? UpAxis::z : UpAxis::y;
  };
  const auto unit = [&](const char* key, std::optional<double>* metres) {
    if (const Json* v = at(report, "settings", key); v && v->is_number())
      *metres = v->get<double>();
  };
  axis("up", &space.up);
  axis("out_up", &space.outUp);
  unit("unit_scale", &space.unitScale);
  unit("out_unit_scale", &space.outUnitScale);
  return space;
}

AnimationSettings animationOf(const Json& report) {
  AnimationSettings settings;
  const Json* first = at(report, "settings", "first_frame");
  if (first && first->is_number_integer()) settings.firstFrame = first->get<int>();
  if (const Json* fps = at(report, "settings", "fps"); fps && fps->is_number())
    settings.framesPerSecond = fps->get<double>();
  const Json* restFrame = at(report, "settings", "rest");
  if (restFrame && restFrame->is_number_integer()) settings.restFrame = restFrame->get<int>();
  settings.space = spaceOf(report);
  settings.mesh = sectionText(report, "settings", "mesh");
  settings.animation = sectionText(report, "settings", "animation");
  return settings;
}

// Files that hold all frames, each opened once.
using Sources = std::map<std::string, std::unique_ptr<FrameSource>>;

// Frame `number` of a file, which may hold all of them.
Mesh readFrame(const std::string& path, std::int64_t number, const Json& report, const Mesh& rest,
               Sources& sources) {
  if (!isAnimationFile(path)) {
    Mesh mesh = readMeshLike(path, rest);
    move(mesh.vertices, inputToOutput(spaceOf(report)));
    return mesh;
  }
  std::unique_ptr<FrameSource>& source = sources[path];
  if (!source) source = openFrames({path}, animationOf(report));
  const auto place = std::find(source->numbers.begin(), source->numbers.end(), number);
  if (place == source->numbers.end())
    throw DataError(fmt::format("{}: has no frame {}", path, number));
  return source->read(static_cast<std::size_t>(place - source->numbers.begin()), rest);
}

void addFrames(Page& page, const Json& report, const Mesh& rest, const fs::path& folder) {
  const Json *files = at(report, "frames", "file"), *numbers = at(report, "frames", "number");
  if (!files || !numbers || !files->is_array() || !numbers->is_array()) return;
  const std::size_t count = std::min(files->size(), numbers->size());
  PageFrames frames(page, rest, count);
  Sources sources;
  for (std::size_t i = 0; i < count; ++i) {
    throwIfCancelled();
    const Json &file = (*files)[i], &number = (*numbers)[i];
    if (!file.is_string() || !number.is_number()) continue;
    tried(page, [&] {
      const std::int64_t which = std::llround(number.get<double>());
      const std::string path = found(file.get<std::string>(), folder);
      frames.add(which, readFrame(path, which, report, rest, sources).vertices);
    });
  }
}

void addSurfaces(Page& page, const Json& report, const fs::path& folder) {
  const std::string map = (folder / "map.ply").string();
  if (fs::exists(map) && tried(page, [&] { showMap(page, readMap(map)); })) return;
  const std::string source = sectionText(report, "source", "path");
  const std::string target = sectionText(report, "target", "path");
  if (source.empty()) return page.missing.push_back("surfaces: the report names no mesh");
  Mesh rest;
  if (!tried(page, [&] {
        const std::string path = found(source, folder);
        rest = isGltf(path) ? readRestPose(path, animationOf(report))
                            : readMesh(path, spaceOf(report));
      }))
    return;
  if (at(report, "frames", "file")) return addFrames(page, report, rest, folder);
  addMesh(page, rest);
  if (target.empty()) return;
  tried(page, [&] {
    const Mesh other = readMesh(found(target, folder), spaceOf(report));
    if (other.triangles == rest.triangles && other.vertices.size() == rest.vertices.size())
      showPair(page, rest, other.vertices);
    else
      addMesh(page, other);
  });
}

// The frame whose number a file's name ends in.
std::optional<PageFrame> frameOf(const std::string& path, const Json& report) {
  const Json* numbers = at(report, "frames", "number");
  const std::string name = fs::path(path).stem().string();
  const std::size_t begin = name.find_last_not_of("0123456789") + 1;
  if (!numbers || !numbers->is_array() || begin >= name.size() || name.size() - begin > 15)
    return std::nullopt;
  const std::int64_t number = std::stoll(name.substr(begin));
  for (std::size_t i = 0; i < numbers->size(); ++i)
    if ((*numbers)[i].is_number() && std::llround((*numbers)[i].get<double>()) == number)
      return PageFrame{number, i, numbers->size()};
  return std::nullopt;
}

struct GridFile {
  std::string path;
  std::optional<PageFrame> frame;  // whose it is
};

// Those that the page shows: of frames only some, and some of the others.
std::vector<GridFile> gridFiles(const Json& report, const fs::path& folder) {
  constexpr std::size_t kMostFiles = 8;
  std::vector<std::string> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (entry.is_regular_file() && entry.path().extension() == ".vdb")
      files.push_back(entry.path().string());
  std::sort(files.begin(), files.end());
  std::vector<GridFile> shown;
  std::size_t others = 0;
  for (const std::string& file : files) {
    const std::optional<PageFrame> frame = frameOf(file, report);
    if (frame ? frame->index % frameStep(frame->of) == 0 : ++others <= kMostFiles)
      shown.push_back({file, frame});
  }
  return shown;
}

void addGridsOf(Page& page, const Json& report, const fs::path& folder) {
  const std::vector<GridFile> files = gridFiles(report, folder);
  if (files.empty()) page.missing.push_back("sections: the folder has no .vdb file");
  // Grids of one name are shown once, or once a frame.
  for (const GridFile& file : files) {
    page.frame = file.frame;
    tried(page, [&] { addGrids(page, readVdb(file.path).grids); });
  }
  page.frame.reset();
}

// Of the largest grid file and of all surfaces, as they are read, and of the page.
std::uint64_t memoryOf(const Json& report, const fs::path& folder) {
  std::uint64_t grids = 0;
  double surfaces = 0;
  Page unsaid;
  for (const GridFile& file : gridFiles(report, folder))
    tried(unsaid, [&] { grids = std::max(grids, readMemory(readVdbInfo(file.path), {})); });
  for (const std::string& path :
       {(folder / "map.ply").string(), found(sectionText(report, "source", "path"), folder),
        found(sectionText(report, "target", "path"), folder)}) {
    std::error_code none;
    if (const std::uintmax_t size = fs::file_size(path, none); !none)
      surfaces += kMeshByte * static_cast<double>(size);
  }
  return std::max(grids, static_cast<std::uint64_t>(surfaces)) + kPageMemory;
}

void run(const ReportOptions& options, Context& context) {
  const fs::path folder(options.folder);
  const std::string output =
      options.output.empty() ? (folder / "report.html").string() : options.output;
  const std::string json = (folder / "report.json").string();
  context.input(json);
  if (!fs::is_directory(folder)) throw FileError(options.folder, "is no folder");
  const Json report = readReport(json);
  context.output(output);
  if (context.dryRun())
    return context.plan({"write the page of " + json + " to " + output}, memoryOf(report, folder));
  Page page;
  context.timed("surfaces", [&] { addSurfaces(page, report, folder); });
  context.timed("sections", [&] { addGridsOf(page, report, folder); });
  context.timed("write", [&] {
    writePage(output, page, report.dump(-1, ' ', false, Json::error_handler_t::replace));
  });
  for (const std::string& text : page.missing) context.note("not shown: " + text);
  context.print(
      fmt::format("{}: {:.1f} MB\n", output, static_cast<double>(fs::file_size(output)) / 1e6));
}

}  // namespace

void showOutputs(Page& page, const std::string& report, const std::string& folder) {
  const Json parsed = Json::parse(report);
  addSurfaces(page, parsed, folder);
  addGridsOf(page, parsed, folder);
}

Command makeReportCommand() {
  auto o = std::make_shared<ReportOptions>();
  Command c("report", "Make the page of an output folder, to look at in a browser");
  c.description(
      "Reads report.json, map.ply, .vdb files, and the meshes that the report names. The page is "
      "one file that needs no network: the numbers with their meaning, the surfaces before and "
      "after, sections through the volume, how the fit went, time and memory, the command and its "
      "settings. The page leaves out missing files and names them. Other commands write the same "
      "page with --html.");
  c.positional("FOLDER", &o->folder, "folder that a command of innermap wrote, with a report.json");
  c.option("--output", "FILE", &o->output, "the page")
      .shortName("-o")
      .defaults("report.html in the folder");
  c.example("innermap report out");
  c.example("innermap report out -o page.html");
  return c.running(o, run);
}

}  // namespace innermap::tool
