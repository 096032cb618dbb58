#include "report/schema.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "innermap/core/error.h"

namespace innermap {
namespace {

using Json = nlohmann::ordered_json;

Json reference(const char* to) { return {{"$ref", std::string("#/$defs/") + to}}; }

struct TypeOf {
  FigureUnit unit;
  Json operator()(bool) const { return {{"type", "boolean"}}; }
  Json operator()(std::uint64_t) const { return reference("count"); }
  Json operator()(std::int64_t) const { return {{"type", "integer"}}; }
  Json operator()(double) const {
    return reference(unit == FigureUnit::share ? "share" : "number");
  }
  Json operator()(const std::string&) const { return {{"type", "string"}}; }
  Json operator()(const std::vector<double>&) const { return reference("numbers"); }
  Json operator()(const std::vector<std::string>&) const { return reference("texts"); }
};

std::string described(const Figure& f) {
  std::string text = f.name;
  if (!f.meaning.empty()) text += ": " + f.meaning;
  const std::string unit = textOf(f.unit);
  return unit.empty() ? text : text + " (" + unit + ")";
}

Json emptyObject() {
  return {{"type", "object"}, {"properties", Json::object()}, {"additionalProperties", false}};
}

// "*_before" -> "^.+_before$"
std::string patternOf(const std::string& key) {
  std::string out = "^";
  for (const char c : key) out += c == '*' ? std::string(".+") : std::string(1, c);
  return out + "$";
}

void add(const Figure& figure, Json& section) {
  const std::string& key = figure.key;
  Json* place = &section;
  std::size_t from = 0;
  for (std::size_t dot; (dot = key.find('.', from)) != std::string::npos; from = dot + 1) {
    Json& part = (*place)["properties"][key.substr(from, dot - from)];
    if (part.is_null()) part = emptyObject();
    place = &part;
  }
  const std::string last = key.substr(from);
  const bool named = last.find('*') != std::string::npos;
  Json& slot =
      named ? (*place)["patternProperties"][patternOf(last)] : (*place)["properties"][last];
  if (!slot.is_null()) throw Error("two figures are called " + key);
  slot = std::visit(TypeOf{figure.unit}, figure.value);
  slot["description"] = described(figure);
}

Json objectOf(const ReportSection& section) {
  Json out = emptyObject();
  if (!section.meaning.empty()) out["description"] = section.meaning;
  for (const Figure& f : section.figures) add(f, out);
  if (!section.always.empty()) out["required"] = section.always;
  return out;
}

// What every report has beside its figures.
constexpr const char* kFrame = R"({
  "$schema": "https://json-schema.org/draft/2020-12/schema",
  "title": "innermap's report.json",
  "description": "What a run of innermap did and how good the result is. Sections that a command does not compute are left out; null stands for numbers that are not finite or not known.",
  "type": "object",
  "properties": {
    "command": {"type": "string", "description": "the subcommand that ran"},
    "version": {"type": "string", "description": "of innermap"},
    "command_line": {"type": "array", "items": {"type": "string"}, "minItems": 2, "description": "as it was given"},
    "date": {"type": "string", "pattern": "^[0-9]{4}-[0-9]{2}-[0-9]{2}T[0-9]{2}:[0-9]{2}:[0-9]{2}Z$", "description": "of the start, UTC, ISO 8601"},
    "host": {
      "description": "the machine",
      "type": "object",
      "properties": {
        "cores": {"$ref": "#/$defs/count", "description": "that the machine has"},
        "threads": {"$ref": "#/$defs/count", "description": "that might be used"}
      },
      "required": ["cores", "threads"],
      "additionalProperties": false
    },
    "settings": {
      "description": "every argument and option of the command with the value that it had, by its name without the dashes in front, other dashes as underscores; null: left to the command, where it has no one value",
      "type": "object",
      "additionalProperties": {"type": ["boolean", "number", "string", "array", "null"]}
    },
    "verdict": {
      "description": "what the result is judged by",
      "type": "object",
      "properties": {
        "met": {"type": "boolean", "description": "all findings are"},
        "findings": {
          "type": "array",
          "items": {
            "type": "object",
            "properties": {
              "name": {"type": "string"},
              "met": {"type": "boolean"},
              "value": {"$ref": "#/$defs/number"},
              "threshold": {"$ref": "#/$defs/number", "description": "met: the value is at most this"},
              "statement": {"type": "string", "description": "in words"},
              "advice": {"type": "string", "description": "what to try, when it is not met"}
            },
            "required": ["name", "met", "value", "threshold", "statement"],
            "additionalProperties": false
          }
        }
      },
      "required": ["met", "findings"],
      "additionalProperties": false
    },
    "outputs": {
      "description": "files that were written, but for the report itself",
      "type": "array",
      "items": {
        "type": "object",
        "properties": {"path": {"type": "string"}, "bytes": {"$ref": "#/$defs/count"}},
        "required": ["path", "bytes"],
        "additionalProperties": false
      }
    },
    "notes": {"$ref": "#/$defs/texts", "description": "what was repaired or chosen"},
    "warnings": {"$ref": "#/$defs/texts", "description": "what makes the result doubtful"},
    "seconds": {
      "description": "wall time of each stage",
      "type": "object",
      "additionalProperties": {"$ref": "#/$defs/number"}
    },
    "peak_memory_bytes": {"$ref": "#/$defs/count", "description": "the most that the process held"}
  },
  "required": ["command", "version", "command_line", "date", "host", "settings", "outputs", "seconds", "peak_memory_bytes"],
  "additionalProperties": false,
  "$defs": {
    "number": {"type": ["number", "null"]},
    "numbers": {"type": "array", "items": {"$ref": "#/$defs/number"}},
    "texts": {"type": "array", "items": {"type": "string"}},
    "count": {"type": "integer", "minimum": 0},
    "share": {"type": ["number", "null"], "minimum": 0, "maximum": 1}
  }
})";

