#include "section_options.h"

#include "innermap/io/slice.h"

namespace innermap::tool {

void addColormapOption(Command& c, Colormap& colormap) {
  c.choice("--colormap", "NAME", &colormap, colormapNames(),
           "colours of the picture, from the least to the most; all are told apart by people who "
           "are colour-blind");
}

void addScaleOption(Command& c, SectionScale& scale) {
  c.choice("--scale", "HOW", &scale,
           {{"auto", SectionScale::automatic},
            {"linear", SectionScale::linear},
            {"log", SectionScale::logarithmic},
            {"about-1", SectionScale::about1}},
           "how values go along the colours: log and about-1, whose middle is 1, by their ratios; "
           "auto: about-1 for a jacobian, with folds in a colour of their own, log where values "
           "are over 100 times apart, linear with a range")
      .advanced();
}

void addSectionOptions(Command& c, SectionOptions& o) {
  c.choice("--section-axis", "AXIS", &o.axis, {{"auto", {}}, {"x", 0}, {"y", 1}, {"z", 2}},
           "direction across the pictured section; auto: where the solid is thinnest")
      .advanced();
  c.option("--section-at", "T", &o.at, "place of the pictured section along its axis")
      .unit("fraction of the box")
      .range(0, 1)
      .defaults("near the middle, where most is cut")
      .advanced();
  addColormapOption(c, o.colormap);
  addScaleOption(c, o.scale);
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
