// Ctrl-C, SIGTERM, the signals that must not kill, and ends that nothing catches.
#pragma once

#include <exception>

#include "innermap/core/run.h"

namespace innermap::tool {

// SIGINT, SIGTERM and SIGHUP cancel `run`, which must live as long as the process; one that
// came earlier, since the process began, cancels it now. If the process has not ended 0.8 s later
// (inside a long LAPACK call, say), or at a second signal, it removes its unfinished files, says
// what is in place and ends with exit code 130, or 0 when all outputs are. Broken pipes and file
// size limits become write errors.
void handleSignals(RunContext& run);

// Before the process ends by another signal (a crash, SIGQUIT) it removes its unfinished files too.
// So does it where an exception cannot be caught, as in functions of libraries that may not throw
// but are out of memory; it then says which, with exit code 1.

// Of std::bad_alloc.
constexpr char kMemoryExhausted[] =
    "memory is exhausted; use fewer or larger voxels, fewer points, or another machine";
// What to say of another exception: its text, unless that is a library's own word for something
// else.
const char* reasonOf(const std::exception& error) noexcept;

// From now on such signals are ignored: the work is done and in place.
void ignoreSignals();

// How many outputs this run will put in place, for what is said when it ends at once.
void expectOutputs(int more);
// From now on this run has finished work that stays for the next one.
void noteKeptWork();
int expectedOutputs();

}  // namespace innermap::tool
