// What a report may hold, in words for programs (JSON Schema) and for people (the page).
#pragma once

#include <string>
#include <vector>

#include "core/figure.h"

namespace innermap {

// A part of the report.
struct ReportSection {
  std::string key;      // "boundary_error"; empty: figures that stand beside the sections
  std::string title;    // for people: "Boundary error"
  std::string meaning;  // a sentence or none
  // Everything that it may hold, with any value. A '*' in a key stands for a name from the input:
  // "*_before".
  Figures figures;
  // Of these keys, which it always holds; the rest may be left out.
  std::vector<std::string> always;
};

// docs/report.schema.json: a JSON Schema, draft 2020-12, indented. Throws Error where two figures
// of a section have the same key: a fault of the program.
std::string reportSchema(const std::vector<ReportSection>& sections);

// For the page, as JSON: {"sections": [[key, title, meaning], ...], "figures": {key: [name,
// meaning, unit], ...}}, keys as in reportSchema.
std::string reportWords(const std::vector<ReportSection>& sections);

}  // namespace innermap
