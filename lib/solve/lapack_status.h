// What LAPACK's C functions return.
#pragma once

#include <lapacke.h>

#include <new>

namespace innermap {

// Whether the routine did what it is for. Throws std::bad_alloc where there was no memory for its
// workspace, which says nothing of the numbers.
inline bool lapackSucceeded(lapack_int status) {
  if (status == LAPACK_WORK_MEMORY_ERROR || status == LAPACK_TRANSPOSE_MEMORY_ERROR)
    throw std::bad_alloc();
  return status == 0;
}

}  // namespace innermap
