// Ctrl-C, SIGTERM and the signals that must not kill.
#pragma once

#include "innermap/core/progress.h"

namespace innermap::tool {

// SIGINT, SIGTERM and SIGHUP cancel `progress`, which must live as long as the process. If the
// process has not ended 0.8 s later (inside a long LAPACK call, say), or at a second signal, it
// removes its unfinished files and ends with exit code 130. Broken pipes and file size limits
// become write errors.
void handleSignals(Progress& progress);

}  // namespace innermap::tool
