#include "signals.h"

#include <signal.h>
#include <sys/time.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <cstring>
#include <exception>
#include <new>

#include "core/file.h"
#include "innermap/core/run.h"

namespace innermap::tool {
namespace {

std::atomic<RunContext*> cancelled{nullptr};
std::atomic<int> requests{0}, expected{0};
std::atomic<bool> done{false}, kept{false};

void startTimer(int microseconds) {
  itimerval timer{};
  timer.it_value.tv_usec = microseconds;
  setitimer(ITIMER_REAL, &timer, nullptr);
}

void append(const char* text) {
  [[maybe_unused]] const auto written = write(STDERR_FILENO, text, std::strlen(text));
}

void say(const char* text) {
  if (isatty(STDERR_FILENO)) append("\r\x1b[K");
  append(text);
}

void endNow() {
  // Files that are being put in place are soon all there.
  if (commitUnderWay()) return startTimer(20000);
  removeUnfinishedFiles();
  const std::uint64_t inPlace = outputsInPlace();
  if (inPlace > 0 && inPlace >= static_cast<std::uint64_t>(expected)) _exit(0);
  say(inPlace == 0 && kept ? "innermap: cancelled; what is finished is kept for the next run\n"
      : inPlace == 0       ? "innermap: cancelled; nothing was written\n"
                     : "innermap: cancelled; some of the outputs are in place, others are not\n");
  _exit(130);
}

bool allInPlace() {
  return expected > 0 && outputsInPlace() >= static_cast<std::uint64_t>(expected);
}

void onTimer(int) {
  if (!done) endNow();
}

void onRequest(int) {
  if (done) return;
  if (++requests > 1) return endNow();
  if (RunContext* const run = cancelled) run->cancel();
  startTimer(800000);
}

[[noreturn]] void onTerminate() {
  for (int waits = 0; commitUnderWay() && waits < 1000; ++waits) usleep(1000);
  removeUnfinishedFiles();
  const char* why = "an error occurred that could not be handled";
  const std::exception_ptr current = std::current_exception();  // names its text
  try {
    if (current) std::rethrow_exception(current);
  } catch (const std::bad_alloc&) {
    why = kMemoryExhausted;
  } catch (const std::exception& error) {
    why = reasonOf(error);
  } catch (...) {
  }
  // There is none where it could not be allocated.
  if (!current) why = "an error occurred that could not be described; memory may be exhausted";
  say("innermap: ");
  append(why);
  append("\n");
  _exit(1);
}

// The system's own end follows, at once after this; a second signal waits for it.
void onCrash(int number) {
  removeUnfinishedFiles();
  signal(number, SIG_DFL);
  raise(number);
}

// Ends as by a crash, which leaves a core, but not amid the commit or after it.
void onQuit(int number) {
  if (done) return;
  if (commitUnderWay() || allInPlace()) return endNow();
  onCrash(number);
}

void install(int number, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  sigaction(number, &action, nullptr);
}

// Before main, and before what stands in static storage is made, which takes a while.
__attribute__((constructor(101))) void installHandlers() {
  install(SIGALRM, onTimer);
  for (int number : {SIGINT, SIGTERM}) install(number, onRequest);
  // Under nohup hang-ups stay ignored.
  struct sigaction before {};
  sigaction(SIGHUP, nullptr, &before);
  if (before.sa_handler != SIG_IGN) install(SIGHUP, onRequest);
  for (int number : {SIGQUIT, SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGXCPU}) {
    sigaction(number, nullptr, &before);
    if (before.sa_handler != SIG_DFL) continue;  // a sanitizer's
    struct sigaction action {};
    action.sa_handler = number == SIGQUIT ? onQuit : onCrash;
    sigfillset(&action.sa_mask);
    sigaction(number, &action, nullptr);
  }
  std::set_terminate(onTerminate);
  signal(SIGPIPE, SIG_IGN);
  signal(SIGXFSZ, SIG_IGN);
}

}  // namespace

const char* reasonOf(const std::exception& error) noexcept {
  if (std::strstr(error.what(), "pthread_create"))  // TBB
    return "a thread cannot be started: memory, or the number of processes allowed, is exhausted; "
           "use fewer threads (--threads)";
  return error.what();
}

void handleSignals(RunContext& run) {
  cancelled = &run;
  if (requests > 0) run.cancel();
}

void ignoreSignals() {
  done = true;
  startTimer(0);
}

void expectOutputs(int more) { expected += more; }
void noteKeptWork() { kept = true; }
int expectedOutputs() { return expected; }

}  // namespace innermap::tool
