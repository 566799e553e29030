// tools/watch/kept_copies.h - copies of photos while these may still be arriving.
//
// No general test shows that a file is complete. A synchronization program may give a file its full size first and fill
// it later, with pauses. A photo is therefore copied only after its bytes stayed constant for a while. The copy is
// compared with the photo, and the photo is read again at growing intervals. A changed photo replaces its copy. An
// existing file of the photo's name is replaced if it is an incomplete copy: truncated, or zero at differing bytes.
// Otherwise it stays, and the copy gets a number.
#pragma once

#include <sys/stat.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace burin {

class KeptCopies {
 public:
  /// Receives a short name of the `event` ("not copied") and a sentence in `words`.
  using Report =
      std::function<void(const std::string& event, const std::filesystem::path& photo, const std::string& words)>;

  /// `stays`: time without change before a photo is copied.
  KeptCopies(std::chrono::milliseconds stays, Report report);

  /// Schedules a judged photo for a copy into that folder, instead of any earlier one.
  void want(const std::filesystem::path& photo, const std::filesystem::path& into);

  /// Records the new name of a photo.
  void rename(const std::filesystem::path& from, const std::filesystem::path& to);

  /// Copies photos without recent change, and reads copied photos again when due. Returns photos with changed bytes but
  /// unchanged size and time, for a new judgment. Reports failed copies and retries them.
  std::vector<std::filesystem::path> look();

  /// Number of photos without a copy, and the number of these whose latest attempt failed.
  int waiting() const;
  int refused() const;

  /// Reports photos without a copy, and photos that changed after it.
  void report_rest() const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Stamp {
    std::uintmax_t size = 0, inode = 0;
    std::int64_t changed_ns = 0, status_changed_ns = 0;
    bool operator==(const Stamp&) const = default;
  };
  struct Kept {
    std::filesystem::path into;
    std::filesystem::path copy;  ///< empty: no copy yet
    std::string copied;          ///< hash of the copy
    Stamp stamp;                 ///< of the photo at the latest reading
    std::string hash;            ///< of its bytes at that time; empty: not read yet
    std::string complaint;       ///< latest reported reason for a failed copy
    Clock::time_point next;      ///< time of the next reading
    std::chrono::milliseconds wait{0};
    bool waits = true;
  };

  static bool stamp_of(const std::filesystem::path& photo, Stamp& stamp);
  bool copy_now(const std::filesystem::path& photo, Kept& kept);
  void put_copy(const std::filesystem::path& photo, const std::filesystem::path& to, Kept& kept);
  void remove_former(const std::filesystem::path& photo, const std::filesystem::path& former, const std::string& hash);

  std::chrono::milliseconds stays_;
  Report report_;
  std::map<std::filesystem::path, Kept> kept_;
};

/// Returns true if `half` is an incomplete copy of `whole`: truncated, or zero at every differing byte, and not
/// identical. Throws Error for an unreadable file.
bool is_half_of(const std::filesystem::path& half, const std::filesystem::path& whole);

}  // namespace burin
