#include "section.h"

namespace innermap::bench {

Tables sequence(const Options&) { return {}; }

}  // namespace innermap::bench
