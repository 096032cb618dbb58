// What a map's file says that is proven of it.
#pragma once

#include <string>

#include "innermap/fit/mapped_solid.h"

namespace innermap {

struct StatedProof {
  bool any = false;    // the file has such facts
  ProofFigures proof;  // as its statement takes them
  std::string fault;   // unless empty: what is wrong with the facts; then `proof` is none
};

StatedProof statedProof(const Facts& facts);

}  // namespace innermap
