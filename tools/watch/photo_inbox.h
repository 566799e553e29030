// tools/watch/photo_inbox.h - polls a folder for photos and reports complete, removed and renamed ones.
//
// Polling replaces the kernel's notifications, which network shares and phone synchronization do not send. A file
// counts as complete when its size and time are equal in two looks and stay constant for the requested time, since
// copies come in bursts. An unreadable file is tried again whenever it grows. It is given up, for the present, after
// kGivenUp without growth.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace burin {

/// Result of one look at the folder.
struct InboxNews {
  bool folder_there = true;
  std::string why_not;                       ///< the system's error for a missing folder
  std::vector<std::filesystem::path> whole;  ///< new, or changed after it was taken; in the order of their names
  std::vector<std::filesystem::path> gone;   ///< taken before
  std::vector<std::pair<std::filesystem::path, std::filesystem::path>> renamed;  ///< taken before: from, to
  std::vector<std::filesystem::path> given_up;  ///< returned by not_yet(), without growth afterwards
};

/// A watched folder with its subfolders of lamps (burin/capture/lamp_folders.h), which may appear and disappear. It
/// skips other subfolders, hidden files, and temporary names (.part, .tmp, .icloud, ...).
class PhotoInbox {
 public:
  static constexpr std::chrono::seconds kGivenUp{5};

  /// `stays`: time for which size and time of change must be constant.
  explicit PhotoInbox(std::filesystem::path folder, std::vector<std::string> lamps = {},
                      std::chrono::milliseconds stays = {});

  const std::filesystem::path& folder() const { return folder_; }

  /// Looks once. Complete files count as taken afterwards. The first look treats every file as unchanged for a long
  /// time.
  InboxNews look();

  /// Returns an unreadable photo, which may be incomplete.
  void not_yet(const std::filesystem::path& file);

  /// Number of files and folders skipped at the latest look whose first bytes are no photo's.
  int passed_over() const { return passed_over_; }

  /// Returns true while a seen file is neither complete nor given up.
  bool expects() const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Entry {
    std::uintmax_t size = 0;
    std::filesystem::file_time_type time;
    std::uint64_t inode = 0;
    enum class State { growing, taken, doubted, given_up } state = State::growing;
    Clock::time_point since;
    bool operator==(const Entry& other) const {
      return size == other.size && time == other.time && inode == other.inode;
    }
  };

  std::filesystem::path folder_;
  std::vector<std::string> lamps_;
  std::chrono::milliseconds stays_;
  std::map<std::filesystem::path, Entry> entries_;
  bool looked_ = false;
  int passed_over_ = 0;
};

}  // namespace burin
