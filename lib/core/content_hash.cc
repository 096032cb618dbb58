#include <fmt/format.h>

#include <fstream>
#include <vector>

#include "core/file.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"

namespace innermap {
namespace {

constexpr std::size_t kWord = 8;
constexpr std::size_t kBlock = std::size_t(1) << 20;  // whole words

// Bytes come in blocks; all but the last are whole words.
class Hash {
 public:
  void add(std::string_view bytes) {
    size_ += bytes.size();
    std::size_t i = 0;
    for (; i + kWord <= bytes.size(); i += kWord) step(bytes.substr(i, kWord));
    if (i < bytes.size()) step(bytes.substr(i));
  }

  std::uint64_t value() const {
    std::uint64_t z = state_ ^ size_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }

  std::uint64_t size() const { return size_; }

 private:
  void step(std::string_view word) {
    std::uint64_t w = 0;
    for (std::size_t k = 0; k < word.size(); ++k)
      w |= std::uint64_t(static_cast<unsigned char>(word[k])) << (8 * k);
    state_ = (state_ ^ w) * 0x100000001b3u;
    state_ ^= state_ >> 32;
  }

  std::uint64_t state_ = 0xcbf29ce484222325u;
  std::uint64_t size_ = 0;
};

Hash hashFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw FileError(path, "cannot be opened; check the path");
  std::vector<char> block(kBlock);
  Hash hash;
  while (file) {
    throwIfCancelled();
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    hash.add({block.data(), static_cast<std::size_t>(file.gcount())});
  }
  if (!file.eof()) throw FileError(path, "cannot be read to its end");
  return hash;
}

}  // namespace

std::uint64_t hashOf(std::string_view bytes) {
  Hash hash;
  hash.add(bytes);
  return hash.value();
}

std::string fingerprintOf(const std::string& path) {
  const Hash hash = hashFile(path);
  return fmt::format("{}-{:016x}", hash.size(), hash.value());
}

}  // namespace innermap
