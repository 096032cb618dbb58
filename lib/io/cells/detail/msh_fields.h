// Fields of Gmsh's files: read as they come, put in the mesh's order when all of it is known.
#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "io/cells/detail/cell_formats.h"
#include "io/cells/detail/msh_cursor.h"

namespace innermap {

// Rows by the tags that files give them: any whole numbers, mostly 1, 2, 3.
class MshTags {
 public:
  void add(std::int64_t tag, std::int64_t row) {
    if (tag == static_cast<std::int64_t>(rows_.size()) + 1 && sparse_.empty())
      rows_.push_back(row);
    else
      sparse_[tag] = row;
  }
  // -1: none.
  std::int64_t find(std::int64_t tag) const {
    if (tag >= 1 && tag <= static_cast<std::int64_t>(rows_.size())) {
      const auto again = sparse_.find(tag);
      return again == sparse_.end() ? rows_[static_cast<std::size_t>(tag) - 1] : again->second;
    }
    const auto found = sparse_.find(tag);
    return found == sparse_.end() ? -1 : found->second;
  }
  bool contains(std::int64_t tag) const { return find(tag) >= 0; }

 private:
  std::vector<std::int64_t> rows_;  // of 1, 2, 3, ...
  std::unordered_map<std::int64_t, std::int64_t> sparse_;
};

// Of the cells of one kind, in their order.
struct MshCellLists {
  std::vector<std::int64_t> tags;
  std::vector<double> entities, groups;
};

class MshFields {
 public:
  MshFields(CellCollector& collector, MshCursor& in) : collector_(collector), in_(in) {}

  // A section of data, from after its name on.
  void read(bool onNodes);

  // Gives the collector's mesh all fields, and labels where they tell cells apart. path: for notes.
  void finish(const std::string& path, const MshTags& nodeRows, std::int64_t nodes,
              MshCellLists tets, MshCellLists hexes);

 private:
  struct Data {
    bool onNodes;
    CellField field;
    std::vector<std::int64_t> tags;
  };
  void addLabels(const char* name, std::vector<double>& ofTets, const std::vector<double>& ofHexes);

  CellCollector& collector_;
  MshCursor& in_;
  std::vector<Data> data_;
};

}  // namespace innermap
