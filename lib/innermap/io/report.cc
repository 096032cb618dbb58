#include "innermap/io/report.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <ostream>

#include "innermap/core/file.h"

namespace innermap {
namespace {

using Json = nlohmann::ordered_json;

// JSON has no infinities and no NaN.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json json(const ReportMesh& m) {
  return {{"path", m.path},
          {"vertices", m.vertices},
          {"triangles", m.triangles},
          {"boundary_loops", m.boundaryLoops},
          {"caps", m.caps},
          {"genus", m.genus},
          {"volume", number(m.volume)},
          {"diagonal", number(m.diagonal)}};
}

Json json(const ReportSolve& s) {
  return {{"method", s.method},
          {"sources", s.sources},
          {"collocation", s.collocation},
          {"rank", s.rank},
          {"regularization", number(s.regularization)},
          {"iterations", s.iterations}};
}

Json json(const ReportBoundaryError& e) {
  return {{"rms", number(e.rms)},
          {"p99", number(e.p99)},
          {"max", number(e.max)},
          {"samples", e.samples},
          {"c_error", number(e.cError)}};
}

Json json(const ReportEnergy& e) {
  return {{"harmonic", number(e.harmonic)}, {"deformation", number(e.deformation)}};
}

Json json(const ReportJacobian& j) {
  return {{"min", number(j.min)},
          {"max", number(j.max)},
          {"folded_fraction", number(j.foldedFraction)}};
}

Json json(const ReportGrid& g) {
  return {{"voxel_size", number(g.voxelSize)},
          {"active_voxels", g.activeVoxels},
          {"interior_voxels", g.interiorVoxels}};
}

Json json(const ReportValue& value) {
  if (const double* d = std::get_if<double>(&value)) return number(*d);
  if (const auto* list = std::get_if<std::vector<double>>(&value)) {
    Json array = Json::array();
    for (double d : *list) array.push_back(number(d));
    return array;
  }
  return std::visit([](const auto& v) { return Json(v); }, value);
}

// Beside one another at the top, as what is looked for first.
void addRun(const ReportRun& run, Json& root) {
  root["version"] = run.version;
  root["command_line"] = run.commandLine;
  root["date"] = run.date;
  root["host"] = {{"cores", run.cores}, {"threads", run.threads}};
  Json settings = Json::object();
  for (const auto& [name, value] : run.settings) settings[name] = json(value);
  root["settings"] = settings;
}

Json json(const std::vector<ReportFinding>& verdict) {
  bool met = true;
  Json findings = Json::array();
  for (const ReportFinding& f : verdict) {
    met = met && f.met;
    Json finding{{"name", f.name},
                 {"met", f.met},
                 {"value", number(f.value)},
                 {"threshold", number(f.threshold)},
                 {"statement", f.statement}};
    if (!f.advice.empty()) finding["advice"] = f.advice;
    findings.push_back(finding);
  }
  return {{"met", met}, {"findings", findings}};
}

Json json(const std::vector<ReportOutput>& outputs) {
  Json list = Json::array();
  for (const ReportOutput& o : outputs) list.push_back({{"path", o.path}, {"bytes", o.bytes}});
  return list;
}

void setExtra(Json& root, const std::string& key, const ReportValue& value) {
  Json* place = &root;
  std::size_t from = 0;
  for (std::size_t dot; (dot = key.find('.', from)) != std::string::npos; from = dot + 1) {
    place = &(*place)[key.substr(from, dot - from)];
    if (!place->is_object()) *place = Json::object();
  }
  (*place)[key.substr(from)] = json(value);
}

}  // namespace

void Report::set(std::string key, ReportValue value) {
  extra.emplace_back(std::move(key), std::move(value));
}

std::string reportJson(const Report& report) {
  Json root = Json::object();
  if (!report.command.empty()) root["command"] = report.command;
  if (report.run) addRun(*report.run, root);
  if (!report.verdict.empty()) root["verdict"] = json(report.verdict);
  if (report.source) root["source"] = json(*report.source);
  if (report.target) root["target"] = json(*report.target);
  if (report.solve) root["solve"] = json(*report.solve);
  if (report.boundaryError) root["boundary_error"] = json(*report.boundaryError);
  if (report.energy) root["energy"] = json(*report.energy);
  if (report.jacobian) root["jacobian"] = json(*report.jacobian);
  if (report.grid) root["grid"] = json(*report.grid);
  for (const auto& [key, value] : report.extra) setExtra(root, key, value);
  root["outputs"] = json(report.outputs);
  if (!report.notes.empty()) root["notes"] = report.notes;
  if (!report.warnings.empty()) root["warnings"] = report.warnings;
  Json seconds = Json::object();
  for (const auto& [stage, s] : report.seconds) seconds[stage] = number(s);
  root["seconds"] = seconds;
  root["peak_memory_bytes"] = report.peakMemory;
  return root.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void writeReport(const std::string& path, const Report& report) {
  const std::string text = reportJson(report);
  writeWholeFile(path, [&](std::ostream& file) { file << text; });
}

}  // namespace innermap
