#include "tools/stop_signal.h"

#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <mutex>
#include <thread>

#include "burin/base/error.h"
#include "burin/base/files/file_error.h"
#include "burin/base/files/unfinished.h"

namespace burin {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

// All signals with termination as their default. Faults are internal; SIGKILL cannot be caught.
constexpr int kWishes[] = {SIGINT,    SIGTERM, SIGHUP,  SIGQUIT, SIGUSR1, SIGUSR2,  SIGXCPU,
                           SIGVTALRM, SIGPROF, SIGPOLL, SIGPWR,  SIGALRM, SIGSTKFLT};
constexpr int kFaults[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGSYS};

// One request often arrives twice: timeout(1), some shells and terminals send it to the process and again to its group.
// A signal after this time is a second request.
constexpr milliseconds kOneWish{500};

// Removing unfinished files takes milliseconds, and so does a command's last message. The process also ends if a disk
// or a terminal does not answer.
constexpr milliseconds kLongestEnd{1500};

enum class Speaker { nobody, command, signal };

// Returns true if `speaker` gets the last word, or already has it.
bool takes(std::atomic<Speaker>& last_word, Speaker speaker) {
  Speaker before = Speaker::nobody;
  return last_word.compare_exchange_strong(before, speaker) || before == speaker;
}

// Never destroyed: a signal may come during the process's normal end.
struct Wish {
  std::atomic<int> number = 0;
  std::atomic<Speaker> last_word = Speaker::nobody;
  std::mutex mutex;  // guards `keepers`, `longest`, and the decision about a signal
  int keepers = 0;
  milliseconds longest = StopOnSignal::kAnyTime;
  int pipe[2] = {-1, -1};
  std::string command_line;
  StopWords words;
};

Wish& wish() {
  static Wish& one = *new Wish;
  return one;
}

// State of the handlers, set before their installation.
int pipe_end = -1;
std::atomic<int> code_at_the_latest = 1;
pthread_t listener;

bool is_fault(int number) { return std::find(std::begin(kFaults), std::end(kFaults), number) != std::end(kFaults); }

void hand_over(int number) {
  const char byte = static_cast<char>(number);
  // A full pipe already holds enough requests.
  if (::write(pipe_end, &byte, 1) < 0) errno = 0;
}

void on_wish(int number) {
  const int error = errno;
  hand_over(number);
  errno = error;
}

// This thread cannot continue. The listener ends the process, unless the fault is its own.
void on_fault(int number) {
  if (pthread_equal(pthread_self(), listener) != 0) ::_exit(128 + number);
  hand_over(number);
  for (int i = 0; i < 3; ++i) ::sleep(1);
  ::_exit(128 + number);
}

void end_at_the_latest(int) { ::_exit(code_at_the_latest); }

// Ends the process within kLongestEnd.
void begin_to_end(int exit_code) {
  code_at_the_latest = exit_code;
  std::signal(SIGALRM, end_at_the_latest);
  itimerval timer{};
  timer.it_value.tv_sec = kLongestEnd.count() / 1000;
  timer.it_value.tv_usec = 1000 * (kLongestEnd.count() % 1000);
  ::setitimer(ITIMER_REAL, &timer, nullptr);
}

std::string signal_words(int number) {
  switch (number) {
    case SIGINT:
      return "Ctrl-C (SIGINT)";
    case SIGQUIT:
      return "Ctrl-\\ (SIGQUIT)";
    case SIGHUP:
      return "SIGHUP (the terminal closed)";
    case SIGXCPU:
      return "SIGXCPU (the limit of processor time, ulimit -t)";
    default: {
      const char* const name = ::sigabbrev_np(number);
      return name != nullptr ? std::string("SIG") + name : "signal " + std::to_string(number);
    }
  }
}

std::string sentence_of(int number) {
  if (is_fault(number))
    return "ended by " + signal_words(number) +
           ": this is a fault in Burin or in a library that it calls, please report it with the command you gave; what "
           "is unfinished counts as nothing";
  return "stopped by " + signal_words(number) +
         " before it was done; unfinished work is void, and this continues or starts over: " + wish().command_line;
}

// Ends the process, unless it is already printing its own last message.
[[noreturn]] void end_at_once(const std::string& sentence, int code) {
  Wish& w = wish();
  begin_to_end(code);
  while (!takes(w.last_word, Speaker::signal)) ::pause();
  abandon_unfinished();
  // Flushes the output so far, unless its thread is writing to a blocked stream.
  if (::ftrylockfile(stdout) == 0) {
    std::fflush(stdout);
    ::funlockfile(stdout);
  }
  if (w.words.last) w.words.last(sentence, code);
  ::_exit(code);
}

[[noreturn]] void end_at_once(int number) { end_at_once(sentence_of(number), 128 + number); }

// Handles one more signal; `first` is the time of the first one.
void take_signal(int number, Clock::time_point& first) {
  Wish& w = wish();
  const std::lock_guard lock(w.mutex);
  if (is_fault(number)) end_at_once(number);
  if (w.number != 0) {
    if (Clock::now() - first > kOneWish) end_at_once(w.number);
    return;
  }
  first = Clock::now();
  w.number = number;
  if (w.keepers == 0 || number == SIGQUIT) end_at_once(number);
  if (w.longest == StopOnSignal::kAnyTime && w.words.heard && w.last_word == Speaker::nobody)
    w.words.heard("stopping with what there is so far; press Ctrl-C again to end at once");
}

// Milliseconds until the end of the stopped work's time limit; -1: no limit.
int time_left(Clock::time_point first) {
  Wish& w = wish();
  const std::lock_guard lock(w.mutex);
  if (w.number == 0 || w.keepers == 0 || w.longest == StopOnSignal::kAnyTime) return -1;
  const auto left = std::chrono::ceil<milliseconds>(first + w.longest - Clock::now());
  if (left.count() <= 0) end_at_once(w.number);
  return static_cast<int>(left.count());
}

void listen() {
  Clock::time_point first;
  for (;;) {
    pollfd waits{wish().pipe[0], POLLIN, 0};
    const int ready = ::poll(&waits, 1, time_left(first));
    if (ready == 0 || (ready < 0 && errno == EINTR)) continue;
    char byte = 0;
    const ssize_t got = ::read(waits.fd, &byte, 1);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return;
    take_signal(byte, first);
  }
}

// Handles an uncaught exception: of a thread, or thrown where none is allowed.
[[noreturn]] void end_uncaught() {
  const std::exception_ptr thrown = std::current_exception();
  const Wish& w = wish();
  end_at_once(w.words.uncaught ? w.words.uncaught(thrown) : "ended without a reason", 1);
}

// Respects existing handlers, except for Ctrl-C and `kill`: nohup ignores SIGHUP, and sanitizers handle faults.
void handle(int number, void (*handler)(int)) {
  struct sigaction before {};
  if (::sigaction(number, nullptr, &before) != 0) return;
  if (number != SIGINT && number != SIGTERM && before.sa_handler != SIG_DFL) return;
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  ::sigaction(number, &action, nullptr);
}

}  // namespace

