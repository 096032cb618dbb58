#include "transfer/detail/carrier.h"

#include <algorithm>
#include <optional>

#include "innermap/core/error.h"
#include "innermap/core/run.h"

namespace innermap {
namespace {

std::optional<std::size_t> placeOf(const openvdb::GridPtrVec& grids, const std::string& name) {
  for (std::size_t i = 0; i < grids.size(); ++i)
    if (grids[i]->getName() == name) return i;
  return std::nullopt;
}

std::string namesOf(const openvdb::GridPtrVec& grids) {
  std::string list;
  for (const openvdb::GridBase::Ptr& grid : grids)
    list += (list.empty() ? "" : ", ") + grid->getName();
  return list;
}

// Places of NAME.xx and so on, or of NAME.x, .y, .z.
std::vector<std::size_t> partsOf(const openvdb::GridPtrVec& grids, const std::string& name) {
  static const std::vector<std::vector<std::string>> kSuffixes{
      {".xx", ".yy", ".zz", ".xy", ".yz", ".xz"}, {".x", ".y", ".z"}};
  std::string missing;
  for (const std::vector<std::string>& suffixes : kSuffixes) {
    std::vector<std::size_t> places;
    std::string lacks;
    for (const std::string& suffix : suffixes)
      if (const auto place = placeOf(grids, name + suffix))
        places.push_back(*place);
      else
        lacks += (lacks.empty() ? "" : ", ") + name + suffix;
    if (lacks.empty()) return places;
    if (!places.empty() || missing.empty()) missing = lacks;
  }
  throw DataError("tensor \"" + name + "\": there is no grid " + missing + "; there are " +
                  namesOf(grids));
}

bool isScalar(const openvdb::GridBase& grid) {
  return grid.isType<openvdb::FloatGrid>() || grid.isType<openvdb::DoubleGrid>();
}

bool isListed(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

void requireDensities(const openvdb::GridPtrVec& grids, const CarrySettings& settings) {
  for (const std::string& name : settings.densities) {
    const auto place = placeOf(grids, name);
    if (!place)
      throw DataError("density \"" + name + "\": there is no such grid; there are " +
                      namesOf(grids));
    if (!isScalar(*grids[*place]) || grids[*place]->getGridClass() == openvdb::GRID_LEVEL_SET)
      throw DataError("density \"" + name + "\": is no grid of scalars that fill space but " +
                      (isScalar(*grids[*place]) ? "a level set" : "of " + grids[*place]->type()));
  }
}

}  // namespace

bool isDensity(const openvdb::GridBase& grid, const CarrySettings& settings) {
  return isListed(settings.densities, grid.getName()) ||
         (settings.allDensities && isScalar(grid) &&
          grid.getGridClass() != openvdb::GRID_LEVEL_SET);
}

std::vector<std::unique_ptr<Carrier>> makeCarriers(const openvdb::GridPtrVec& grids,
                                                   const CarrySettings& settings,
                                                   const openvdb::FloatGrid* solid) {
  requireDensities(grids, settings);
  std::vector<std::unique_ptr<Carrier>> out;
  std::vector<char> taken(grids.size(), 0);
  for (const bool stress : {true, false})
    for (const std::string& name : stress ? settings.stresses : settings.strains) {
      const std::vector<std::size_t> places = partsOf(grids, name);
      openvdb::GridPtrVec parts;
      for (const std::size_t place : places) {
        if (taken[place])
          throw DataError("tensor \"" + name + "\": is named twice, or as stress and strain");
        taken[place] = 1;
        parts.push_back(grids[place]);
      }
      out.push_back(makeTensorCarrier(parts, places, stress, settings.sampling, solid));
    }
  for (std::size_t i = 0; i < grids.size(); ++i) {
    throwIfCancelled();
    if (taken[i]) continue;
    std::optional<double> limit;
    if (isDensity(*grids[i], settings)) limit = settings.densityLimit;
    out.push_back(makeGridCarrier(grids[i], i, settings.sampling, limit, solid));
  }
  return out;
}

void requireCarriable(const openvdb::GridPtrVec& grids, const CarrySettings& settings) {
  makeCarriers(grids, settings, nullptr);
}

}  // namespace innermap
