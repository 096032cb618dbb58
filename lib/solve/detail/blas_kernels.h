// Which machine code OpenBLAS runs.
//
// OpenBLAS chooses its kernels when it is loaded, by the processor's model number. A version older
// than the processor does not know that number and falls back to kernels without AVX (0.3.21 of
// Debian 12 does on Emerald Rapids), five to eight times slower in dgemm.
#pragma once

namespace innermap {

// Makes OpenBLAS choose again, by the instructions that the processor has, when it fell back
// and OPENBLAS_CORETYPE does not say that this is wanted. Not while other threads use BLAS or the
// environment. Returns the name of the kernels in use; empty for another BLAS.
const char* chooseBlasKernels();

// Makes OpenBLAS use the kernels of this name ("Haswell"), as far as it was built with a choice. At
// the same times.
void useBlasKernels(const char* name);

// Those in use; empty for another BLAS.
const char* blasKernels();

}  // namespace innermap
