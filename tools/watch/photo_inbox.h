// tools/watch/photo_inbox.h - a folder that photos arrive in, looked at again and again: which are whole by now, which
// have gone, which only got another name.
//
// By looking, not by the kernel's messages: network shares and phones' syncs send none. A file counts as whole when its
// size and time have stayed between two looks, and for so long as is asked for: copies come in bursts. One that cannot
// be read then is tried again whenever it grows, and given up (for now) when it has not for kGivenUp.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace burin {

/// What a look at the folder found.
struct InboxNews {
  bool folder_there = true;
  std::string why_not;                       ///< where it is not there: what the system says
  std::vector<std::filesystem::path> whole;  ///< new, or changed since it was taken; in the order of their names
  std::vector<std::filesystem::path> gone;   ///< taken before
  std::vector<std::pair<std::filesystem::path, std::filesystem::path>> renamed;  ///< taken before: from, to
  std::vector<std::filesystem::path> given_up;  ///< put back by not_yet(), and no byte has come since
};

/// A folder being watched, with the folders within that are named after lamps (burin/capture/lamp_folders.h), which may
/// come and go. Other folders within, hidden files, and names that programs give to files in the making (.part,
/// .tmp, .icloud, ...) are passed over.
class PhotoInbox {
 public:
  static constexpr std::chrono::seconds kGivenUp{5};

  /// `stays`: how long size and time must not have changed.
  explicit PhotoInbox(std::filesystem::path folder, std::vector<std::string> lamps = {},
                      std::chrono::milliseconds stays = {});

  const std::filesystem::path& folder() const { return folder_; }

  /// Looks once. What is whole counts as taken from then on. At the first look every file counts as unchanged since
  /// long ago.
  InboxNews look();

  /// A photo that was given out could not be read: it may not be whole after all.
  void not_yet(const std::filesystem::path& file);

  /// How many files and folders were passed over at the last look that hold no photo by their first bytes.
  int passed_over() const { return passed_over_; }

  /// Whether a file is on its way: seen, and not yet whole or given up.
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
