// The arrays of a VTK XML file: ASCII, base64 or raw; plain or compressed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/file_bytes.h"
#include "io/cells/detail/cell_formats.h"

namespace innermap {

// What the file's first tag and its appended data say of all arrays.
struct VtuEncoding {
  bool bigEndian = false;
  bool longHeader = false;   // UInt64, else UInt32
  bool compressed = false;   // zlib
  std::size_t appended = 0;  // byte after its '_'; 0: none
  std::size_t appendedEnd = 0;
  bool appendedRaw = false;  // else base64
};

struct VtuArray {
  std::string name, type, format, kind;
  int components = 1;
  std::size_t begin = 0, end = 0;  // bytes of the text between its tags
  std::uint64_t offset = 0;        // in the appended data
  std::string label() const { return "array '" + name.substr(0, 40) + "'"; }
};

bool isWholeType(const VtuArray& array);
// Whether its numbers can be read: Int8 to UInt64, Float32, Float64.
bool isNumberType(const VtuArray& array);

// The array's numbers, which must be `count`. Throws FileError; MemoryError by the collector.
std::vector<double> vtuReals(const FileBytes& file, const VtuEncoding& encoding,
                             const VtuArray& array, std::uint64_t count, CellCollector& collector);
std::vector<std::int64_t> vtuIntegers(const FileBytes& file, const VtuEncoding& encoding,
                                      const VtuArray& array, std::uint64_t count,
                                      CellCollector& collector);
// However many there are.
std::vector<std::int64_t> vtuIntegers(const FileBytes& file, const VtuEncoding& encoding,
                                      const VtuArray& array, CellCollector& collector);

}  // namespace innermap
