#include "section_options.h"

#include <filesystem>

namespace innermap::tool {

CellPictureSettings SectionOptions::cellPicture(const std::string& path) const {
  CellPictureSettings settings;
  settings.colormap = colormap;
  settings.direction = {0, 0, 0};
  settings.direction[axis()] = 1;
  settings.at = at();
  settings.label = std::filesystem::path(path).filename().string() + ", cut";
  return settings;
}

SectionSettings SectionOptions::of(const Solid& solid, const openvdb::FloatGrid& density) const {
  SectionSettings section;
  section.colormap = colormap;
  section.scale = scale;
  section.axis = cut.axis ? *cut.axis : thinnestAxis(solid.box().extent());
  section.at = cut.at ? *cut.at : fullLayer(density, section.axis);
  return section;
}

void addSectionOptions(Command& c, SectionOptions& o) {
  c.option("--section", kCutPlaceholder, &o.cut,
           "plane of the picture: x, y or z, and the fraction of the box along it, as in x=0.5")
      .defaults("across the thinnest direction, near the middle, where the cut is largest")
      .was("--section-axis,--section-at");
  c.setting(colormapSetting(&o.colormap));
  c.setting(scaleSetting(&o.scale));
}

void addCut(Command& command, SectionOptions& o) {
  command.setting(colormapSetting(&o.colormap));
  command
      .option("--section", kCutPlaceholder, &o.cut,
              "where the picture cuts: x, y or z, and the fraction of the box along it")
      .defaults("z=0.5")
      .was("--axis,--at");
}

void addCellPicture(Command& command, std::string& path, SectionOptions& cut,
                    const std::string& help) {
  command.group("picture");
  command.option("--picture", "FILE", &path, help).writes({".png"});
  addCut(command, cut);
}

}  // namespace innermap::tool
