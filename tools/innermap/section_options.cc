#include "section_options.h"

#include "innermap/io/pictures.h"

namespace innermap::tool {

void addSectionOptions(Command& c, SectionOptions& o) {
  c.option("--section", kCutPlaceholder, &o.cut,
           "plane of the picture: x, y or z, and the fraction of the box along it, as in x=0.5")
      .defaults("across the thinnest direction, near the middle, where the cut is largest")
      .was("--section-axis,--section-at");
  c.setting(colormapSetting(&o.colormap));
  c.setting(scaleSetting(&o.scale));
}

SectionSettings sectionSettings(const SectionOptions& options, const Solid& solid,
                                const openvdb::FloatGrid& density) {
  SectionSettings section;
  section.colormap = options.colormap;
  section.scale = options.scale;
  section.axis = options.cut.axis ? *options.cut.axis : thinnestAxis(solid.box().extent());
  section.at = options.cut.at ? *options.cut.at : fullLayer(density, section.axis);
  return section;
}

}  // namespace innermap::tool
