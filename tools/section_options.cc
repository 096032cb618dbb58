#include "section_options.h"

#include "innermap/io/slice.h"

namespace innermap::tool {

void addSectionOptions(Command& c, SectionOptions& o) {
  c.choice("--section-axis", "AXIS", &o.axis, {{"auto", {}}, {"x", 0}, {"y", 1}, {"z", 2}},
           "direction across the pictured section; auto: where the solid is thinnest")
      .advanced();
  c.option("--section-at", "T", &o.at, "place of the pictured section along its axis")
      .unit("fraction of the box")
      .range(0, 1)
      .defaults("near the middle, where most is cut")
      .advanced();
  c.setting(colormapSetting(&o.colormap));
  c.setting(scaleSetting(&o.scale));
}

SectionSettings sectionSettings(const SectionOptions& options, const Solid& solid,
                                const openvdb::FloatGrid& density) {
  SectionSettings section;
  section.colormap = options.colormap;
  section.scale = options.scale;
  section.axis = options.axis ? *options.axis : thinnestAxis(solid.box().extent());
  section.at = options.at ? *options.at : fullLayer(density, section.axis);
  return section;
}

}  // namespace innermap::tool
