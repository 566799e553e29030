#include "tools/stop_signal.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <mutex>
#include <thread>

#include "burin/render/error.h"
#include "burin/render/files/unfinished.h"

namespace burin {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP};

// One wish to stop often arrives twice: timeout(1), some shells and terminals send it to the process and again to its
// group. Whoever asks once more after this time means it.
constexpr auto kOneWish = std::chrono::milliseconds(500);

// Removing what is unfinished takes milliseconds, and so do a command's last words; on a disk or a terminal that does
// not answer the process ends all the same.
constexpr auto kLongestEnd = std::chrono::seconds(3);

enum class Speaker { nobody, command, signal };

// Whether `speaker` has the last word: nobody had it, or it itself.
bool takes(std::atomic<Speaker>& last_word, Speaker speaker) {
  Speaker before = Speaker::nobody;
  return last_word.compare_exchange_strong(before, speaker) || before == speaker;
}

// Never destroyed: a signal may come while the process ends by itself.
struct Wish {
  std::atomic<int> number = 0;
  std::atomic<Speaker> last_word = Speaker::nobody;
  std::mutex mutex;  // of `keepers`, and of who decides what a signal does
  int keepers = 0;
  int pipe[2] = {-1, -1};
  std::string command_line;
  std::function<void(const std::string&, int)> say;
};

Wish& wish() {
  static Wish& one = *new Wish;
  return one;
}

int pipe_end = -1;  // what the handler writes to; set before there is a handler

void on_signal(int number) {
  const int error = errno;
  const char byte = static_cast<char>(number);
  // A full pipe holds wishes enough.
  if (::write(pipe_end, &byte, 1) < 0) errno = 0;
  errno = error;
}

const char* words_of(int number) {
  switch (number) {
    case SIGINT:
      return "Ctrl-C (SIGINT)";
    case SIGTERM:
      return "SIGTERM";
    default:
      return "SIGHUP (the terminal closed)";
  }
}

[[noreturn]] void end_at_once() {
  Wish& w = wish();
  const int code = stop_exit_code();
  if (!takes(w.last_word, Speaker::signal)) {  // it has ended by itself, and is just saying so
    std::this_thread::sleep_for(kLongestEnd);
    ::_exit(code);
  }
  std::thread([code] {
    std::this_thread::sleep_for(kLongestEnd);
    ::_exit(code);
  }).detach();
  abandon_unfinished();
  // What was said so far, unless its thread is in the midst of a line that nobody reads.
  if (::ftrylockfile(stdout) == 0) {
    std::fflush(stdout);
    ::funlockfile(stdout);
  }
  if (w.say) w.say(stop_sentence(), code);
  ::_exit(code);
}

void listen() {
  Wish& w = wish();
  Clock::time_point first;
  for (;;) {
    char byte = 0;
    const ssize_t got = ::read(w.pipe[0], &byte, 1);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return;
    const std::lock_guard lock(w.mutex);
    if (w.number == 0) {
      first = Clock::now();
      w.number = byte;
      if (w.keepers == 0) end_at_once();
    } else if (Clock::now() - first > kOneWish) {
      end_at_once();
    }
  }
}

}  // namespace

void end_on_signals(const std::string& command_line, std::function<void(const std::string&, int)> say) {
  Wish& w = wish();
  w.command_line = command_line;
  w.say = std::move(say);
  if (::pipe2(w.pipe, O_CLOEXEC) != 0) fail("signals", "no pipe can be had", "close other programs' files (ulimit -n)");
  ::fcntl(w.pipe[1], F_SETFL, O_NONBLOCK);
  pipe_end = w.pipe[1];
  std::thread(listen).detach();
  for (const int number : kSignals) {
    struct sigaction before {};
    struct sigaction action {};
    action.sa_handler = on_signal;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    if (number == SIGHUP && ::sigaction(number, nullptr, &before) == 0 && before.sa_handler == SIG_IGN) continue;
    ::sigaction(number, &action, nullptr);
  }
}

int stop_exit_code() {
  const int number = wish().number;
  return number == 0 ? 0 : 128 + number;
}

std::string stop_sentence() {
  return std::string("stopped by ") + words_of(wish().number) +
         " before it was done; what is unfinished counts as nothing, and this goes on or begins anew: " +
         wish().command_line;
}

void take_last_word() {
  while (!takes(wish().last_word, Speaker::command)) ::pause();
}

void stop_if_asked() {
  if (StopOnSignal::asked()) throw Stopped{};
}

StopOnSignal::StopOnSignal() {
  const std::lock_guard lock(wish().mutex);
  ++wish().keepers;
}

StopOnSignal::~StopOnSignal() {
  const std::lock_guard lock(wish().mutex);
  --wish().keepers;
}

bool StopOnSignal::asked() { return wish().number != 0; }

}  // namespace burin
