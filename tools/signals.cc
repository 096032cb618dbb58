#include "signals.h"

#include <signal.h>
#include <sys/time.h>
#include <unistd.h>

#include <atomic>

#include "innermap/core/file.h"

namespace innermap::tool {
namespace {

Progress* cancelled = nullptr;
std::atomic<int> requests{0};

[[noreturn]] void endNow() {
  removeUnfinishedFiles();
  _exit(130);
}

void onTimer(int) { endNow(); }

void onRequest(int) {
  if (++requests > 1) endNow();
  cancelled->cancel();
  itimerval timer{};
  timer.it_value.tv_usec = 800000;
  setitimer(ITIMER_REAL, &timer, nullptr);
}

void install(int number, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  sigaction(number, &action, nullptr);
}

}  // namespace

void handleSignals(Progress& progress) {
  cancelled = &progress;
  install(SIGALRM, onTimer);
  for (int number : {SIGINT, SIGTERM}) install(number, onRequest);
  // Under nohup hang-ups stay ignored.
  struct sigaction before {};
  sigaction(SIGHUP, nullptr, &before);
  if (before.sa_handler != SIG_IGN) install(SIGHUP, onRequest);
  signal(SIGPIPE, SIG_IGN);
  signal(SIGXFSZ, SIG_IGN);
}

}  // namespace innermap::tool
