// What tests of all rooms expect of calls.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "innermap/core/error.h"
#include "innermap/core/run.h"

namespace innermap {

// While it lives, the thread's calls belong to a run whose process may hold `bytes`.
class MemoryLimit {
 public:
  explicit MemoryLimit(std::uint64_t bytes) { run_.setMaxMemory(bytes); }

 private:
  RunContext run_;
  const RunScope scope_{run_};
};

namespace test {

// That `body` stops in a run that is cancelled.
template <class Body>
void expectCancels(const Body& body) {
  RunContext run;
  run.cancel();
  const RunScope scope(run);
  EXPECT_THROW(body(), Cancelled);
}

// That `body` needs more than so many bytes for the process, and says so before it takes them.
template <class Body>
void expectOverLimit(std::uint64_t bytes, const Body& body) {
  const MemoryLimit limit(bytes);
  EXPECT_THROW(body(), MemoryError);
}

// What the error says that `body` throws; "accepted" where it throws none.
template <class E = Error, class Body>
std::string refusalOf(const Body& body) {
  try {
    body();
  } catch (const E& error) {
    return error.what();
  }
  return "accepted";
}

// That `body` throws an error that says `part` among the rest.
template <class E = Error, class Body>
void expectRefused(const Body& body, const std::string& part) {
  const std::string said = refusalOf<E>(body);
  EXPECT_NE(said.find(part), std::string::npos) << "'" << part << "' is not in: " << said;
}

// That `body` returns the same whatever the number of threads.
template <class Body>
void expectSameForThreads(const Body& body) {
  const auto with = [&](int threads) {
    const ThreadLimit limit(threads);
    return body();
  };
  EXPECT_EQ(with(1), with(3));
}

}  // namespace test
}  // namespace innermap
