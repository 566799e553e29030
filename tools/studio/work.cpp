#include "tools/studio/work.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <fstream>
#include <iterator>

#include "burin/base/error.h"
#include "burin/base/files/file_error.h"
#include "burin/base/files/named_paths.h"
#include "tools/commands.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostEvents = 200, kLongestLine = 4'000'000;

// The 22nd field of /proc/PID/stat, behind the name in parentheses; empty for a process that is no more.
std::string start_of_process(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  std::string text((std::istreambuf_iterator<char>(file)), {});
  const std::size_t behind = text.rfind(')');
  if (behind == std::string::npos || text.compare(behind + 2, 1, "Z") == 0) return {};
  constexpr int kFieldsBetween = 19;
  std::size_t at = behind + 1;
  for (int i = 0; i < kFieldsBetween && at != std::string::npos; ++i) at = text.find(' ', at + 1);
  return at == std::string::npos ? std::string() : text.substr(at + 1, text.find(' ', at + 1) - at - 1);
}

struct SpawnSettings {
  SpawnSettings(const fs::path& folder, int out, int err) {
    posix_spawn_file_actions_init(&actions);
    posix_spawnattr_init(&attributes);
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, out, 1);
    posix_spawn_file_actions_adddup2(&actions, err, 2);
    posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
    posix_spawn_file_actions_addclosefrom_np(&actions, 3);  // the server's sockets
    // Ctrl-C at the server's terminal goes to the server alone, and none of its masks to the command.
    sigset_t none;
    sigemptyset(&none);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGMASK);
  }
  ~SpawnSettings() {
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
  }
  SpawnSettings(const SpawnSettings&) = delete;
  SpawnSettings& operator=(const SpawnSettings&) = delete;

  posix_spawn_file_actions_t actions{};
  posix_spawnattr_t attributes{};
};

pid_t start_program(const std::vector<std::string>& arguments, const fs::path& folder, int out, int err) {
  std::vector<std::string> words{"burin"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const SpawnSettings settings(folder, out, err);
  pid_t process = 0;
  const int error =
      ::posix_spawn(&process, "/proc/self/exe", &settings.actions, &settings.attributes, argv.data(), environ);
  if (error != 0) fail_with("burin " + arguments.front(), "the command cannot be started", error);
  return process;
}

int open_or_fail(const fs::path& file, int flags) {
  constexpr int kOwnersOnly = 0600;
  const int fd = ::open(file.c_str(), flags | O_CLOEXEC | O_NOFOLLOW, kOwnersOnly);
  if (fd < 0) fail_with(file.string(), "cannot be written", errno);
  return fd;
}

}  // namespace

std::string program_output(const std::vector<std::string>& arguments, const fs::path& folder) {
  int pipe[2];
  if (::pipe2(pipe, O_CLOEXEC) != 0) fail_with("burin " + arguments.front(), "the command cannot be started", errno);
  const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  const pid_t process = start_program(arguments, folder, pipe[1], nowhere);
  ::close(pipe[1]);
  ::close(nowhere);
  std::string text;
  std::array<char, 65536> bytes;
  ssize_t n = 0;
  while ((n = ::read(pipe[0], bytes.data(), bytes.size())) > 0 || (n < 0 && errno == EINTR))
    if (n > 0) text.append(bytes.data(), static_cast<std::size_t>(n));
  ::close(pipe[0]);
  ::waitpid(process, nullptr, 0);
  return text;
}

void StudioWork::take_up(const fs::path& folder) {
  std::error_code missing;
  const fs::path record = folder / (name_ + ".json");
  if (running_ || !fs::exists(record, missing)) return;
  try {
    const Json json = Json::parse(read_text(record));
    action_ = json.at("action").get<std::string>();
    arguments_ = json.at("command").get<std::vector<std::string>>();
    process_ = json.at("process").get<pid_t>();
    began_ = json.at("began").get<std::string>();
  } catch (const std::exception&) {  // a record that was cut off tells of no work
    return;
  }
  log_ = folder / (name_ + ".jsonl");
  read_to_ = 0;
  ours_ = false;
  stopping_ = false;
  events_ = Json::array();
  result_ = nullptr;
  running_ = true;  // until look() finds that it is not
  look();
}

void StudioWork::begin(const std::string& action, const std::vector<std::string>& arguments, const fs::path& folder) {
  if (running_) fail(action, "\"" + action_ + "\" is still at work", "wait until it is done, or stop it");
  make_output_folder(folder);
  log_ = folder / (name_ + ".jsonl");
  const int out = open_or_fail(log_, O_WRONLY | O_CREAT | O_TRUNC | O_APPEND);
  std::vector<std::string> words{"--json-lines"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  pid_t process = 0;
  try {
    process = start_program(words, folder, out, out);
  } catch (...) {
    ::close(out);
    throw;
  }
  ::close(out);
  action_ = action;
  arguments_ = arguments;
  process_ = process;
  began_ = start_of_process(process);
  ours_ = running_ = true;
  stopping_ = false;
  read_to_ = 0;
  rest_.clear();
  stage_.clear();
  fraction_ = 0;
  events_ = Json::array();
  result_ = nullptr;
  write_json({{"action", action_}, {"command", arguments_}, {"process", process_}, {"began", began_}},
             folder / (name_ + ".json"));
}

bool StudioWork::is_alive() {
  if (ours_) {
    int status = 0;
    if (::waitpid(process_, &status, WNOHANG) == 0) return true;
    ours_ = false;
    return false;
  }
  return !began_.empty() && start_of_process(process_) == began_;
}

bool StudioWork::look() {
  if (!running_) return false;
  const bool alive = is_alive();  // before the last bytes are read
  bool changed = false;
  std::ifstream file(log_, std::ios::binary);
  file.seekg(static_cast<std::streamoff>(read_to_));
  std::array<char, 65536> bytes;
  while (file.read(bytes.data(), bytes.size()) || file.gcount() > 0) {
    rest_.append(bytes.data(), static_cast<std::size_t>(file.gcount()));
    read_to_ += static_cast<std::uintmax_t>(file.gcount());
    changed = true;
    std::size_t end = 0;
    while ((end = rest_.find('\n')) != std::string::npos) {
      read_line(rest_.substr(0, end));
      rest_.erase(0, end + 1);
    }
    if (rest_.size() > kLongestLine) rest_.clear();
  }
  if (alive) return changed;
  running_ = false;
  return true;
}

void StudioWork::read_line(const std::string& line) {
  const Json json = Json::parse(line, nullptr, false);
  if (!json.is_object()) {
    if (!line.empty()) events_.push_back({{"event", "words"}, {"words", printable(line)}});
    return;
  }
  const std::string event = json.value("event", "");
  if (event == "progress") {
    stage_ = json.value("stage", "");
    fraction_ = json.value("fraction", 0.0);
  } else if (event == "result") {
    result_ = json;
    for (const char* known : {"files", "data"}) result_.erase(known);  // the project's files have them
  } else {
    constexpr std::size_t kLargest = 4000;
    events_.push_back(json);
    if (json.contains("data") && json["data"].dump().size() > kLargest) events_.back().erase("data");
    if (events_.size() > kMostEvents) events_.erase(events_.begin());
  }
}

void StudioWork::stop() {
  if (!running_ || !is_alive()) return;
  stopping_ = true;
  ::kill(process_, SIGINT);
}

Json StudioWork::json() const {
  if (action_.empty()) return nullptr;
  return {{"action", action_}, {"running", running_},   {"stopping", stopping_}, {"command", arguments_},
          {"stage", stage_},   {"fraction", fraction_}, {"events", events_},     {"result", result_}};
}

}  // namespace burin
