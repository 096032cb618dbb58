// Columns of figures as a file for spreadsheets.
#pragma once

#include <string>

#include "core/figure.h"

namespace innermap {

// CSV after RFC 4180: a line of keys, then a line a row. columns: as columns() gives them, lists of
// one length. Numbers to nine digits, whole ones without a point; what is not finite is empty.
// Throws FileError; the file appears whole or not at all. Throws Error for what are no such lists.
void writeTable(const std::string& path, const Figures& columns);

}  // namespace innermap
