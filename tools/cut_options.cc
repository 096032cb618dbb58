#include "cut_options.h"

#include <filesystem>

namespace innermap::tool {

CellPictureSettings CutOptions::cellPicture(const std::string& path) const {
  CellPictureSettings settings;
  settings.colormap = colormap;
  settings.direction = {0, 0, 0};
  settings.direction[axis] = 1;
  settings.at = at;
  settings.label = std::filesystem::path(path).filename().string() + ", cut";
  return settings;
}

std::vector<Setting> describe(CutOptions& o) {
  return {colormapSetting(&o.colormap), axisSetting("axis", &o.axis, "direction across the cut"),
          Setting("at", "T", &o.at, "where the picture cuts")
              .in("fraction of the box along the axis")
              .from(0, 1)};
}

void addCellPicture(Command& command, std::string& path, CutOptions& cut, const std::string& help) {
  command.group("picture");
  command.option("--picture", "FILE", &path, help).writes({".png"});
  command.settings(describe(cut));
}

}  // namespace innermap::tool
