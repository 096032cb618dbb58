// Every error that innermap throws. Messages are one line: which file or setting, what is wrong
// with it, and what to do.
#pragma once

#include <stdexcept>
#include <string>

namespace innermap {

class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// A file cannot be read, written or understood.
class FileError : public Error {
 public:
  FileError(const std::string& path, const std::string& what) : Error(path + ": " + what) {}
};

// Data that is well-formed but that the computation cannot use (a mesh with no inside, say).
class DataError : public Error {
 public:
  using Error::Error;
};

// A setting outside its range, or settings that contradict one another.
class SettingError : public Error {
 public:
  SettingError(const std::string& setting, const std::string& what)
      : Error(setting + ": " + what) {}
};

// The memory needed is known and exceeds the budget; nothing was allocated.
class MemoryError : public Error {
 public:
  using Error::Error;
};

// Thrown out of a computation whose run was cancelled (core/run.h). No partial result exists.
class Cancelled : public Error {
 public:
  Cancelled() : Error("cancelled") {}
};

}  // namespace innermap
