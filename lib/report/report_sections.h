// All that a report of this program may hold: docs/report.schema.json and the page's words derive
// from it.
#pragma once

#include <vector>

#include "report/schema.h"

namespace innermap {

std::vector<ReportSection> reportSections();

}  // namespace innermap
