// The files that the shares of a run leave, from which it is joined: OUTPUT/parts/.
//
// run.HASH.json says which run it is; its name has the hash of all that decides results.
// frame.0012.HASH.json has the figures of one frame or block, HASH being of what must be the same
// whoever makes it. So two workers at one frame write the same file, and bits that differ make a
// second one, which is found. Files appear whole; no clock is looked at.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "report/part.h"

namespace innermap {

// What a worker writes.
class PartFolder {
 public:
  // folder: the run's output. Makes its folder parts/. Throws DataError when parts of another run
  // are there, and says what differs; FileError.
  PartFolder(const std::string& folder, const PartRun& run);

  // The whole, good part of this frame made from this input, if it was there in the beginning.
  std::optional<Part> find(std::int64_t frame, const std::string& input) const;
  // Unless it is there.
  void writeRun(const PartRun& run);
  void write(const Part& part);

 private:
  std::string folder_, fingerprint_;
  std::vector<std::string> there_;  // names of frames' files when it was made
};

struct JoinedParts {
  PartRun run;
  std::vector<Part> parts;            // ascending frames, each once
  std::vector<std::int64_t> missing;  // frames without a part
};

// Reads what is there by now; a frame that failed and was made by another worker is made. Throws
// FileError where there are no parts, DataError for parts of several runs, of another version, that
// are cut off or changed, or that two workers made with other bits: it says which, and what to do.
JoinedParts readParts(const std::string& folder);

// Whether the file of a frame or block is there, by its size; fingerprint: what fingerprintOf()
// told of it when it was written.
bool isWhole(const std::string& path, const std::string& fingerprint);

// "3, 4, 7 and 12 more"
std::string framesText(const std::vector<std::int64_t>& frames);

// The kind of vector code that this process computes with ("AVX3_DL, SkylakeX"): results of one
// kind are the same to the bit, those of two kinds differ in their last bits.
std::string partCode();

// Names for keepToCpu(): "avx2", "avx512".
const std::vector<std::string>& cpuNames();

// From now on this process computes as such a processor does, on a newer one too. Before anything
// is computed. Throws SettingError naming `setting` for another name, and when this processor
// cannot.
void keepToCpu(const std::string& setting, const std::string& name);

// NaN, 0, empty where there is none of this key or it is of another kind.
double numberAt(const PartValues& values, const std::string& key);
std::uint64_t countAt(const PartValues& values, const std::string& key);  // also of a bool
std::string textAt(const PartValues& values, const std::string& key);
std::vector<double> numbersAt(const PartValues& values, const std::string& key);

}  // namespace innermap
