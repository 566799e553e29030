// tools/studio/work.h - one long command of the studio: a process of this same program, with its output in a file.
//
// The process has a session of its own and writes its lines (docs/json.md) into a file. A server that ends, or is
// killed, therefore takes no work with it, and the next server reads the same file further.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "burin/base/files/json_file.h"

namespace burin {

/// Runs this program to its end and returns its standard output. Standard error is discarded.
std::string program_output(const std::vector<std::string>& arguments, const std::filesystem::path& folder);

/// One command at a time, its progress and its result. Not thread-safe.
class StudioWork {
 public:
  /// `name`: of the files NAME.json and NAME.jsonl in the working folder.
  explicit StudioWork(std::string name) : name_(std::move(name)) {}

  /// Takes up the command that an earlier server began in `folder`, if there is one.
  void take_up(const std::filesystem::path& folder);

  /// Begins `burin --json-lines ARGUMENTS` with its record in `folder`. Throws Error if one is running.
  void begin(const std::string& action, const std::vector<std::string>& arguments, const std::filesystem::path& folder);

  /// Reads new output. Returns true if anything changed.
  bool look();

  /// Asks the command to end with its result kept (Ctrl-C).
  void stop();

  bool is_running() const { return running_; }
  const std::string& action() const { return action_; }

  /// { action, running, stopping, command, stage, fraction, events, result }
  Json json() const;

 private:
  void read_line(const std::string& line);
  bool is_alive();

  std::string name_, action_;
  std::vector<std::string> arguments_;
  std::filesystem::path log_;
  pid_t process_ = 0;
  std::string began_;  // the process's start time in the kernel's words: a number may be given again
  bool ours_ = false, running_ = false, stopping_ = false;
  std::uintmax_t read_to_ = 0;
  std::string stage_, rest_;
  double fraction_ = 0;
  Json events_ = Json::array(), result_;
};

}  // namespace burin
