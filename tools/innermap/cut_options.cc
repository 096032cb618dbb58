#include "cut_options.h"

#include <filesystem>

namespace innermap::tool {

CellPictureSettings CutOptions::cellPicture(const std::string& path) const {
  CellPictureSettings settings;
  settings.colormap = colormap;
  settings.direction = {0, 0, 0};
  settings.direction[axis()] = 1;
  settings.at = at();
  settings.label = std::filesystem::path(path).filename().string() + ", cut";
  return settings;
}

void addCut(Command& command, CutOptions& o) {
  command.setting(colormapSetting(&o.colormap));
  command
      .option("--section", kCutPlaceholder, &o.cut,
              "where the picture cuts: x, y or z, and the fraction of the box along it")
      .defaults("z=0.5")
      .was("--axis,--at");
}

void addCellPicture(Command& command, std::string& path, CutOptions& cut, const std::string& help) {
  command.group("picture");
  command.option("--picture", "FILE", &path, help).writes({".png"});
  addCut(command, cut);
}

}  // namespace innermap::tool
