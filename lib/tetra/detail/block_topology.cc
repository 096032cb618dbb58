#include "tetra/detail/block_topology.h"

#include <algorithm>
#include <array>

namespace innermap {
namespace {

// Whether the octants whose bits are set hang together by faces.
bool connectedOctants(int set) {
  if (set == 0) return false;
  int reached = set & -set;
  for (int before = 0; before != reached;) {
    before = reached;
    for (int o = 0; o < 8; ++o)
      if (reached >> o & 1)
        for (int a = 0; a < 3; ++a) reached |= set & 1 << (o ^ 1 << a);
  }
  return reached == set;
}

// By the set of filled octants: nothing there, or discs on both sides.
const std::array<bool, 256>& manifoldOctants() {
  static const std::array<bool, 256> table = [] {
    std::array<bool, 256> out{};
    for (int set = 0; set < 256; ++set)
      out[set] = set == 0 || set == 255 || (connectedOctants(set) && connectedOctants(255 ^ set));
    return out;
  }();
  return table;
}

int octantsAt(const BlockSet& blocks, const Block& corner) {
  int set = 0;
  for (int o = 0; o < 8; ++o)
    if (blocks.at(
            {corner[0] - 1 + (o & 1), corner[1] - 1 + (o >> 1 & 1), corner[2] - 1 + (o >> 2)}))
      set |= 1 << o;
  return set;
}

// Sets of a cube's faces (bit 2 * axis + side) that form a disc, as do the others.
bool isDisc(int faces) {
  int count = 0;
  bool opposite = true;  // of the faces, or of the others, just two that are opposite
  for (int f = 0; f < 6; ++f) count += faces >> f & 1;
  for (int a = 0; a < 3; ++a) {
    const int pair = faces >> (2 * a) & 3;
    if (pair != 0 && pair != 3) opposite = false;
  }
  return count > 0 && count < 6 && !opposite;
}

// Each lattice corner between filled and empty blocks, each such edge: visit(dimension, where,
// label of an empty block at it).
template <class Visit>
void visitBoundary(const BlockSet& blocks, const std::vector<int>& labels, const Visit& visit) {
  for (int z = 1; z < blocks.size[2]; ++z)
    for (int y = 1; y < blocks.size[1]; ++y)
      for (int x = 1; x < blocks.size[0]; ++x)
        // The corner, the three edges and the three faces that go up from it, or lie beside it.
        for (int span = 0; span < 7; ++span) {
          int filled = 0, all = 0, label = -1, dimension = 0;
          for (int a = 0; a < 3; ++a) dimension += span >> a & 1;
          for (int o = 0; o < 8; ++o) {
            if ((o & span) != span) continue;
            const Block b{x - 1 + (o & 1), y - 1 + (o >> 1 & 1), z - 1 + (o >> 2)};
            ++all;
            if (blocks.at(b))
              ++filled;
            else
              label = labels[blocks.index(b)];
          }
          if (filled > 0 && filled < all) visit(dimension, label);
        }
}

}  // namespace

bool manifoldAt(const BlockSet& blocks, const Block& corner) {
  return manifoldOctants()[octantsAt(blocks, corner)];
}

bool isManifold(const BlockSet& blocks) {
  for (int z = 1; z < blocks.size[2]; ++z)
    for (int y = 1; y < blocks.size[1]; ++y)
      for (int x = 1; x < blocks.size[0]; ++x)
        if (!manifoldAt(blocks, {x, y, z})) return false;
  return true;
}

bool isSimple(const BlockSet& blocks, const Block& block) {
  int faces = 0;
  for (int a = 0; a < 3; ++a)
    for (int side = 0; side < 2; ++side) {
      Block beside = block;
      beside[a] += side ? 1 : -1;
      if (blocks.at(beside)) faces |= 1 << (2 * a + side);
    }
  if (!isDisc(faces)) return false;
  // Around each of its corners, as they would be.
  for (int c = 0; c < 8; ++c) {
    const Block corner{block[0] + (c & 1), block[1] + (c >> 1 & 1), block[2] + (c >> 2)};
    if (!manifoldOctants()[octantsAt(blocks, corner) ^ 1 << (7 - c)]) return false;
  }
  return true;
}

int labelBlocks(const BlockSet& blocks, bool filled, std::vector<int>& labels) {
  labels.assign(blocks.filled.size(), -1);
  int count = 0;
  std::vector<std::size_t> stack;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] >= 0 || (blocks.filled[i] != 0) != filled) continue;
    stack.assign(1, i);
    labels[i] = count;
    while (!stack.empty()) {
      const Block b = blocks.block(stack.back());
      stack.pop_back();
      for (int a = 0; a < 3; ++a)
        for (int step = -1; step <= 1; step += 2) {
          Block beside = b;
          beside[a] += step;
          if (beside[a] < 0 || beside[a] >= blocks.size[a] || blocks.at(beside) != filled) continue;
          int& label = labels[blocks.index(beside)];
          if (label >= 0) continue;
          label = count;
          stack.push_back(blocks.index(beside));
        }
    }
    ++count;
  }
  return count;
}

BlockTopology topologyOf(const BlockSet& blocks) {
  BlockTopology out;
  std::vector<int> labels;
  out.bodies = labelBlocks(blocks, true, labels);
  if (out.bodies != 1) return out;
  const int outsides = labelBlocks(blocks, false, labels);  // 0 is the outermost layer's
  std::vector<int> euler(static_cast<std::size_t>(outsides), 0);
  visitBoundary(blocks, labels, [&](int dimension, int label) {
    euler[static_cast<std::size_t>(label)] += dimension == 1 ? -1 : 1;
  });
  for (const int e : euler) out.handles.push_back((2 - e) / 2);
  std::sort(out.handles.begin() + 1, out.handles.end());
  return out;
}

}  // namespace innermap
