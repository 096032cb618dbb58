#include "report/report.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <ostream>

#include "core/file.h"

namespace innermap {
namespace {

using Json = nlohmann::ordered_json;

// JSON has no infinities and no NaN.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

template <class Value>  // ReportValue or FigureValue
Json jsonOf(const Value& value) {
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
  for (const auto& [name, value] : run.settings) settings[name] = jsonOf(value);
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

void addFigure(const Figure& figure, Json& root) {
  const std::string& key = figure.key;
  Json* place = &root;
  std::size_t from = 0;
  for (std::size_t dot; (dot = key.find('.', from)) != std::string::npos; from = dot + 1) {
    place = &(*place)[key.substr(from, dot - from)];
    if (!place->is_object()) *place = Json::object();
  }
  (*place)[key.substr(from)] = jsonOf(figure.value);
}

}  // namespace

void Report::add(const std::string& section, const Figures& more) {
  for (Figure f : more) {
    if (!section.empty()) f.key = section + "." + f.key;
    figures.push_back(std::move(f));
  }
}

std::string reportJson(const Report& report) {
  Json root = Json::object();
  if (!report.command.empty()) root["command"] = report.command;
  if (report.run) addRun(*report.run, root);
  if (!report.verdict.empty()) root["verdict"] = json(report.verdict);
  for (const Figure& figure : report.figures)
    if (figure.known) addFigure(figure, root);
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
