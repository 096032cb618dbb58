// The font of the labels in pictures.
#pragma once

#include <string>

namespace innermap {

// The font file that charts, sections and pictures of surfaces are labelled with, DejaVu Sans or
// Liberation Sans; empty where neither is installed: pictures have no labels then.
const std::string& labelFont();

}  // namespace innermap