void end_on_signals(const std::string& command_line, StopWords words) {
  Wish& w = wish();
  w.command_line = command_line;
  w.words = std::move(words);
  if (::pipe2(w.pipe, O_CLOEXEC) != 0) fail("signals", "no pipe can be had", "close other programs' files (ulimit -n)");
  ::fcntl(w.pipe[1], F_SETFL, O_NONBLOCK);
  pipe_end = w.pipe[1];
  try {
    std::thread thread(listen);
    listener = thread.native_handle();
    thread.detach();
  } catch (const std::system_error& error) {
    fail("threads", "the system gives none: " + error_text(error.code().value()), error_remedy(error.code().value()));
  }
  std::set_terminate(end_uncaught);
  // The failing write reports these errors.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  for (const int number : kWishes) handle(number, on_wish);
  for (int number = SIGRTMIN; number <= SIGRTMAX; ++number) handle(number, on_wish);
  for (const int number : kFaults) handle(number, on_fault);
}

int stop_exit_code() {
  const int number = wish().number;
  return number == 0 ? 0 : 128 + number;
}

std::string stop_sentence(bool kept) {
  const int number = wish().number;
  return kept ? "stopped by " + signal_words(number) + " before it was done; the files so far are kept"
              : sentence_of(number);
}

void take_last_word() {
  while (!takes(wish().last_word, Speaker::command)) ::pause();
}

void stop_if_asked() {
  if (StopOnSignal::asked()) throw Stopped{};
}

StopOnSignal::StopOnSignal(milliseconds longest) {
  const std::lock_guard lock(wish().mutex);
  longest_before_ = wish().longest;
  wish().longest = longest;
  ++wish().keepers;
}

StopOnSignal::~StopOnSignal() {
  const std::lock_guard lock(wish().mutex);
  wish().longest = longest_before_;
  --wish().keepers;
}

bool StopOnSignal::asked() { return wish().number != 0; }

}  // namespace burin
