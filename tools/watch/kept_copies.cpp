#include "tools/watch/kept_copies.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/files/json_file.h"
#include "burin/base/files/write_file.h"
#include "tools/content_hash.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kLongestWait = std::chrono::minutes(5);

// "IMG_1.jpg", "IMG_1-2.jpg", "IMG_1-3.jpg"
fs::path numbered(const fs::path& name, int number) {
  if (number == 1) return name;
  return name.stem().native() + "-" + std::to_string(number) + name.extension().native();
}

std::int64_t in_ns(const timespec& time) { return std::int64_t{1'000'000'000} * time.tv_sec + time.tv_nsec; }

}  // namespace

bool is_half_of(const fs::path& half, const fs::path& whole) {
  std::ifstream a(half, std::ios::binary), b(whole, std::ios::binary);
  if (!a || !b) fail((a ? whole : half).string(), "cannot be read", "give yourself the right to read it");
  constexpr std::size_t kBlock = 4096;
  std::array<char, kBlock> in_a{}, in_b{};
  bool differs = false;
  for (;;) {
    a.read(in_a.data(), kBlock);
    b.read(in_b.data(), kBlock);
    const auto size_a = a.gcount(), size_b = b.gcount();
    if (size_a > size_b) return false;
    differs = differs || size_a < size_b;
    if (size_a == 0) return differs;
    for (std::streamsize i = 0; i < size_a; ++i) {
      if (in_a[i] == in_b[i]) continue;
      if (in_a[i] != 0) return false;
      differs = true;
    }
  }
}

KeptCopies::KeptCopies(std::chrono::milliseconds stays, Report report) : stays_(stays), report_(std::move(report)) {}

bool KeptCopies::stamp_of(const fs::path& photo, Stamp& stamp) {
  struct stat status {};
  if (::stat(photo.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return false;
  stamp = {static_cast<std::uintmax_t>(status.st_size), status.st_ino, in_ns(status.st_mtim), in_ns(status.st_ctim)};
  return true;
}

void KeptCopies::want(const fs::path& photo, const fs::path& into) {
  Kept& kept = kept_[photo];
  kept.into = into;
  kept.hash.clear();
  kept.waits = true;
  kept.next = Clock::now();
}

void KeptCopies::rename(const fs::path& from, const fs::path& to) {
  auto one = kept_.extract(from);
  if (one.empty()) return;
  stamp_of(to, one.mapped().stamp);  // a rename changes it
  one.key() = to;
  kept_.insert(std::move(one));
}

std::vector<fs::path> KeptCopies::look() {
  std::vector<fs::path> changed, gone;
  for (auto& [photo, kept] : kept_) {
    const Clock::time_point now = Clock::now();
    if (now < kept.next) continue;
    Stamp stamp;
    if (!stamp_of(photo, stamp)) {
      gone.push_back(photo);
      continue;
    }
    std::string hash;
    try {
      hash = content_hash(photo);
    } catch (const Error&) {  // the file is being replaced, or its disk is absent: the next look decides
    }
    const bool same = !hash.empty() && hash == kept.hash;
    const bool seen = stamp.size != kept.stamp.size || stamp.changed_ns != kept.stamp.changed_ns;
    if (!same && !kept.hash.empty() && !hash.empty() && !seen) changed.push_back(photo);
    const bool again = kept.waits && same && stamp == kept.stamp;
    if (same || kept.waits) {
      kept.stamp = stamp;
      kept.hash = hash;
    }
    if (kept.waits) {
      if (again && copy_now(photo, kept)) kept.waits = false;
      kept.wait = stays_;
    } else {
      kept.wait = std::min(2 * kept.wait, kLongestWait);
    }
    kept.next = Clock::now() + kept.wait;
  }
  for (const fs::path& photo : gone) {
    if (kept_[photo].waits)
      report_("not copied", photo, "    not copied: it was gone before its bytes had stayed the same");
    kept_.erase(photo);
  }
  return changed;
}

// Returns true if all is done; otherwise look() retries.
bool KeptCopies::copy_now(const fs::path& photo, Kept& kept) {
  try {
    const fs::path former = kept.copy;
    const std::string former_hash = kept.copied;
    for (int number = 1;; ++number) {
      const fs::path to = kept.into / numbered(photo.filename(), number);
      std::error_code error;
      if (!fs::exists(fs::symlink_status(to, error))) {
        if (number > 1)
          report_("copied", photo,
                  "    copied as " + to.filename().string() + ": " + (kept.into / photo.filename()).string() +
                      " is there already, and is another photo");
        put_copy(photo, to, kept);
        break;
      }
      const std::string there = content_hash(to);
      if (there == kept.hash) {
        kept.copy = to;
        kept.copied = there;
        break;
      }
      if ((to == former && there == former_hash) || is_half_of(to, photo)) {
        report_("copied", photo, "    copied again: " + to.string() + " was a copy of it before all of it was there");
        put_copy(photo, to, kept);
        break;
      }
      if (is_half_of(photo, to)) {
        report_("not copied", photo, "    not copied: " + to.string() + " is there already, and this is a half of it");
        return true;
      }
    }
    if (kept.copied != kept.hash) {  // changed during the copy
      kept.hash.clear();
      return false;
    }
    if (!former.empty() && former.parent_path() != kept.copy.parent_path()) remove_former(photo, former, former_hash);
    kept.complaint.clear();
    return true;
  } catch (const Error& error) {
    if (kept.complaint != error.what())
      report_("not copied", photo, std::string("    not copied yet: ") + error.what());
    kept.complaint = error.what();
    return false;
  }
}

void KeptCopies::put_copy(const fs::path& photo, const fs::path& to, Kept& kept) {
  make_output_folder(kept.into);
  copy_whole(photo, to);
  kept.copy = to;
  kept.copied = content_hash(to);
}

// Removes the copy made when the photo belonged to another lamp.
void KeptCopies::remove_former(const fs::path& photo, const fs::path& former, const std::string& hash) {
  std::error_code error;
  if (!fs::is_regular_file(former, error) || content_hash(former) != hash) return;
  remove_file(former);
  report_("copied", photo, "    its copy was " + former.string() + " before, which is removed");
}

int KeptCopies::waiting() const {
  return static_cast<int>(std::count_if(kept_.begin(), kept_.end(), [](const auto& one) { return one.second.waits; }));
}

int KeptCopies::refused() const {
  return static_cast<int>(std::count_if(
      kept_.begin(), kept_.end(), [](const auto& one) { return one.second.waits && !one.second.complaint.empty(); }));
}

void KeptCopies::report_rest() const {
  for (const auto& [photo, kept] : kept_) {
    Stamp stamp;
    if (!stamp_of(photo, stamp)) continue;
    if (kept.waits)
      report_(
          "not copied", photo,
          photo.filename().string() + ": " +
              (kept.copy.empty() ? "is not copied yet" : "has changed since it was copied to " + kept.copy.string()) +
              "; the same command goes on");
    else if (!kept.copy.empty() && (stamp.size != kept.stamp.size || stamp.changed_ns != kept.stamp.changed_ns))
      report_("not copied", photo,
              photo.filename().string() + ": has changed since it was copied to " + kept.copy.string() +
                  "; the same command goes on");
  }
}

}  // namespace burin
