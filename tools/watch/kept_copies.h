// tools/watch/kept_copies.h - copies of photos, made while the photos themselves may still be arriving.
//
// Nothing tells of every kind of file whether its last byte has come: a program that syncs may give a file its whole
// size first and fill it later, with pauses. So a photo is copied only once its bytes have stayed the same for a while,
// the copy is compared with it, and as long as the photo is there it is read again now and then, ever more seldom.
// Where it has changed, the copy is replaced. A file that is there already under the photo's name is replaced if it is
// a half of the photo (cut off, or zero where the photo has something else), else it stays, and the copy gets a number.
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
  /// `event` is a short name of it ("not copied"), `words` the sentence.
  using Report =
      std::function<void(const std::string& event, const std::filesystem::path& photo, const std::string& words)>;

  /// `stays`: for how long a photo's bytes must not have changed.
  KeptCopies(std::chrono::milliseconds stays, Report report);

  /// A photo that was judged just now is to be copied into that folder, instead of any other.
  void want(const std::filesystem::path& photo, const std::filesystem::path& into);

  /// The photo has another name now.
  void rename(const std::filesystem::path& from, const std::filesystem::path& to);

  /// Copies what has stayed, and reads what was copied once more if it is time. Returns photos whose bytes have changed
  /// although their size and time have not: they are to be judged anew. Reports what cannot be copied, and tries again.
  std::vector<std::filesystem::path> look();

  /// How many photos are still to be copied; of those, how many could not be when it was tried last.
  int waiting() const;
  int refused() const;

  /// Reports which photos are not copied yet, or have changed since.
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
    std::filesystem::path copy;  ///< empty: there is none yet
    std::string copied;          ///< the copy's hash
    Stamp stamp;                 ///< of the photo, when it was read last
    std::string hash;            ///< of its bytes then; empty: not read yet
    std::string complaint;       ///< why it could not be copied, as reported last
    Clock::time_point next;      ///< when it is read the next time
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

/// Whether every byte of `half` is either that of `whole` or zero (or cut off), and some are not that of `whole`: a
/// copy that was never ended. Throws Error where one cannot be read.
bool is_half_of(const std::filesystem::path& half, const std::filesystem::path& whole);

}  // namespace burin
