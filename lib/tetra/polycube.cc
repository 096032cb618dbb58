#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "innermap/core/error.h"
#include "innermap/levelset/solid.h"
#include "innermap/surface/correspond.h"
#include "innermap/tetra/hexahedralize.h"
#include "tetra/detail/block_search.h"

namespace innermap {
namespace {

constexpr int kLeast = 2, kMost = kMostAcross;
constexpr double kBlocks = 900;         // in all, when their number across is chosen
constexpr int kChoices = 8;             // numbers across that are tried then, one after the other
constexpr double kWorthTelling = 1e-4;  // of the solid's volume
// Measured: of a search, of all shifts at once; the level set, 128 across or little more; the
// solid.
constexpr std::uint64_t kBytesABlock = 400, kLevelSet = 16'000'000, kBytesATriangle = 850;

// Handles of the outer boundary, then of those of cavities, ascending.
std::vector<int> handlesOf(const Mesh& mesh) {
  ClosedSurfaceSettings settings;
  settings.closeHoles = true;
  const SurfaceShells shells = closedSurfaces(mesh, settings);
  std::size_t outer = 0, bodies = 0;
  for (std::size_t s = 0; s < shells.shells.size(); ++s)
    if (shells.parent[s] < 0) {
      outer = s;
      ++bodies;
    }
  std::vector<int> handles{shells.shells[outer].genus};
  for (std::size_t s = 0; s < shells.shells.size(); ++s) {
    if (s == outer) continue;
    bodies += shells.parent[s] >= 0 && static_cast<std::size_t>(shells.parent[s]) != outer;
    handles.push_back(shells.shells[s].genus);
  }
  if (bodies > 1)
    throw DataError(fmt::format(
        "{} has {} bodies, apart from one another or overlapping, and a polycube is made of one: "
        "give each a file of its own, or take the outer surface of them all",
        mesh.name, bodies));
  std::sort(handles.begin() + 1, handles.end());
  return handles;
}

std::string topologyText(const std::vector<int>& handles) {
  const std::size_t cavities = handles.size() - 1;
  return fmt::format("{} handle{} and {} cavit{}", handles[0], handles[0] == 1 ? "" : "s", cavities,
                     cavities == 1 ? "y" : "ies");
}

// Parts farther than half a block from all blocks.
std::vector<MissedPart> missedParts(const BlockShares& shares, const BlockSet& blocks, int shift,
                                    double volume) {
  const auto& n = shares.halves();
  const auto index = [&](const std::array<int, 3>& h) {
    return (static_cast<std::size_t>(h[2]) * n[1] + h[1]) * n[0] + h[0];
  };
  const auto filled = [&](const std::array<int, 3>& h) {
    Block b;
    for (int a = 0; a < 3; ++a) {
      const int from = h[a] - (shift >> a & 1);
      if (from < 0 || from / 2 >= blocks.size[a]) return false;
      b[a] = from / 2;
    }
    return blocks.at(b);
  };
  const auto visitAround = [&](const std::array<int, 3>& h, const auto& visit) {
    for (int o = 0; o < 27; ++o) {
      const std::array<int, 3> g{h[0] + o % 3 - 1, h[1] + o / 3 % 3 - 1, h[2] + o / 9 - 1};
      bool in = true;
      for (int a = 0; a < 3; ++a) in &= g[a] >= 0 && g[a] < n[a];
      if (in) visit(g);
    }
  };
  std::vector<char> missed(static_cast<std::size_t>(n[0]) * n[1] * n[2], 0);
  const auto visitAll = [&](const auto& visit) {
    for (int z = 0; z < n[2]; ++z)
      for (int y = 0; y < n[1]; ++y)
        for (int x = 0; x < n[0]; ++x) visit(std::array<int, 3>{x, y, z});
  };
  visitAll([&](const std::array<int, 3>& h) {
    if (!(shares.half(h) > 0)) return;
    bool near = false;
    visitAround(h, [&](const std::array<int, 3>& g) { near |= filled(g); });
    missed[index(h)] = !near;
  });
  const double half = std::pow(0.5 * blocks.edge, 3);
  std::vector<MissedPart> parts;
  visitAll([&](const std::array<int, 3>& start) {
    if (!missed[index(start)]) return;
    MissedPart part;
    std::vector<std::array<int, 3>> stack{start};
    missed[index(start)] = 0;
    while (!stack.empty()) {
      const std::array<int, 3> h = stack.back();
      stack.pop_back();
      const double v = shares.half(h) * half;
      part.volume += v;
      part.centre += v * shares.centreOfHalf(h);
      visitAround(h, [&](const std::array<int, 3>& g) {
        if (!missed[index(g)]) return;
        missed[index(g)] = 0;
        stack.push_back(g);
      });
    }
    part.centre = part.centre / part.volume;
    part.volume /= volume;
    if (part.volume > kWorthTelling) parts.push_back(part);
  });
  std::stable_sort(parts.begin(), parts.end(),
                   [](const MissedPart& a, const MissedPart& b) { return a.volume > b.volume; });
  return parts;
}

struct Search {
  const Solid& solid;
  const std::vector<int>& handles;
  const PolycubeSettings& settings;

