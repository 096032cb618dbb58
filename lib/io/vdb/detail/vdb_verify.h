// Walks through the structure of a .vdb file and checks every size in it, because OpenVDB trusts
// them: it copies a block of the length that the file gives into a buffer of the length it expects,
// and allocates what counts in the file demand.
//
// Covers file versions 222 (OpenVDB 3, 2013) to 224 (OpenVDB 10) and trees of the standard
// configuration (5, 4, 3). The walk touches masks and block headers only, not the voxels.
#pragma once

#include <cstdint>
#include <istream>
#include <string>
#include <vector>

namespace innermap {

struct VerifiedGrid {
  std::uint64_t begin = 0, end = 0;  // in the file; `begin` is after the descriptor
  bool readable = true;              // a value type that readVdb reads
  std::uint64_t leaves = 0;
  std::uint64_t memory = 0;  // that the grid takes when read, bytes
};

// One entry for each grid in the file's order. `stream` throws at every access beyond the end.
// Throws FileError.
std::vector<VerifiedGrid> verifyVdb(const std::string& path, std::istream& stream,
                                    std::uint64_t size);

}  // namespace innermap
