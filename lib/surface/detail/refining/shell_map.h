// One closed surface mapped onto another of the same genus, 0 or 1.
#pragma once

#include "surface/detail/refining/laid_out_shell.h"

namespace innermap {

// Throws DataError where no map without flips was found (landmarks that contradict one another),
// Cancelled.
ShellMap mapShell(const LaidOutShell& a, const LaidOutShell& b, const ShellMapSettings& settings);

}  // namespace innermap
