// OpenBLAS waits for ever when it cannot map a buffer; so it is asked for them where they fit.
#pragma once

namespace innermap {

// Lets OpenBLAS map what it needs for each of the threads that call it, under a limit on address
// space (ulimit -v); nothing without one. Throws MemoryError where they do not fit. From any
// thread.
void requireBlasMemory();

}  // namespace innermap
