#include "burin/base/files/part_file.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "burin/base/error.h"
#include "burin/base/files/descriptor.h"
#include "burin/base/files/file_error.h"
#include "burin/base/files/named_paths.h"
#include "burin/base/files/unfinished.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMark = ".part-";
constexpr std::size_t kLongestName = 255;  // bytes, on every writable file system of Linux

// Part files in progress in this process. Process numbers repeat (in a container, nearly always the same one): an
// unlisted part file with this process's number belongs to a dead process.
struct Ours {
  std::mutex mutex;
  std::set<std::string> parts, cleared_folders;
};

Ours& ours() {
  static Ours all;
  return all;
}

// The first bytes of a text, cut between characters.
std::string_view cut(std::string_view text, std::size_t most) {
  if (text.size() <= most) return text;
  while (most > 0 && (static_cast<unsigned char>(text[most]) & 0xC0) == 0x80) --most;
  return text.substr(0, most);
}

// A part file during writing: the destructor closes and removes it, unless it was ended.
class Writing {
 public:
  explicit Writing(const FilePlace& place, mode_t mode_if_new = 0666) : place_(place) {
    const mode_t mode = place.there ? place.mode : mode_if_new;
    const auto named_and_opened = making();
    do {
      if (!part_.empty()) forget_part(part_);  // a dead process with this number left this name
      part_ = new_part_name(place);
      file_ = Descriptor(::open(part_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode));
    } while (!file_ && errno == EEXIST);
    if (!file_) {
      const int error = errno;
      forget_part(part_);
      fail_with(place.named, "cannot be written", error);
    }
  }
  ~Writing() {
    if (!ended_) remove_part(part_);
  }
  Writing(const Writing&) = delete;
  Writing& operator=(const Writing&) = delete;

  void write(std::string_view bytes) {
    if (const int error = write_all(file_.number(), bytes))
      fail_with(place_.named, "could not be written whole", error);
  }

  fs::path end(bool durable) {
    if (place_.there) {
      // The new file keeps its owner if another user edits it. If the system forbids it, the editor becomes the owner.
      struct stat now {};
      if (::fstat(file_.number(), &now) == 0 && (now.st_uid != place_.user || now.st_gid != place_.group) &&
          ::fchown(file_.number(), place_.user, place_.group) != 0 &&
          ::fchown(file_.number(), static_cast<uid_t>(-1), place_.group) != 0)
        errno = 0;
      if (::fchmod(file_.number(), place_.mode) != 0 && errno != EPERM && errno != ENOTSUP)
        fail_with(place_.named, "cannot keep its permissions", errno);
    }
    // EINVAL: a file system without fsync.
    if (durable && ::fsync(file_.number()) != 0 && errno != EINVAL)
      fail_with(place_.named, "could not be written whole", errno);
    if (const int error = file_.close()) fail_with(place_.named, "could not be written whole", error);
    ended_ = true;
    return part_;
  }

 private:
  const FilePlace& place_;
  fs::path part_;
  Descriptor file_;
  bool ended_ = false;
};

// The process number in ".bench.part-4711-0.json"; 0 for any other name.
int process_of(std::string_view name) {
  const std::size_t at = name.rfind(kMark);
  if (name.empty() || name.front() != '.' || at == std::string_view::npos) return 0;
  std::size_t i = at + kMark.size();
  const auto digits = [&] {
    const std::size_t from = i;
    while (i < name.size() && name[i] >= '0' && name[i] <= '9') ++i;
    return i > from && i - from < 10;
  };
  const std::size_t number = i;
  if (!digits() || i == name.size() || name[i] != '-') return 0;
  ++i;
  if (!digits() || (i < name.size() && name[i] != '.')) return 0;
  return std::atoi(name.data() + number);
}

bool is_left_over(const fs::path& file) {
  const int process = process_of(file.filename().native());
  if (process <= 0) return false;
  if (process == ::getpid()) {
    const std::lock_guard<std::mutex> guard(ours().mutex);
    return !ours().parts.contains(file.filename().native());
  }
  return ::kill(process, 0) != 0 && errno == ESRCH;
}

// The target of a name after its symbolic links.
FilePlace place_behind_links(const fs::path& named) {
  FilePlace place;
  place.named = place.file = named;
  constexpr int kMostLinks = 40;  // the system's own limit
  struct stat found {};
  for (int links = 0;; ++links) {
    if (::lstat(place.file.c_str(), &found) != 0) {
      if (errno != ENOENT) fail_with(named, "cannot be written", errno);
      std::error_code unknown;
      if (!fs::is_directory(place.folder(), unknown))
        fail(named.string(), "cannot be written: there is no folder " + place.folder().string(),
             "choose a folder that exists and that you may write to");
      return place;
    }
    if (!S_ISLNK(found.st_mode)) break;
    if (links == kMostLinks) fail_with(named, "cannot be written", ELOOP);
    std::error_code error;
    const fs::path to = fs::read_symlink(place.file, error);
    if (error) fail_with(named, "cannot be written", error.value());
    place.file = place.file.parent_path() / to;  // `/` keeps an absolute path unchanged
  }
  if (S_ISDIR(found.st_mode)) fail(named.string(), "is a folder", "name a file");
  if (!S_ISREG(found.st_mode))
    fail(named.string(), "is a device, a FIFO or a socket: nothing is written over it", "name a file");
  if (::access(place.file.c_str(), W_OK) != 0)
    fail(named.string(), "is there already and write-protected: " + error_text(errno),
         "name another file, or take the protection away (chmod u+w)");
  place.there = true;
  place.mode = found.st_mode & 07777;
  place.user = found.st_uid;
  place.group = found.st_gid;
  return place;
}

}  // namespace

