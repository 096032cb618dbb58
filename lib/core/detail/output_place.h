// Where an output really goes: through links, or into a device or pipe.
#pragma once

#include <string>

namespace innermap {

struct OutputPlace {
  std::string path;      // of the file itself, behind all links
  bool through = false;  // a device, a pipe or an open file: written to, not replaced
};

// Throws FileError for folders, links in a circle, what cannot be reached, and names that are too
// long; in all of its words `path` is what was asked for.
OutputPlace outputPlace(const std::string& path);

// What the system's error number `error` says of a failure to make `path`, and what to do.
std::string whyNotWritable(const std::string& path, int error);

// A lock on a file or folder that was opened, held while `descriptor` is open; false when another
// process has it.
bool lockTemporary(int descriptor) noexcept;

// Removes what processes that were killed left behind in `folder`, all whose names begin with
// `prefix`. Folders of files that were being put in place when that happened are put in place to
// the end.
void clearLeftBehind(const std::string& folder, const std::string& prefix);

// In the temporary folder of files that appear together: the files that they replace. There when
// they are being put in place.
constexpr char kReplaced[] = "replaced";
constexpr char kWritten[] = "new";

}  // namespace innermap
