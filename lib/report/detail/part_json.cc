#include "report/detail/part_json.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "innermap/core/error.h"

namespace innermap {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kDeepest = 8;
constexpr const char* kInfinite = "infinite";

// JSON has no infinities and no NaN.
Json jsonOf(double value) {
  if (std::isinf(value)) return {{kInfinite, value > 0 ? 1 : -1}};
  return std::isnan(value) ? Json(nullptr) : Json(value);
}

Json jsonOf(const FigureValue& value) {
  if (const auto* d = std::get_if<double>(&value)) return jsonOf(*d);
  if (const auto* list = std::get_if<std::vector<double>>(&value)) {
    Json array = Json::array();
    for (const double d : *list) array.push_back(jsonOf(d));
    return array;
  }
  return std::visit([](const auto& v) { return Json(v); }, value);
}

Json jsonOf(const PartValues& values) {
  Json list = Json::array();
  for (const auto& [key, value] : values) list.push_back({key, jsonOf(value)});
  return list;
}

std::string dumped(const Json& json) {
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string hashText(const Json& json) { return fmt::format("{:016x}", hashOf(dumped(json))); }

Json framesOf(const std::vector<FrameFile>& frames) {
  Json list = Json::array();
  for (const FrameFile& frame : frames) list.push_back({frame.number, frame.path});
  return list;
}

// All that decides results.
Json decisive(const PartRun& run) {
  return {{"command", run.command},
          {"version", run.version},
          {"settings", jsonOf(run.settings)},
          {"inputs", run.inputs},
          {"frames", framesOf(run.frames)}};
}

// What is the same whoever makes it.
Json decisive(const Part& part, const std::string& run) {
  return {{"run", run},
          {"frame", part.frame},
          {"input", part.input},
          {"broken", part.broken},
          {"values", jsonOf(part.values)},
          {"warnings", part.warnings}};
}

// What the file must hold; thrown inside, told with the file's name.
struct Malformed {};

const Json& at(const Json& json, const char* key) {
  if (!json.is_object() || !json.contains(key)) throw Malformed{};
  return json[key];
}

std::string text(const Json& json) {
  if (!json.is_string()) throw Malformed{};
  return json.get<std::string>();
}

double number(const Json& json) {
  if (json.is_null()) return std::numeric_limits<double>::quiet_NaN();
  if (json.is_object()) {
    const double sign = number(at(json, kInfinite));
    return std::copysign(std::numeric_limits<double>::infinity(), sign);
  }
  if (!json.is_number()) throw Malformed{};
  return json.get<double>();
}

std::int64_t integer(const Json& json) {
  if (!json.is_number_integer()) throw Malformed{};
  return json.get<std::int64_t>();
}

const Json& list(const Json& json) {
  if (!json.is_array()) throw Malformed{};
  return json;
}

std::vector<std::string> texts(const Json& json) {
  std::vector<std::string> out;
  for (const Json& item : list(json)) out.push_back(text(item));
  return out;
}

const Json& pairOf(const Json& json) {
  if (!json.is_array() || json.size() != 2) throw Malformed{};
  return json;
}

FigureValue value(const Json& json) {
  if (json.is_boolean()) return json.get<bool>();
  if (json.is_string()) return json.get<std::string>();
  if (json.is_number_unsigned()) return json.get<std::uint64_t>();
  if (json.is_number_integer()) return json.get<std::int64_t>();
  if (!json.is_array()) return number(json);
  if (!json.empty() && json.front().is_string()) return texts(json);
  std::vector<double> numbers;
  for (const Json& item : json) numbers.push_back(number(item));
  return numbers;
}

PartValues values(const Json& json) {
  PartValues out;
  for (const Json& item : list(json)) out.emplace_back(text(pairOf(item)[0]), value(item[1]));
  return out;
}

template <class Body>
auto parsed(const std::string& path, const std::string& content, const Body& body) {
  const auto shallow = [](int depth, Json::parse_event_t, Json&) { return depth <= kDeepest; };
  const Json json = Json::parse(content, shallow, false);
  try {
    return body(json);
  } catch (const Malformed&) {
    throw DataError(path +
                    ": is cut off, or no part of a run; remove it, and make its share again");
  }
}

}  // namespace

std::string fingerprintOf(const PartRun& run) { return hashText(decisive(run)); }

std::string runName(const std::string& fingerprint) { return "run." + fingerprint + ".json"; }

std::string partName(const Part& part, const std::string& run) {
  return fmt::format("frame.{:04}.{}.json", part.frame, hashText(decisive(part, run)));
}

std::string runJson(const PartRun& run) {
  return dumped({{"decides", decisive(run)},
                 {"settings", jsonOf(run.reported)},
                 {"command_line", run.commandLine},
                 {"date", run.date},
                 {"figures", jsonOf(run.figures)},
                 {"values", jsonOf(run.values)},
                 {"notes", run.notes},
                 {"warnings", run.warnings}});
}

std::string partJson(const Part& part, const std::string& run) {
  Json stages = Json::array();
  for (const auto& [stage, seconds] : part.stageSeconds) stages.push_back({stage, seconds});
  return dumped({{"result", decisive(part, run)},
                 {"made",
                  {{"host", part.host},
                   {"code", part.code},
                   {"seconds", part.seconds},
                   {"setup_seconds", part.setup},
                   {"peak_memory_bytes", part.memory},
                   {"restarts", part.restarts},
                   {"stages", stages}}}});
}

PartRun parseRun(const std::string& path, const std::string& content) {
  return parsed(path, content, [](const Json& json) {
    const Json& decides = at(json, "decides");
    PartRun run;
    run.command = text(at(decides, "command"));
    run.version = text(at(decides, "version"));
    run.settings = values(at(decides, "settings"));
    run.inputs = text(at(decides, "inputs"));
    for (const Json& item : list(at(decides, "frames")))
      run.frames.push_back({integer(pairOf(item)[0]), text(item[1])});
    run.reported = values(at(json, "settings"));
    run.commandLine = texts(at(json, "command_line"));
    run.date = text(at(json, "date"));
    run.figures = values(at(json, "figures"));
    run.values = values(at(json, "values"));
    run.notes = texts(at(json, "notes"));
    run.warnings = texts(at(json, "warnings"));
    return run;
  });
}

Part parsePart(const std::string& path, const std::string& content, const std::string& run) {
  return parsed(path, content, [&](const Json& json) {
    const Json &result = at(json, "result"), &made = at(json, "made");
    if (text(at(result, "run")) != run)
      throw DataError(path + ": is a part of another run; remove it, or the others");
    Part part;
    part.frame = integer(at(result, "frame"));
    part.input = text(at(result, "input"));
    part.broken = text(at(result, "broken"));
    part.values = values(at(result, "values"));
    part.warnings = texts(at(result, "warnings"));
    part.host = text(at(made, "host"));
    part.code = text(at(made, "code"));
    part.seconds = number(at(made, "seconds"));
    part.setup = number(at(made, "setup_seconds"));
    part.memory = static_cast<std::uint64_t>(integer(at(made, "peak_memory_bytes")));
    part.restarts = static_cast<std::uint64_t>(integer(at(made, "restarts")));
    for (const Json& item : list(at(made, "stages")))
      part.stageSeconds.emplace_back(text(pairOf(item)[0]), number(item[1]));
    return part;
  });
}

std::string valueText(const FigureValue& value) {
  return jsonOf(value).dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace innermap
