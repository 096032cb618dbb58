// One call from Python into the library: without the interpreter's lock, with progress, Ctrl-C and
// limits.
#pragma once

#include <pybind11/pybind11.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "innermap/core/error.h"
#include "jobs/needs.h"

namespace innermap::python {

class Keywords;

// What every long function takes.
struct CallOptions {
  pybind11::object progress = pybind11::none();  // callable(stage, fraction)
  std::uint64_t maxMemory = 0;                   // bytes
  int threads = 0;                               // 0: all cores
  std::optional<double> maxTime;                 // seconds
  double timeShare = 1;                          // of what is left of them, for the next runCall
  std::chrono::steady_clock::time_point began = std::chrono::steady_clock::now();

  void describe(Keywords& k);
  // For functions that improve a result until a deadline.
  void describeTime(Keywords& k,
                    const char* doc =
                        "stop trying, refining and repairing after this many seconds, with a "
                        "RuntimeWarning: another call may differ; no limit if not given");
};

// Calls that go on when the interpreter ends, in daemon threads, are cancelled.
void bindCalls();

// Calls `work` in a thread of its own, with the lock of the interpreter released, while this one
// waits: it looks for signals and calls `progress` some twenty times a second. What a signal
// handler or `progress` raises cancels the work and comes out here; so does what `work` throws.
void runCall(const CallOptions& options, const std::function<void()>& work);

// The same, with what `work` gives.
template <class Work>
auto call(const CallOptions& options, Work&& work) -> decltype(work()) {
  std::optional<decltype(work())> out;
  runCall(options, [&] { out.emplace(work()); });
  return std::move(*out);
}

// Within a call: throws MemoryError where a job would take the process over the call's limit.
void requireMemory(const MemoryNeed& need);

// A RuntimeWarning of Python, which may be an error there. With the lock.
void warn(const std::string& text);

// For work that is over at once: with the lock released. Gives None.
template <class Work>
pybind11::object withoutLock(Work&& work) {
  {
    const pybind11::gil_scoped_release unlocked;
    work();
  }
  return pybind11::none();
}

// The error of Python that a callable raised: the call ends with it.
void keepPythonError(const pybind11::error_already_set& error);

// For callables of Python within `work`, from any of the library's threads: with the lock, and what
// Python raises comes out of runCall(). body: gives nothing that holds an object of Python.
template <class Body>
auto inPython(Body&& body) -> decltype(body()) {
  const pybind11::gil_scoped_acquire lock;
  try {
    return body();
  } catch (pybind11::error_already_set& error) {
    keepPythonError(error);
  }
  throw Cancelled();
}

}  // namespace innermap::python
