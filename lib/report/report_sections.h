// All that a report of this program may hold: docs/report.schema.json and the page's words derive
// from it.
#pragma once

#include <initializer_list>
#include <vector>

#include "report/schema.h"

namespace innermap {

std::vector<ReportSection> reportSections();

// Of parts that a build may leave out, in the folders of their names.
std::vector<ReportSection> cellSections();
std::vector<ReportSection> studySections();

// Of several commands, whose figures of the same key have the same type.
Figures merged(std::initializer_list<Figures> parts);

}  // namespace innermap
