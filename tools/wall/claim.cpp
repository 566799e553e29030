#include "tools/wall/claim.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <fstream>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/files/descriptor.h"
#include "burin/base/files/file_error.h"
#include "burin/base/files/json_file.h"
#include "burin/base/files/unfinished.h"
#include "burin/base/threads.h"
#include "tools/local_time.h"
#include "tools/output_mode.h"
#include "tools/stop_signal.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::seconds kBeat(5);
constexpr std::size_t kClaimBytes = 1024;  // fixed, so that each write replaces the whole text

constexpr std::array<std::pair<ClaimState, const char*>, 4> kClaimStates{{{ClaimState::working, "working"},
                                                                          {ClaimState::done, "done"},
                                                                          {ClaimState::stopped, "stopped"},
                                                                          {ClaimState::failed, "failed"}}};

fs::path claim_file(const fs::path& claims, const std::string& board, int number) {
  return claims / fmt::format("{}.{}.json", board, number);
}

std::string host_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

// The running system and its process numbers: two containers of one host differ, and so do two runs of a computer.
std::string machine_name() {
  std::string boot;
  std::ifstream("/proc/sys/kernel/random/boot_id") >> boot;
  std::error_code ignored;
  return boot + " " + fs::read_symlink("/proc/self/ns/pid", ignored).string();
}

std::string claim_bytes(const ClaimText& text) {
  Json json{
      {"format", "burin/wall-claim"},  {"version", 1},        {"board", text.board},     {"stage", text.stage},
      {"state", in_words(text.state)}, {"host", text.host},   {"process", text.process}, {"machine", text.machine},
      {"threads", text.threads},       {"began", text.began}, {"pulse", text.pulse},     {"words", text.words}};
  std::string bytes = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  if (bytes.size() >= kClaimBytes) {
    json["words"] =
        text.words.substr(0, text.words.size() - std::min(text.words.size(), bytes.size() - kClaimBytes + 64));
    bytes = json.dump(-1, ' ', true, Json::error_handler_t::replace).substr(0, kClaimBytes - 1);
  }
  bytes.resize(kClaimBytes - 1, ' ');
  return bytes + "\n";
}

// Nothing for a file that is only just made.
std::optional<ClaimText> claim_text(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string bytes(kClaimBytes, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(kClaimBytes));
  bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, in.gcount())));
  const Json json = Json::parse(bytes, nullptr, false);
  if (!json.is_object()) return std::nullopt;
  const auto word = [&](const char* key) {
    return json.contains(key) && json[key].is_string() ? json[key].get<std::string>() : std::string();
  };
  const auto number = [&](const char* key) {
    return json.contains(key) && json[key].is_number_integer() ? json[key].get<long>() : 0L;
  };
  ClaimText text;
  text.board = word("board");
  text.stage = word("stage");
  text.host = word("host");
  text.machine = word("machine");
  text.process = static_cast<int>(number("process"));
  text.began = word("began");
  text.threads = word("threads");
  text.pulse = number("pulse");
  text.words = word("words");
  for (const auto& [state, name] : kClaimStates)
    if (word("state") == name) text.state = state;
  return text;
}

}  // namespace

const char* in_words(ClaimState state) {
  for (const auto& [value, name] : kClaimStates)
    if (value == state) return name;
  return "";
}

std::map<std::string, LatestClaim> read_claims(const fs::path& claims) {
  std::map<std::string, LatestClaim> latest;
  std::error_code error;
  for (fs::directory_iterator entry(claims, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();  // BOARD.N.json
    if (!name.ends_with(".json")) continue;
    const std::string stem = name.substr(0, name.size() - 5);
    const std::size_t dot = stem.rfind('.');
    int number = 0;
    if (dot == std::string::npos ||
        std::from_chars(stem.data() + dot + 1, stem.data() + stem.size(), number).ptr != stem.data() + stem.size())
      continue;
    LatestClaim& claim = latest[stem.substr(0, dot)];
    claim.number = std::max(claim.number, number);
  }
  for (auto& [board, claim] : latest) claim.text = claim_text(claim_file(claims, board, claim.number));
  return latest;
}

bool has_ended_here(const ClaimText& text) {
  return text.process > 0 && text.machine == machine_name() && ::kill(text.process, 0) != 0 && errno == ESRCH;
}

bool Heartbeats::is_dead(const std::string& board, const LatestClaim& claim, std::chrono::seconds stale) {
  if (claim.text && has_ended_here(*claim.text)) return true;
  const auto now = std::chrono::steady_clock::now();
  const long pulse = claim.text ? claim.text->pulse : -1;
  Seen& seen = seen_[board];
  if (seen.number != claim.number || seen.pulse != pulse) seen = {claim.number, pulse, now};
  return now - seen.since > stale;
}

std::unique_ptr<Claim> Claim::make(const fs::path& claims, const std::string& board, const std::string& stage,
                                   int number) {
  make_output_folder(claims);
  const fs::path file = claim_file(claims, board, number);
  Descriptor made(::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0666));
  if (!made && errno == EEXIST) return nullptr;
  if (!made) fail_with(file, "cannot be made, and without it two workers would do the same", errno);
  ClaimText text;
  text.board = board;
  text.stage = stage;
  text.host = host_name();
  text.machine = machine_name();
  text.process = ::getpid();
  text.began = local_time("%Y-%m-%d %H:%M:%S");
  text.threads = std::to_string(thread_count());
  return std::unique_ptr<Claim>(new Claim(claims, number, made.release(), std::move(text)));
}

Claim::Claim(fs::path claims, int number, int file, ClaimText text)
    : claims_(std::move(claims)), number_(number), file_(file), text_(std::move(text)) {
  write();
  heart_ = std::thread([this] { beat(); });
}

// Reports nothing: a claim that cannot be written looks dead to others, and they take it over.
void Claim::write() {
  const std::string bytes = claim_bytes(text_);
  const ssize_t written = ::pwrite(file_, bytes.data(), bytes.size(), 0);
  if (written == static_cast<ssize_t>(bytes.size())) ::fsync(file_);
}

void Claim::beat() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (!ended_.wait_for(lock, kBeat, [this] { return is_ended_; })) {
    ++text_.pulse;
    write();
    struct stat unused {};
    const bool is_taken_over = ::stat(claim_file(claims_, text_.board, number_ + 1).c_str(), &unused) == 0;
    const bool is_gone = ::stat(claim_file(claims_, text_.board, number_).c_str(), &unused) != 0 && errno == ENOENT;
    if (!is_taken_over && !is_gone) continue;
    abandon_unfinished();
    say_at_the_end(fmt::format("burin wall work: board {}: {}. Fix: start this worker again", text_.board,
                               is_taken_over ? "this worker was silent for so long that another took over"
                                             : "the claim of this worker was removed"),
                   1);
    std::_Exit(1);
  }
}

void Claim::end(ClaimState state, const std::string& words) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (is_ended_) return;
    is_ended_ = true;
    text_.state = state;
    text_.words = words;
    write();
  }
  ended_.notify_all();
  if (heart_.joinable()) heart_.join();
  ::close(file_);
}

Claim::~Claim() { end(ClaimState::stopped); }

}  // namespace burin
