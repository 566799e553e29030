#include "tools/stop_signal.h"

#include <csignal>

namespace burin {
namespace {

constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP};

volatile std::sig_atomic_t asked_to_stop = 0;

void on_signal(int number) {
  asked_to_stop = 1;
  std::signal(number, SIG_DFL);
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
