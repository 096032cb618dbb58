// The readers that are fuzzed, a line each in readers.cc.
#pragma once

#include <string>
#include <vector>

namespace innermap::fuzz {

struct Reader {
  const char* name;
  const char* extension;             // that the file gets; its corpus is corpus/EXTENSION
  void (*read)(const std::string&);  // of this path. May throw innermap::Error, nothing else
};

const std::vector<Reader>& readers();

}  // namespace innermap::fuzz
