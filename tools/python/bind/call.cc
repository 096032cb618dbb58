#include "bind/call.h"

#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "bind/keywords.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"

namespace py = pybind11;

namespace innermap::python {
namespace {

constexpr std::chrono::milliseconds kPoll{50};
constexpr std::chrono::seconds kLongestEnd{10};

class CallRun : public RunContext {
 public:
  using Stage = std::pair<std::string, double>;

  void report(std::string_view stage, double fraction) override {
    const std::lock_guard<std::mutex> guard(mutex_);
    if (!stages_.empty() && stages_.back().first == stage)
      stages_.back().second = fraction;
    else
      stages_.emplace_back(stage, fraction);
  }

  std::vector<Stage> take() {
    const std::lock_guard<std::mutex> guard(mutex_);
    return std::exchange(stages_, {});
  }

  // The first is what the call ends with. With the lock of the interpreter.
  void keep(const py::error_already_set& error) {
    if (!error_) error_ = error;
    cancel();
  }
  void rethrow() {
    if (!error_) return;
    py::error_already_set error = std::move(*error_);
    error_.reset();
    throw error;
  }
  bool failed() const { return error_.has_value(); }

 private:
  std::mutex mutex_;
  std::vector<Stage> stages_;
  std::optional<py::error_already_set> error_;
};

void tell(CallRun& run, const py::object& callable) {
  if (callable.is_none()) return;
  for (const auto& [stage, fraction] : run.take()) callable(stage, fraction);
}

// Signals and progress, in the thread that called. With the lock of the interpreter.
void look(CallRun& run, const py::object& callable) {
  if (run.failed()) return;
  try {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    tell(run, callable);
  } catch (const py::error_already_set& error) {
    run.keep(error);
  }
}

// The calls that go on. The interpreter does not wait for its daemon threads, and what they compute
// must not go on while the process is taken down.
class ActiveCalls {
 public:
  static ActiveCalls& instance() {
    static auto* const calls = new ActiveCalls;  // outlives statics
    return *calls;
  }

  void add(CallRun* call) {
    const std::lock_guard<std::mutex> guard(mutex_);
    forgetOthers();
    if (ended_) throw Cancelled();
    calls_.insert(call);
  }
  void remove(CallRun* call) {
    {
      const std::lock_guard<std::mutex> guard(mutex_);
      calls_.erase(call);
    }
    fewer_.notify_all();
  }
  // Cancels all, and waits for them.
  void end() {
    std::unique_lock<std::mutex> lock(mutex_);
    forgetOthers();
    ended_ = true;
    for (CallRun* call : calls_) call->cancel();
    fewer_.wait_for(lock, kLongestEnd, [&] { return calls_.empty(); });
  }

 private:
  // A forked process has none of the threads.
  void forgetOthers() {
    if (process_ != getpid()) calls_.clear();
    process_ = getpid();
  }

  std::mutex mutex_;
  std::condition_variable fewer_;
  std::set<CallRun*> calls_;
  pid_t process_ = getpid();
  bool ended_ = false;
};

// Begins and ends with the interpreter's lock: without it, a thread that comes back while the
// interpreter ends is torn down in the midst of C++.
class ActiveCall {
 public:
  explicit ActiveCall(CallRun& call) : call_(call) { ActiveCalls::instance().add(&call_); }
  ~ActiveCall() { ActiveCalls::instance().remove(&call_); }
  ActiveCall(const ActiveCall&) = delete;
  ActiveCall& operator=(const ActiveCall&) = delete;

 private:
  CallRun& call_;
};

// A thread that works, and says when it is done.
class Worker {
 public:
  explicit Worker(const std::function<void()>& work)
      : thread_([this, work] {
          try {
            work();
          } catch (...) {
            error_ = std::current_exception();
          }
          {
            const std::lock_guard<std::mutex> guard(mutex_);
            done_ = true;
          }
          changed_.notify_all();
        }) {}
  ~Worker() { thread_.join(); }

  bool doneWithin(std::chrono::milliseconds time) {
    std::unique_lock<std::mutex> lock(mutex_);
    return changed_.wait_for(lock, time, [&] { return done_; });
  }
  // Once it is done.
  const std::exception_ptr& error() const { return error_; }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool done_ = false;
  std::exception_ptr error_;
  std::thread thread_;
};

}  // namespace

void CallOptions::describe(Keywords& k) {
  k.object("progress", &progress, "Callable[[str, float], object]",
           "called some times a second with the stage in words and its share done, 0 to 1; what "
           "it raises ends the call");
  k.bytes("max_memory", &maxMemory,
          "of the process, in bytes or as '4GB'; a call that is known to need more raises "
          "MemoryError at once; 0.8 of the machine's if not given");
  k.number("threads", &threads, {0, 4096}, "at most; 0: all cores. Results do not depend on it");
}

void CallOptions::describeTime(Keywords& k, const char* doc) {
  k.number("max_time", &maxTime, {1e-6, 1e9}, doc);
}

void bindCalls() {
  py::module_::import("atexit").attr("register")(py::cpp_function([] {
    const py::gil_scoped_release unlocked;
    ActiveCalls::instance().end();
  }));
}

void keepPythonError(const py::error_already_set& error) {
  static_cast<CallRun&>(currentRun()->whole()).keep(error);
}

void requireMemory(const MemoryNeed& need) {
  innermap::requireMemory(need, processMemory(0), memoryLimit(), asCalled);
}

void warn(const std::string& text) {
  if (PyErr_WarnEx(PyExc_RuntimeWarning, text.c_str(), 1) != 0) throw py::error_already_set();
}

void runCall(const CallOptions& options, const std::function<void()>& work) {
  CallRun run;
  run.setMaxMemory(options.maxMemory);
  if (options.maxTime) {
    const std::chrono::duration<double> gone = std::chrono::steady_clock::now() - options.began;
    run.setSecondsLeft(options.timeShare * (*options.maxTime - gone.count()));
  }
  const ActiveCall active(run);
  std::exception_ptr error;
  {
    const py::gil_scoped_release unlocked;
    Worker worker([&] {
      std::optional<ThreadLimit> limit;
      if (options.threads > 0) limit.emplace(options.threads);
      const RunScope scope(run);
      work();
    });
    while (!worker.doneWithin(kPoll)) {
      const py::gil_scoped_acquire locked;
      look(run, options.progress);
    }
    error = worker.error();
  }
  if (!error) look(run, options.progress);
  run.rethrow();
  if (error) std::rethrow_exception(error);
  if (run.endedByTime()) warn("stopped by max_time: another call may differ");
}

}  // namespace innermap::python
