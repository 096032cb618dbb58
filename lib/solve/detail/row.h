// Numbers that the innermost loops read and write many times over.
#pragma once

#include <tbb/cache_aligned_allocator.h>

#include <vector>

namespace innermap::simd {

// A vector register that is loaded across two lines of the cache takes twice as long, and where
// malloc begins is chance.
using Row = std::vector<double, tbb::cache_aligned_allocator<double>>;

}  // namespace innermap::simd
