#include "report/study/study_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <ostream>

#include "core/file.h"
#include "core/markup.h"
#include "innermap/core/version.h"
#include "innermap/study/study.h"
#include "report/svg_chart.h"

namespace innermap {
namespace {

using Json = nlohmann::ordered_json;

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

// Whole numbers without a point.
Json number(double value) {
  if (!std::isfinite(value)) return nullptr;
  if (value == std::floor(value) && std::abs(value) < 1e15) return static_cast<std::int64_t>(value);
  return value;
}

Json json(const Study& study, const StudyRow& row) {
  Json out{{"placement", placementText(row)}};
  for (const StudyColumn& column : studyColumns())
    out[column.name] = number(valueOf(column, study, row));
  out["kept"] = row.kept;
  if (!row.failure.empty()) out["failure"] = row.failure;
  return out;
}

Json json(const StudySettings& settings) {
  return {{"sources", settings.sources},
          {"points_per_source", settings.collocation},
          {"distances", settings.distances},
          {"radius_ratios", settings.radiusRatios},
          {"grid", settings.grid == StudyGrid::none    ? "none"
                   : settings.grid == StudyGrid::pairs ? "pairs"
                                                       : "full"},
          {"interpolation", settings.interpolation == Interpolation::smooth ? "smooth" : "linear"},
          {"method", settings.method == Regularization::truncatedSvd ? "tsvd" : "tikhonov"},
          {"regularization", settings.regularization ? Json(*settings.regularization) : Json()},
          {"resolution", settings.resolution},
          {"lame_lambda", settings.lame.lambda},
          {"lame_mu", settings.lame.mu},
          {"seed", settings.seed}};
}

const char* kStyle = R"(
:root{color-scheme:light dark;--paper:#fff;--ink:#212429;--faint:#5d636b;--line:#d5d8dc;--card:#f5f6f8}
@media(prefers-color-scheme:dark){:root{--paper:#16181b;--ink:#e8eaed;--faint:#a3a9b1;--line:#3a3e44;--card:#202327}}
body{background:var(--paper);color:var(--ink);font:16px/1.5 sans-serif;margin:0 auto;max-width:1240px;padding:1.5em}
h1{margin-bottom:0}h2{margin-top:2em}p.faint,caption,td.faint{color:var(--faint)}
table{border-collapse:collapse;font-size:.85em}th,td{border-bottom:1px solid var(--line);padding:.3em .6em;text-align:left;vertical-align:top}
td.n{text-align:right;font-variant-numeric:tabular-nums;white-space:nowrap}tr.best{background:var(--card);font-weight:bold}
figure{margin:1.5em 0}figure>div{background:#fff;border:1px solid var(--line);overflow-x:auto}figure svg{display:block;margin:auto;max-width:100%;height:auto}
.wide{overflow-x:auto}code{background:var(--card);padding:.1em .3em}
@media print{body{max-width:none;padding:0}figure{break-inside:avoid}}
)";

std::string rowsOfPage(const Study& study, const StudyFindings& findings) {
  std::string out = "<table><thead><tr><th>placement</th>";
  for (const StudyColumn& column : studyColumns())
    if (column.title) out += fmt::format("<th>{}</th>", column.title);
  out += "<th></th></tr></thead><tbody>\n";
  for (const StudyRow& row : study.rows) {
    const bool best = findings.best && sameRun(row, *findings.best);
    out += fmt::format("<tr{}><td>{}</td>", best ? " class=\"best\"" : "", placementText(row));
    for (const StudyColumn& column : studyColumns()) {
      if (!column.title) continue;
      const double value = valueOf(column, study, row);
      out += fmt::format("<td class=\"n\">{}</td>",
                         std::isfinite(value) ? fmt::format("{:.4g}", value) : "");
    }
    out += fmt::format("<td class=\"faint\">{}</td></tr>\n",
                       best ? "smallest error" : markupText(row.failure));
  }
  return out + "</tbody></table>";
}

std::string statementsOfPage(const StudyFindings& findings) {
  std::string out =
      "<table><thead><tr><th>statement</th><th>here</th><th>figures</th></tr></thead>\n";
  for (const StudyStatement& s : findings.statements)
    out += fmt::format("<tr><td>{}</td><td><b>{}</b></td><td>{}</td></tr>\n", markupText(s.text),
                       verdictText(s.verdict), markupText(s.figures));
  return out + "</table>";
}

// As a shell takes it.
std::string inShell(const std::string& path) {
  const bool plain = std::all_of(path.begin(), path.end(), [](unsigned char c) {
    return std::isalnum(c) || c == '/' || c == '.' || c == '_' || c == '-' || c >= 0x80;
  });
  if (plain) return path;
  std::string out = "'";
  for (const char c : path) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string pageOf(const Study& study, const StudyFindings& findings, const StudySettings& settings,
                   const std::vector<StudyChart>& charts, const StudyNames& names) {
  const std::string title =
      markupText(fileNameOf(names.source) + " to " + fileNameOf(names.target));
  std::string out = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/>"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>"
      "<title>Study of {0}</title><style>{1}</style></head><body>\n<h1>Study of {0}</h1>\n"
      "<p class=\"faint\">{2} runs{3}; innermap {4}. Errors are fractions of the target's "
      "diagonal, "
      "distances of the source's.</p>\n",
      title, kStyle, study.rows.size(),
      study.left ? fmt::format(", {} left for another time", study.left) : "", versionText());
  out += "<h2>Best settings</h2>\n<ul>\n";
  for (const std::string& text : findings.advice) out += "<li>" + markupText(text) + "</li>\n";
  out += "</ul>\n";
  if (findings.best)
    out += fmt::format("<p><code>innermap map {}{} {} -o out {}</code></p>\n",
                       markupText(inShell(names.source)), names.laidOn ? " --correspond" : "",
                       markupText(inShell(names.target)), optionsOf(*findings.best, settings));
  for (const std::string& warning : study.warnings)
    out += "<p><b>Warning:</b> " + markupText(warning) + "</p>\n";
  out += "<h2>The paper's statements</h2>\n" + statementsOfPage(findings) + "<h2>Charts</h2>\n";
  for (const StudyChart& c : charts)
    out += fmt::format("<figure><div>{}</div><figcaption>{}</figcaption></figure>\n",
                       svgChart(c.chart), markupText(c.meaning));
  out += "<h2>All runs</h2>\n<div class=\"wide\">" + rowsOfPage(study, findings) + "</div>\n";
  return out + "</body></html>\n";
}

}  // namespace

std::string fileNameOf(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

void writeStudyTable(const std::string& path, const Study& study) {
  writeWholeFile(path, [&](std::ostream& file) {
    file << "placement";
    for (const StudyColumn& column : studyColumns()) file << "," << column.name;
    file << ",failure\n";
    for (const StudyRow& row : study.rows) {
      file << placementText(row);
      for (const StudyColumn& column : studyColumns()) {
        const double value = valueOf(column, study, row);
        file << "," << (std::isfinite(value) ? fmt::format("{:.9g}", value) : "");
      }
      file << "," << (row.failure.empty() ? "" : quoted(row.failure)) << "\n";
    }
  });
}

void writeStudyJson(const std::string& path, const Study& study, const StudyFindings& findings,
                    const StudySettings& settings, const StudyNames& names) {
  Json root{{"version", versionText()},
            {"source", names.source},
            {"target", names.target},
            {"vertices", study.vertices},
            {"settings", json(settings)},
            {"base",
             {{"sources", study.base.sources},
              {"points_per_source", study.base.collocation},
              {"o_distance", study.base.at},
              {"r_ratio", study.baseSphere.at}}},
            {"runs_left", study.left}};
  root["rows"] = Json::array();
  for (const StudyRow& row : study.rows) root["rows"].push_back(json(study, row));
  if (findings.best) {
    root["best"] = json(study, *findings.best);
    root["best"]["options"] = optionsOf(*findings.best, settings);
    root["cheapest"] = json(study, *findings.cheapest);
    root["cheapest"]["options"] = optionsOf(*findings.cheapest, settings);
  }
  root["advice"] = findings.advice;
  root["statements"] = Json::array();
  for (const StudyStatement& s : findings.statements)
    root["statements"].push_back(
        {{"text", s.text}, {"verdict", verdictText(s.verdict)}, {"figures", s.figures}});
  const std::string text = root.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  writeWholeFile(path, [&](std::ostream& file) { file << text; });
}

void writeStudyPage(const std::string& path, const Study& study, const StudyFindings& findings,
                    const StudySettings& settings, const std::vector<StudyChart>& charts,
                    const StudyNames& names) {
  writeWholeFile(
      path, [&](std::ostream& file) { file << pageOf(study, findings, settings, charts, names); });
}

std::string studyHeader() {
  return fmt::format("{:>8} {:>8} {:>16} {:>9} {:>9} {:>9} {:>9} {:>9} {:>8} {:>9} {:>8}\n",
                     "charges", "points", "place", "C-Error", "rms", "99%", "harmonic", "weights",
                     "folded %", "condition", "seconds");
}

std::string studyLine(const StudyRow& row) {
  const std::string place = fmt::format("{} {:.4g}", placementText(row), row.at);
  if (!row.failure.empty())
    return fmt::format("{:>8} {:>8} {:>16} {}\n", row.sources, row.points, place, row.failure);
  return fmt::format(
      "{:>8} {:>8} {:>16} {:>9.2e} {:>9.2e} {:>9.2e} {:>9.6g} {:>9.2e} {:>8.3g} {:>9.2e} "
      "{:>8.2f}{}\n",
      row.sources, row.points, place, row.cError, row.rms, row.p99, row.harmonicEnergy, row.weights,
      100 * row.folded, row.condition, row.seconds, row.kept ? " (kept)" : "");
}

}  // namespace innermap
