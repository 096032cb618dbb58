// Which vector instructions the sums and the linear algebra of this process use. Results of one
// kind are the same to the bit on all processors; those of two kinds differ in their last bits.
#pragma once

#include <string>
#include <vector>

namespace innermap {

// "AVX3_DL, SkylakeX": of the sums, and of OpenBLAS (nothing for another BLAS).
std::string vectorCode();

// Names for setCpuTarget(): "avx2", "avx512".
const std::vector<std::string>& cpuTargets();

// Keeps to the instructions of such a processor, on newer ones too. To be called before any sum and
// while no other thread uses BLAS or the environment. Throws SettingError naming `setting` for
// another name, and when this processor has not these instructions.
void setCpuTarget(const std::string& setting, const std::string& name);

}  // namespace innermap
