// The header of a PLY file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/text_scanner.h"

namespace innermap {

enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
enum class PlyFormat { ascii, littleEndian, bigEndian };

std::size_t plySize(PlyType type);  // bytes in a binary file

inline bool isFloat(PlyType type) { return type == PlyType::float32 || type == PlyType::float64; }

struct PlyProperty {
  std::string name;
  bool list = false;
  PlyType countType = PlyType::uint8;  // of a list
  PlyType type = PlyType::float32;     // of the value or of the list's items
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;
  std::size_t bodyOffset = 0;  // bytes
};

// Throws FileError with the line.
PlyHeader readPlyHeader(const FileBytes& file);

}  // namespace innermap
