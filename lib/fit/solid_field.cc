#include <fmt/format.h>

#include <algorithm>

#include "innermap/core/error.h"
#include "innermap/core/version.h"
#include "innermap/field/field_file.h"
#include "innermap/fit/fit_harmonic.h"

namespace innermap {
namespace {

constexpr const char* kChannels = "channels";

std::vector<std::string> partsOf(const std::string& text) {
  std::vector<std::string> out;
  std::size_t at = 0;
  while (at <= text.size()) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    out.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return out;
}

}  // namespace

Facts harmonicFacts(const HarmonicFit& fit, const HarmonicFitSettings& settings,
                    const std::string& source, const std::vector<std::string>& names) {
  if (names.size() != fit.field.channels())
    throw DataError(fmt::format("{} names for {} channels", names.size(), fit.field.channels()));
  for (const std::string& name : names)
    if (name.empty() || name.find_first_of(",\n\r") != std::string::npos)
      throw DataError(fmt::format("'{}' cannot be the name of a channel", name));
  Facts facts{{"version", versionText()},
              {"source", source},
              {kChannels, fmt::format("{}", fmt::join(names, ","))},
              {"span", textOfFact(fit.span)},
              {"seed", fmt::format("{}", settings.seed)}};
  const auto add = [&](const Facts& more) { facts.insert(facts.end(), more.begin(), more.end()); };
  add(factsOfTolerance(settings.tolerance, {}, fit.met));
  add(factsOf(fit.error));
  add({{"inside_error_bound", textOfFact(fit.bound)}, {"free_share", textOfFact(fit.freeShare)}});
  return facts;
}

void writeSolidField(const std::string& path, const SolidField& field) {
  FieldFile file;
  file.steps = {field.field};
  file.facts = field.facts;
  file.boundary = file.boundaryTarget = field.boundary.mesh.vertices;
  file.boundaryTriangles = field.boundary.mesh.triangles;
  writeField(path, file);
}

SolidField readSolidField(const std::string& path) {
  FieldFile file = readField(path);
  if (!tellOfField(file.facts) || file.steps.size() != 1)
    throw FileError(path, "is the file of a map, not of a field");
  if (file.boundaryTriangles.empty()) throw FileError(path, "holds no boundary");
  Mesh mesh;
  mesh.name = factText(file.facts, "source").value_or(path);
  mesh.vertices = std::move(file.boundary);
  mesh.triangles = std::move(file.boundaryTriangles);
  std::vector<std::string> names = partsOf(factText(file.facts, kChannels).value_or(""));
  HarmonicField field = std::move(file.steps.front());
  if (names.size() != field.channels())
    throw FileError(path,
                    fmt::format("names {} channels and has {}", names.size(), field.channels()));
  validate(mesh);
  return {std::move(field), makeSourceBoundary(std::move(mesh)), std::move(names),
          std::move(file.facts)};
}

bool tellOfField(const Facts& facts) {
  return std::any_of(facts.begin(), facts.end(),
                     [](const auto& fact) { return fact.first == kChannels; });
}

}  // namespace innermap
