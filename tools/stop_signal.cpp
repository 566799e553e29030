#include "tools/stop_signal.h"

#include <csignal>
#include <ctime>

namespace burin {
namespace {

constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP};

// One wish to stop often arrives twice: timeout(1), some shells and terminals send it to the process and again to its
// group. Whoever asks once more after this time means it, and ends the program at once.
constexpr double kOneWish_s = 0.5;

volatile std::sig_atomic_t asked_to_stop = 0;
timespec asked_at;  // written before asked_to_stop, read after it

void on_signal(int number) {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  if (asked_to_stop == 0) {
    asked_at = now;
    asked_to_stop = 1;
  } else if (static_cast<double>(now.tv_sec - asked_at.tv_sec) +
                 1e-9 * static_cast<double>(now.tv_nsec - asked_at.tv_nsec) >
             kOneWish_s) {
    std::signal(number, SIG_DFL);
    std::raise(number);
  }
}

}  // namespace

StopOnSignal::StopOnSignal() {
  asked_to_stop = 0;
  for (int i = 0; i < 3; ++i) {
    before_[i] = std::signal(kSignals[i], on_signal);
    if (kSignals[i] == SIGHUP && before_[i] == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
  }
}

StopOnSignal::~StopOnSignal() {
  for (int i = 0; i < 3; ++i) std::signal(kSignals[i], before_[i]);
}

bool StopOnSignal::asked() { return asked_to_stop != 0; }

}  // namespace burin
