#include "io/cells/detail/msh_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "core/text_scanner.h"

namespace innermap {

void MshFields::read(bool onNodes) {
  Data data;
  data.onNodes = onNodes;
  const std::int64_t texts = in_.textInteger();
  in_.requireRoom(texts, 1, 1);
  for (std::int64_t k = 0; k < texts; ++k) {
    std::string text = in_.quoted();
    if (k == 0) data.field.name = std::move(text);
  }
  const std::int64_t reals = in_.textInteger();
  in_.requireRoom(reals, 1, 1);
  for (std::int64_t k = 0; k < reals; ++k) in_.textReal();
  const std::int64_t integers = in_.textInteger();
  in_.requireRoom(integers, 1, 1);
  std::int64_t components = 1, count = 0;
  for (std::int64_t k = 0; k < integers; ++k) {
    const std::int64_t value = in_.textInteger();
    if (k == 1) components = value;
    if (k == 2) count = value;
  }
  in_.endLine();
  if (components < 1 || components > 1000)
    in_.fail(fmt::format("a field has {} components", components));
  const auto width = static_cast<int>(components);
  in_.requireRoom(count, 1 + width, 4 + 8 * width);
  data.field.components = width;
  if (width == 3) data.field.kind = CellField::Kind::vector;
  for (std::int64_t i = 0; i < count; ++i) {
    collector_.poll(static_cast<std::uint64_t>(i));
    data.tags.push_back(in_.integer());
    for (int k = 0; k < width; ++k) data.field.values.push_back(in_.real());
  }
  data_.push_back(std::move(data));
}

void MshFields::finish(const std::string& path, const MshTags& nodeRows, std::int64_t nodes,
                       MshCellLists tets, MshCellLists hexes) {
  addLabels(kGmshPhysical, tets.groups, hexes.groups);
  addLabels(kGmshGeometrical, tets.entities, hexes.entities);
  MshTags cellRows;
  std::int64_t cells = 0;
  for (const MshCellLists* lists : {&tets, &hexes})
    for (const std::int64_t tag : lists->tags) cellRows.add(tag, cells++);
  for (Data& data : data_) {
    const MshTags& rows = data.onNodes ? nodeRows : cellRows;
    const auto width = static_cast<std::size_t>(data.field.components);
    std::vector<double> values(static_cast<std::size_t>(data.onNodes ? nodes : cells) * width,
                               std::numeric_limits<double>::quiet_NaN());
    std::size_t used = 0;
    for (std::size_t i = 0; i < data.tags.size(); ++i) {
      const std::int64_t row = rows.find(data.tags[i]);
      if (row < 0) continue;  // of cells that were left out
      ++used;
      std::copy_n(&data.field.values[i * width], width,
                  &values[static_cast<std::size_t>(row) * width]);
    }
    data.field.values = std::move(values);
    if (used == 0 && !data.tags.empty()) {
      collector_.note(fmt::format("{}: field {} is on none of the cells; it is left out", path,
                                  inQuotes(data.field.name)));
      continue;
    }
    auto& fields = collector_.file.mesh;
    (data.onNodes ? fields.vertexFields : fields.cellFields).push_back(std::move(data.field));
  }
}

void MshFields::addLabels(const char* name, std::vector<double>& ofTets,
                          const std::vector<double>& ofHexes) {
  ofTets.insert(ofTets.end(), ofHexes.begin(), ofHexes.end());
  const auto different = [&](double value) { return value != 0 && value != 1; };
  if (std::any_of(ofTets.begin(), ofTets.end(), different) ||
      (name == std::string(kGmshPhysical) &&
       std::any_of(ofTets.begin(), ofTets.end(), [](double v) { return v != 0; })))
    collector_.file.mesh.cellFields.push_back(
        {name, 1, CellField::Kind::scalar, std::move(ofTets), true});
}

}  // namespace innermap
