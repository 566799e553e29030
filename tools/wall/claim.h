// tools/wall/claim.h - who works on which board: WALL/claims/BOARD.N.json (docs/file-formats.md). Several processes on
// several computers with one shared folder work on a wall; no daemon and no lock of the file system is needed.
//
// The N-th claim of a board is a file that its worker makes exclusively (O_EXCL, which NFS keeps). Only this worker
// writes to it afterwards: a heartbeat, and the end. A board is free if its latest claim has ended. A claim whose
// heartbeat stops is taken over by making the next one, which only one worker can do. Nobody removes a file.
//
// Clocks are never compared: an observer measures with its own clock for how long a heartbeat has not changed. On the
// same computer, the process itself is looked up.
//
// A worker that finds a later claim than its own was believed dead (a share that stalled, a computer that slept). Its
// process ends at once, so that no two work on one board.
#pragma once

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace burin {

/// How a claim stands.
enum class ClaimState {
  working,
  done,
  stopped,  ///< ended by a signal; the board is free
  failed    ///< the work ended with an error or a question
};

const char* in_words(ClaimState state);

/// Content of a claim's file.
struct ClaimText {
  std::string board, stage;   ///< "preview", "settle" or "board"
  std::string host, machine;  ///< `machine` identifies the running system, in which process numbers are unique
  int process = 0;
  std::string began;    ///< local time, for people
  std::string threads;  ///< permitted to the worker
  long pulse = 0;       ///< heartbeat
  ClaimState state = ClaimState::working;
  std::string words;  ///< of a failure
};

/// The latest claim of a board.
struct LatestClaim {
  int number = 0;                 ///< 0: none
  std::optional<ClaimText> text;  ///< nothing while its first bytes are missing
};

/// Reads the claims of all boards, by board.
std::map<std::string, LatestClaim> read_claims(const std::filesystem::path& claims);

/// True if a claim's process runs on this very system and has ended.
bool has_ended_here(const ClaimText& text);

/// Heartbeats as seen by this process.
class Heartbeats {
 public:
  /// Returns true if the claim's worker is dead: its process on this system has ended, or its heartbeat did not change
  /// for `stale` of this process's own time.
  bool is_dead(const std::string& board, const LatestClaim& claim, std::chrono::seconds stale);

 private:
  struct Seen {
    int number = 0;
    long pulse = 0;
    std::chrono::steady_clock::time_point since;
  };
  std::map<std::string, Seen> seen_;
};

/// A claim of this process, from its making to its end.
class Claim {
 public:
  /// Claims a board by the number behind its latest claim. Returns nothing if another worker was faster. Throws Error
  /// for a folder that cannot be written.
  static std::unique_ptr<Claim> make(const std::filesystem::path& claims, const std::string& board,
                                     const std::string& stage, int number);
  ~Claim();
  Claim(const Claim&) = delete;
  Claim& operator=(const Claim&) = delete;

  /// Ends it. Without a call, the destructor ends it as stopped.
  void end(ClaimState state, const std::string& words = "");

 private:
  Claim(std::filesystem::path claims, int number, int file, ClaimText text);
  void beat();
  void write();

  std::filesystem::path claims_;
  int number_, file_;
  ClaimText text_;
  std::mutex mutex_;
  std::condition_variable ended_;
  bool is_ended_ = false;
  std::thread heart_;
};

}  // namespace burin
