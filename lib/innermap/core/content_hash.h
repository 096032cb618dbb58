// Tells whether a file is still the one that a result was made from. Not cryptographic.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "innermap/core/progress.h"

namespace innermap {

// 64 bits, the same on every machine: FNV-1a over words of eight bytes with a shift after each
// (Fowler, Noll, Vo, "The FNV Non-Cryptographic Hash Algorithm", 1991), finished as SplitMix64.
std::uint64_t hashOf(std::string_view bytes);

struct FingerprintSettings {
  Progress* progress = nullptr;
};

// "558589-9f86d081884c7d65": a file's size and the hash of its content. Throws FileError when it
// cannot be read, Cancelled.
std::string fingerprintOf(const std::string& path, const FingerprintSettings& settings = {});

}  // namespace innermap