// Indented, but a leaf on one line.
std::string laidOut(const Json& value, const std::string& indent) {
  constexpr std::size_t kMostInLine = 400;
  const bool nested =
      value.is_object() && std::any_of(value.begin(), value.end(), [](const Json& member) {
        return member.is_object() && !member.empty();
      });
  if (const std::string line = value.dump(); !nested && line.size() < kMostInLine) return line;
  if (!value.is_object()) return value.dump();
  const std::string inner = indent + "  ";
  std::string out;
  for (const auto& [key, member] : value.items())
    out += (out.empty() ? "{\n" : ",\n") + inner + Json(key).dump() + ": " + laidOut(member, inner);
  return out + "\n" + indent + "}";
}

const char* wordOf(FigureUnit unit) {
  switch (unit) {
    case FigureUnit::share:
      return "share";
    case FigureUnit::diagonals:
      return "error";
    case FigureUnit::seconds:
      return "seconds";
    case FigureUnit::bytes:
      return "bytes";
    case FigureUnit::none:
    case FigureUnit::length:
    case FigureUnit::volume:
    case FigureUnit::degrees:
      break;
  }
  return "";
}

// With its unit, where the number is not written with it.
std::string meaningFor(const Figure& f) {
  const bool told = f.unit == FigureUnit::share || f.unit == FigureUnit::seconds ||
                    f.unit == FigureUnit::bytes || f.unit == FigureUnit::none;
  if (told) return f.meaning;
  return f.meaning.empty() ? textOf(f.unit) : f.meaning + ", " + textOf(f.unit);
}

}  // namespace

std::string reportSchema(const std::vector<ReportSection>& sections) {
  Json root = Json::parse(kFrame);
  for (const ReportSection& section : sections)
    if (section.key.empty())
      for (const Figure& f : section.figures) add(f, root);
    else
      root["properties"][section.key] = objectOf(section);
  return laidOut(root, "") + "\n";
}

std::string reportWords(const std::vector<ReportSection>& sections) {
  Json titles = Json::array(), words = Json::object();
  for (const ReportSection& section : sections) {
    if (!section.key.empty()) titles.push_back({section.key, section.title, section.meaning});
    const std::string before = section.key.empty() ? "" : section.key + ".";
    for (const Figure& f : section.figures)
      words[before + f.key] = {f.name, meaningFor(f), wordOf(f.unit)};
  }
  return Json{{"sections", titles}, {"figures", words}}.dump();
}

}  // namespace innermap