  std::optional<Polycube> at(int across) const {
    const BlockShares shares(solid, across);
    std::optional<FoundBlocks> found = findBlocks(shares, handles);
    if (!found) return {};
    Polycube out;
    out.across = across;
    out.handles = handles[0];
    out.cavities = static_cast<int>(handles.size()) - 1;
    double volume = 0;
    for (std::size_t i = 0; i < found->shares.size(); ++i) {
      volume += found->shares[i];
      if (found->blocks.filled[i])
        out.surplus += 1 - found->shares[i];
      else
        out.missed += found->shares[i];
    }
    out.missed /= volume;
    out.surplus /= volume;
    out.missedParts =
        missedParts(shares, found->blocks, found->shift, volume * std::pow(found->blocks.edge, 3));
    if (found->grown)
      out.notes.push_back(
          fmt::format("no threshold gives {} across blocks of the mesh's topology: they are grown "
                      "from one block and may miss thin parts",
                      across));
    out.blocks = std::move(found->blocks);
    return out;
  }

  // About as many blocks as are wanted in all.
  int first() const {
    const Vec3 extent = solid.box().extent();
    const double longest = std::max({extent.x, extent.y, extent.z});
    const double across = std::cbrt(kBlocks * longest * longest * longest / solid.volume());
    return std::clamp(static_cast<int>(std::lround(std::min(across, 1.0 * kMost))), kLeast, kMost);
  }

  std::optional<Polycube> chosen() const {
    for (int across = first(), tried = 0; across <= kMost && tried < kChoices; ++across, ++tried)
      if (std::optional<Polycube> found = at(across)) return found;
    return {};
  }

  // What to do where so many blocks will not do.
  std::string advice(int across) const {
    while (++across <= kMost)
      if (at(across)) return fmt::format("{} do", across);
    return fmt::format("nor of more, up to {}: parts of it are too thin or too close", kMost);
  }
};

}  // namespace

Polycube makePolycube(const Mesh& mesh, const PolycubeSettings& settings) {
  requireDescribed(settings);
  StageSeconds seconds;
  const std::vector<int> handles = handlesOf(mesh);
  const Solid solid = timed(seconds, "solid", [&] { return Solid(mesh); });
  const Search search{solid, handles, settings};
  std::optional<Polycube> out = timed(seconds, "blocks", [&] {
    return settings.blocks ? search.at(settings.blocks) : search.chosen();
  });
  if (!out) {
    const int tried = settings.blocks ? settings.blocks : search.first();
    throw DataError(fmt::format("{}: no set of {} blocks across has its topology ({}); {}",
                                mesh.name, tried, topologyText(handles), search.advice(tried)));
  }
  out->seconds = std::move(seconds);
  return *std::move(out);
}

double expectedBlocks(const Mesh& mesh, int across) {
  if (across == 0) return kBlocks;
  const Vec3 extent = boundingBox(mesh).extent();
  const double longest = std::max({extent.x, extent.y, extent.z});
  const double share = std::abs(signedVolume(mesh)) / (longest * longest * longest);
  return std::clamp(share, 0.0, 1.0) * across * across * across;
}

std::uint64_t polycubeMemory(const Mesh& mesh, const PolycubeSettings& settings) {
  const std::uint64_t across = settings.blocks ? settings.blocks : kMost;
  // The mesh's box says how many blocks there are.
  const Vec3 extent = boundingBox(mesh).extent();
  const double longest = std::max({extent.x, extent.y, extent.z});
  double blocks = 1;
  for (int a = 0; a < 3; ++a)
    blocks *= std::ceil(extent[a] / longest * static_cast<double>(across)) + 4;
  return kLevelSet + kBytesATriangle * mesh.triangles.size() +
         kBytesABlock * static_cast<std::uint64_t>(blocks);
}

std::vector<Setting> describe(PolycubeSettings& s) {
  return {Setting("blocks", "N", &s.blocks, "blocks along the longest side of the mesh's box")
              .from(kLeast, kMost)
              .otherwise(0, "as many as give about 900 in all")};
}

}  // namespace innermap