fs::path FilePlace::folder() const { return file.has_parent_path() ? file.parent_path() : fs::path("."); }

FilePlace find_place(const fs::path& named) {
  fail_unless_name(named);
  FilePlace place = place_behind_links(named);
  std::error_code error;
  const fs::path folder = fs::canonical(place.folder(), error);
  if (error) fail_with(named, "cannot be written", error.value());
  fail_if_led_outside(named, folder / place.file.filename());
  fail_if_input(named, place.file);
  return place;
}

fs::path new_part_name(const FilePlace& place) {
  static std::atomic<unsigned> counter{0};
  const std::string stem = place.file.stem().native(), extension = place.file.extension().native();
  const std::string mark = std::string(kMark) + std::to_string(::getpid()) + "-" + std::to_string(counter++);
  const std::size_t others = 1 + mark.size();
  const std::string_view kept = cut(extension, kLongestName - others);
  fs::path part =
      place.folder() / ("." + std::string(cut(stem, kLongestName - others - kept.size())) + mark + std::string(kept));
  begin_unfinished(part);
  const std::lock_guard<std::mutex> guard(ours().mutex);
  ours().parts.insert(part.filename().native());
  return part;
}

void forget_part(const fs::path& part) {
  end_unfinished(part);
  const std::lock_guard<std::mutex> guard(ours().mutex);
  ours().parts.erase(part.filename().native());
}

void remove_part(const fs::path& part) {
  ::unlink(part.c_str());
  forget_part(part);
}

fs::path write_part(const FilePlace& place, std::string_view bytes, bool durable) {
  Writing part(place);
  part.write(bytes);
  return part.end(durable);
}

fs::path copy_part(const fs::path& from, const FilePlace& place) {
  const Descriptor in(::open(from.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  struct stat found {};
  if (!in || ::fstat(in.number(), &found) != 0) fail_with(from, "cannot be read", errno);
  if (!S_ISREG(found.st_mode)) fail(from.string(), "is no plain file", "name one");
  // Permissions of the source, plus write permission for the owner.
  Writing part(place, (found.st_mode & 0777) | S_IWUSR);
  std::vector<char> block(std::size_t{1} << 20);
  for (;;) {
    const ssize_t got = ::read(in.number(), block.data(), block.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail_with(from, "cannot be read whole", errno);
    if (got == 0) return part.end(true);
    part.write({block.data(), static_cast<std::size_t>(got)});
  }
}

void sync_part(const FilePlace& place, const fs::path& part) {
  const Descriptor file(::open(part.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file) fail_with(place.named, "could not be written whole", errno);
  const int error = ::fsync(file.number()) != 0 ? errno : 0;
  if (error != 0 && error != EINVAL) fail_with(place.named, "could not be written whole", error);
}

bool is_part_name(std::string_view name) { return process_of(name) > 0; }

bool is_part_name_of(std::string_view name, const fs::path& file) {
  if (!is_part_name(name)) return false;
  const std::size_t mark = name.rfind(kMark), dot = std::min(name.find('.', mark + 1), name.size());
  const std::string_view stem = name.substr(1, mark - 1), extension = name.substr(dot);
  const std::string whole_stem = file.stem().native(), whole_extension = file.extension().native();
  if (stem == whole_stem && extension == whole_extension) return true;
  constexpr std::size_t kCutFrom = kLongestName - 3;  // shorter by at most a part of a character
  return name.size() >= kCutFrom && whole_stem.starts_with(stem) && whole_extension.starts_with(extension);
}

void clear_leftovers(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> left;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (is_left_over(entry->path())) left.push_back(entry->path());
  for (const fs::path& file : left) ::unlink(file.c_str());
}

void clear_leftovers_once(const fs::path& folder) {
  std::error_code error;
  const fs::path name = fs::absolute(folder, error).lexically_normal();
  {
    const std::lock_guard<std::mutex> guard(ours().mutex);
    if (error || !ours().cleared_folders.insert(name.native()).second) return;
  }
  clear_leftovers(folder);
}

void sync_folder(const fs::path& folder) {
  const Descriptor file(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (file) static_cast<void>(::fsync(file.number()));
}

}  // namespace burin
