#include "report/page/page.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string_view>

#include "core/file.h"
#include "report/page/assets.h"
#include "report/page/encode.h"
#include "report/report_sections.h"

namespace innermap {
namespace {

using Json = nlohmann::ordered_json;

Json json(const Vec3& v) { return {v.x, v.y, v.z}; }

Json json(const PagePlace& place) {
  Box3 box;
  for (const Vec3& p : place.points)
    if (isFinite(p)) box.add(p);
  if (box.empty()) box.add(Vec3{});
  std::vector<std::uint16_t> codes;
  codes.reserve(3 * place.points.size());
  for (int a = 0; a < 3; ++a) {
    const double extent = box.upper[a] - box.lower[a];
    for (const Vec3& p : place.points) {
      const double share = extent > 0 ? (p[a] - box.lower[a]) / extent : 0.5;
      codes.push_back(static_cast<std::uint16_t>(
          std::isfinite(share) ? std::lround(65535 * std::clamp(share, 0.0, 1.0)) : 0));
    }
  }
  return {{"label", place.label},
          {"lower", json(box.lower)},
          {"upper", json(box.upper)},
          {"points", encoded(codes)}};
}

Json json(const Quantised& q) {
  return {{"least", q.least},
          {"greatest", q.greatest},
          {"logarithmic", q.logarithmic},
          {"codes", q.codes}};
}

Json json(const PageShape& shape) {
  std::vector<std::uint32_t> corners;
  for (const Triangle& t : shape.triangles)
    for (const int v : t) corners.push_back(static_cast<std::uint32_t>(v));
  const std::size_t vertices = shape.places.empty() ? 0 : shape.places.front().points.size();
  Json out = {{"vertices", vertices},
              {"given_vertices", std::max(vertices, shape.givenVertices)},
              {"triangles", shape.triangles.size()},
              {"corners", encoded(corners)},
              {"places", Json::array()},
              {"scalars", Json::array()}};
  for (const PagePlace& place : shape.places) out["places"].push_back(json(place));
  for (const PageScalar& scalar : shape.scalars) {
    Json one = {{"name", scalar.name}, {"values", Json::array()}};
    for (const auto& values : scalar.values) one["values"].push_back(json(quantised(values)));
    out["scalars"].push_back(std::move(one));
  }
  return out;
}

Json json(const PageGrid& grid) {
  Json out = {{"name", grid.name},
              {"reduction", grid.reduction},
              {"blocks", grid.blocks},
              {"stride", grid.stride},
              {"origin", json(grid.origin)},
              {"axes", {json(grid.axes[0]), json(grid.axes[1]), json(grid.axes[2])}},
              {"grid_least", grid.least},
              {"grid_greatest", grid.greatest}};
  if (grid.frame) out["frame"] = *grid.frame;
  if (grid.across) out["across"] = *grid.across;
  for (const PageGrid& plane : grid.planes) out["planes"].push_back(json(plane));
  out.update(json(grid.values));
  return out;
}

// No text of it can end the element that it stands in.
std::string inScript(const std::string& text) {
  std::string out;
  out.reserve(text.size());
  for (const char c : text) out += c == '<' ? std::string("\\u003c") : std::string(1, c);
  return out;
}

std::string dataText(const Page& page, const std::string& reportJson) {
  Json data = Json::object();
  data["shapes"] = Json::array();
  for (const PageShape& shape : page.shapes) data["shapes"].push_back(json(shape));
  data["grids"] = Json::array();
  for (const PageGrid& grid : page.grids) data["grids"].push_back(json(grid));
  data["missing"] = page.missing;
  std::string text = data.dump(-1, ' ', false, Json::error_handler_t::replace);
  text.back() = ',';
  return inScript(text + "\"report\":" + (reportJson.empty() ? "{}" : reportJson) + "}");
}

}  // namespace

std::string pageHtml(const Page& page, const std::string& reportJson) {
  std::string out;
  std::string_view rest = pageAsset("page.html");
  // {{NAME}} stands for the asset of that name, {{data}} for the data, {{words}} for what they
  // mean.
  for (std::size_t open; (open = rest.find("{{")) != std::string_view::npos;) {
    out += rest.substr(0, open);
    const std::size_t close = rest.find("}}", open);
    const std::string name(rest.substr(open + 2, close - open - 2));
    if (name == "data")
      out += dataText(page, reportJson);
    else if (name == "words")
      out += inScript(reportWords(reportSections()));
    else
      out += pageAsset(name);
    rest.remove_prefix(close + 2);
  }
  out += rest;
  return out;
}

void writePage(const std::string& path, const Page& page, const std::string& reportJson) {
  const std::string text = pageHtml(page, reportJson);
  writeWholeFile(path, [&](std::ostream& file) { file << text; });
}

}  // namespace innermap
