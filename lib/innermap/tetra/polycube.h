// A solid as a few equal cubes: of its topology, and as near to it as so many cubes can be.
//
// Blocks are filled by the share of them that lies inside of the solid, for several shifts of the
// lattice and several thresholds, and made manifold; of those sets that have the solid's topology
// each is bettered block by block without changing that (simple blocks, after Bertrand and
// Malandain, "A new characterization of three-dimensional simple points", 1994), and the nearest to
// the solid is taken. Where there is none the set is grown from its fullest block.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "innermap/core/setting.h"
#include "innermap/core/stage_seconds.h"
#include "innermap/mesh/mesh.h"
#include "innermap/tetra/block_set.h"

namespace innermap {

struct PolycubeSettings {
  // 0: or a few more, where so many have not the mesh's topology.
  int blocks = 0;
};

std::vector<Setting> describe(PolycubeSettings& settings);

// A part of the solid that no block covers.
struct MissedPart {
  Vec3 centre;        // world units
  double volume = 0;  // share of the solid's
};

struct Polycube {
  BlockSet blocks;
  int across = 0;   // blocks along the longest side, as asked for or chosen
  int handles = 0;  // of the outer boundary
  int cavities = 0;
  double missed = 0;   // share of the solid's volume that is in no block
  double surplus = 0;  // volume of the blocks out of the solid, as a share of the solid's
  std::vector<MissedPart> missedParts;       // over 1e-3 of the volume each, largest first
  std::vector<std::string> notes, warnings;  // a line each
  StageSeconds seconds;                      // "solid", "blocks"
};

// The mesh must be closed (but for holes to be closed) and bound one body, which may have handles
// and cavities. Throws DataError
// for others, and when no set of so many blocks has the mesh's topology (then it names a number
// that does, where one up to 64 is found); SettingError, MemoryError, Cancelled. Deterministic.
Polycube makePolycube(const Mesh& mesh, const PolycubeSettings& settings = {});

constexpr int kMostAcross = 64;

// About how many blocks there will be in all, from the mesh's volume.
double expectedBlocks(const Mesh& mesh, int across);

// Bytes that it takes, at most, beside the mesh and its solid.
std::uint64_t polycubeMemory(const Mesh& mesh, const PolycubeSettings& settings = {});

}  // namespace innermap
