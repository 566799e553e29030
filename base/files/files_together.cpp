#include "burin/base/files/files_together.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/files/descriptor.h"
#include "burin/base/files/file_error.h"
#include "burin/base/files/named_paths.h"
#include "burin/base/files/unfinished.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

// kOn marks a change to be completed, kBack a change to be reverted. A rename turns one into the other without space on
// the disk.
constexpr const char *kOn = ".burin-change", *kBack = ".burin-change-back";
constexpr std::string_view kBegin = "burin/change 2", kEnd = "end";

thread_local FilesTogether* change_of_thread = nullptr;

std::function<void(const std::string&)>& report_of_settled() {
  static std::function<void(const std::string&)> report;
  return report;
}

// A key of the file, equal for all its names, with links followed.
std::string key_of(const fs::path& file) {
  std::error_code error;
  const fs::path folder = fs::canonical(file.has_parent_path() ? file.parent_path() : fs::path("."), error);
  return ((error ? fs::absolute(file.parent_path()).lexically_normal() : folder) / file.filename()).native();
}

// A file's move, relative to the journal's folder. Zero bytes separate names, because no name contains one.
struct Move {
  std::string file, part, former;
  ino_t old_inode = 0;  // of the old file; 0: none
  ino_t new_inode = 0;  // of the part file; 0: a removal

  bool there() const { return old_inode != 0; }
};

std::string text_of(const std::vector<Move>& moves) {
  std::string text(kBegin);
  text += '\0';
  for (const Move& m : moves)
    for (const std::string& field :
         {m.file, m.part, m.former, std::to_string(m.old_inode), std::to_string(m.new_inode)})
      (text += field) += '\0';
  return text += kEnd;
}

// A journal may come from a stranger. It may only name files within its own folder, and the part files next to them.
bool is_within(const fs::path& name, const fs::path& folder) {
  if (name.empty() || name.is_absolute()) return false;
  for (const fs::path& step : name)
    if (step == ".." || step == "." || step.empty()) return false;
  std::error_code error;
  const fs::path real = fs::canonical(folder, error);
  const fs::path inner = error ? fs::path() : fs::canonical((folder / name).parent_path(), error);
  return !error && std::mismatch(real.begin(), real.end(), inner.begin(), inner.end()).first == real.end();
}

bool is_harmless(const Move& m, const fs::path& folder) {
  if (!is_within(m.file, folder) || is_part_name(fs::path(m.file).filename().native())) return false;
  for (const std::string& other : {m.part, m.former})
    if (!other.empty() && (!is_part_name_of(fs::path(other).filename().native(), m.file) ||
                           fs::path(other).parent_path() != fs::path(m.file).parent_path()))
      return false;
  return !m.former.empty() && m.part.empty() == (m.new_inode == 0) && (m.there() || !m.part.empty());
}

ino_t inode_in(const std::string& text) {
  ino_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size() ? number : 0;
}

// The moves of a journal; nothing if it is truncated, because then nothing was moved.
std::optional<std::vector<Move>> moves_of(const std::string& text, const fs::path& folder) {
  std::vector<std::string> fields;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find('\0', at), text.size());
    fields.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  if (fields.size() < 2 || fields.front() != kBegin || fields.back() != kEnd || fields.size() % 5 != 2)
    return std::nullopt;
  std::vector<Move> moves;
  std::set<std::string> names;
  for (std::size_t i = 1; i + 1 < fields.size(); i += 5) {
    moves.push_back({fields[i], fields[i + 1], fields[i + 2], inode_in(fields[i + 3]), inode_in(fields[i + 4])});
    if (!is_harmless(moves.back(), folder) || !names.insert(fields[i]).second) return std::nullopt;
  }
  return moves;
}

// The inode number of the file or link of this name; 0: none.
ino_t inode_of(const fs::path& file) {
  struct stat found {};
  return ::lstat(file.c_str(), &found) == 0 && !S_ISDIR(found.st_mode) ? found.st_ino : 0;
}

bool is_there(const fs::path& file) {
  struct stat found {};
  return ::lstat(file.c_str(), &found) == 0;
}

// True if the existing part files were written for this change, on this disk.
bool is_of_here(const Move& m, const fs::path& folder) {
  return (m.part.empty() || !is_there(folder / m.part) || inode_of(folder / m.part) == m.new_inode) &&
         (!is_there(folder / m.former) || (m.there() && inode_of(folder / m.former) == m.old_inode));
}

// Returns 0 or an errno.
int renamed(const fs::path& from, const fs::path& to) { return std::rename(from.c_str(), to.c_str()) == 0 ? 0 : errno; }

// Moves one file to its place; its old content remains as `former`. Returns 0 or an errno.
int move_on(const Move& m, const fs::path& folder) {
  const fs::path file = folder / m.file, former = folder / m.former;
  if (m.part.empty()) return m.there() ? renamed(file, former) : 0;
  // A second name for the old file; on a file system without hard links, a rename of the old file.
  if (m.there() && ::link(file.c_str(), former.c_str()) != 0)
    if (const int error = renamed(file, former)) return error;
  return renamed(folder / m.part, file);
}

// move_on() for a change interrupted at any point.
int complete(const Move& m, const fs::path& folder) {
  const fs::path file = folder / m.file;
  if (!m.part.empty()) return is_there(folder / m.part) ? renamed(folder / m.part, file) : 0;
  return inode_of(file) == m.old_inode && !is_there(folder / m.former) ? renamed(file, folder / m.former) : 0;
}

int take_back(const Move& m, const fs::path& folder) {
  const fs::path file = folder / m.file, former = folder / m.former;
  const bool moved = !m.part.empty() && !is_there(folder / m.part);
  if (is_there(former)) {
    if (const int error = renamed(former, file)) return error;
    ::unlink(former.c_str());  // two names of one file: the rename had no effect, and none was necessary
  } else if (moved && !m.there() && inode_of(file) == m.new_inode) {
    ::unlink(file.c_str());
  }
  if (!m.part.empty()) ::unlink((folder / m.part).c_str());
  return 0;
}

std::set<fs::path> folders_of(const std::vector<Move>& moves, const fs::path& folder) {
  std::set<fs::path> folders;
  for (const Move& m : moves) folders.insert((folder / m.file).parent_path());
  return folders;
}

// Ends a change after all moves: syncs the new names, then removes the journal, then the old files.
void finish(const std::vector<Move>& moves, const fs::path& folder, const fs::path& journal) {
  for (const fs::path& each : folders_of(moves, folder)) sync_folder(each);
  ::unlink(journal.c_str());
  for (const Move& m : moves) ::unlink((folder / m.former).c_str());
}

std::string text_in(int file) {
  std::string text;
  std::array<char, 4096> block{};
  constexpr std::size_t kMost = std::size_t{64} << 20;
  for (ssize_t got = 0; (got = ::read(file, block.data(), block.size())) > 0 && text.size() < kMost;)
    text.append(block.data(), static_cast<std::size_t>(got));
  return text;
}

std::string count_of(const std::vector<Move>& moves) { return counted(moves.size(), "file"); }

[[noreturn]] void fail_mixed(const fs::path& folder, int error) {
  fail(folder.string(), "a change of several files here was cut off, and cannot be completed: " + error_text(error),
       "run the command as the owner of that folder, on a disk that can be written to");
}

// `wanted` is the file to be read or written; empty: all files here may change. Returns false if the journal was left
// unchanged.
bool settle_journal(const fs::path& folder, const char* name, const fs::path& wanted) {
  const fs::path journal = folder / name;
  // A link or a FIFO of this name is not a journal of Burin.
  const Descriptor file(::open(journal.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  struct stat found {};
  if (!file) {
    if (errno == ENOENT || errno == ELOOP) return true;
    fail_mixed(folder, errno);
  }
  if (::fstat(file.number(), &found) != 0 || !S_ISREG(found.st_mode)) return true;
  // In a shared folder such as /tmp, anybody can create one.
  struct stat around {};
  if (::stat(folder.c_str(), &around) == 0 && (around.st_mode & S_ISVTX) != 0 && found.st_uid != ::geteuid())
    return true;
  // Its live process holds the lock; a change takes milliseconds.
  for (int tries = 0; ::flock(file.number(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK; ++tries) {
    constexpr int kTries = 1000, kTry_us = 10'000;
    if (tries == kTries)
      fail(folder.string(), "another process has been changing files here for ten seconds",
           "wait until it has ended, or stop it");
    ::usleep(kTry_us);
  }
  if (!is_at(file.number(), journal)) return true;  // the change has ended
  const auto moves = moves_of(text_in(file.number()), folder);
  if (!wanted.empty() && !may_change_in(folder, wanted)) {
    // Burin may not settle this journal, but its files cannot be trusted.
    const auto is_wanted = [&](const Move& m) { return key_of(folder / m.file) == key_of(wanted); };
    if (moves && std::any_of(moves->begin(), moves->end(), is_wanted))
      fail(wanted.string(), "belongs to a change of several files that was cut off in " + folder.string(),
           "name that folder in the command, and it is completed; or, if it came from elsewhere, remove " +
               journal.string());
    return !moves;
  }
  if (!moves) {
    if (::unlink(journal.c_str()) != 0) fail_mixed(folder, errno);
    return true;
  }
  if (!std::all_of(moves->begin(), moves->end(), [&](const Move& m) { return is_of_here(m, folder); }))
    fail(
        folder.string(),
        "holds a change of several files that was cut off somewhere else, and was copied since: what lies there may be "
        "old and new together",
        "copy the folder again after a command has read it where it comes from; or remove " + journal.string() +
            " to take what is there");
  const bool on = std::string_view(name) == kOn;
  for (const Move& m : *moves)
    if (const int error = on ? complete(m, folder) : take_back(m, folder)) fail_mixed(folder, error);
  finish(*moves, folder, journal);
  if (report_of_settled())
    report_of_settled()(folder.string() + ": a change of " + count_of(*moves) + " had been cut off here, and is now " +
                        (on ? "completed" : "taken back"));
  return true;
}

// The common folder of all files, at most two levels above each, because readers search no further for a journal.
fs::path common_folder(const std::vector<FilesTogether::Item>& items) {
  std::error_code error;
  fs::path common;
  for (const FilesTogether::Item& item : items) {
    const fs::path folder = fs::canonical(item.place.folder(), error);
    if (error) fail_with(item.place.named, "cannot be written", error.value());
    if (common.empty()) {
      common = folder;
      continue;
    }
    fs::path both;
    const auto at = std::mismatch(common.begin(), common.end(), folder.begin(), folder.end()).first;
    for (auto step = common.begin(); step != at; ++step) both /= *step;
    common = both;
  }
  return common;
}

// Levels between a folder and one within it.
std::ptrdiff_t depth_below(const fs::path& folder, const fs::path& within) {
  return std::distance(within.begin(), within.end()) - std::distance(folder.begin(), folder.end());
}

// Moves the files with one journal. On failure, it throws Error and all files are unchanged.
void put_with_journal(std::vector<FilesTogether::Item>& items, const fs::path& folder) {
  std::vector<Move> moves;
  for (FilesTogether::Item& item : items) {
    const fs::path below = fs::canonical(item.place.folder()).lexically_relative(folder);
    item.former = new_part_name(item.place);
    const auto name = [&](const fs::path& file) {
      return file.empty() ? std::string() : (below == "." ? file.filename() : below / file.filename()).native();
    };
    moves.push_back({name(item.place.file), name(item.part), name(item.former),
                     item.place.there ? inode_of(item.place.file) : 0, item.part.empty() ? 0 : inode_of(item.part)});
  }
  const fs::path journal = folder / kOn;
  Descriptor file;
  constexpr int kTries = 100;
  for (int tries = 0;; ++tries) {
    for (const char* name : {kOn, kBack}) settle_journal(folder, name, {});
    file = Descriptor(::open(journal.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
    if (!file && (errno != EEXIST || tries == kTries)) fail_with(journal, "cannot be written", errno);
    if (!file) continue;
    ::flock(file.number(), LOCK_EX);
    if (is_at(file.number(), journal)) break;  // no other process removed it meanwhile as an interrupted one
  }
  int error = write_all(file.number(), text_of(moves));
  if (error == 0 && ::fsync(file.number()) != 0 && errno != EINVAL) error = errno;
  if (error != 0) {
    ::unlink(journal.c_str());
    fail_with(journal, "could not be written whole", error);
  }
  sync_folder(folder);
  for (std::size_t i = 0; i < moves.size(); ++i) {
    error = move_on(moves[i], folder);
    if (error == 0) continue;
    const fs::path back = folder / kBack;
    int stuck = renamed(journal, back);
    for (std::size_t k = i + 1; stuck == 0 && k-- > 0;) stuck = take_back(moves[k], folder);
    if (stuck == 0) finish(moves, folder, back);
    fail_with(items[i].place.named,
              stuck == 0 ? "cannot be written, and all that belongs to it is as before"
                         : "cannot be written; the next burin command here puts in order what was begun",
              error);
  }
  finish(moves, folder, journal);
}

}  // namespace

FilesTogether::FilesTogether() : outer_(change_of_thread) {
  if (outer_ == nullptr) change_of_thread = this;
}

FilesTogether::~FilesTogether() {
  for (const Item& item : items_)
    if (!item.part.empty()) remove_part(item.part);
  if (outer_ == nullptr) change_of_thread = nullptr;
}

void FilesTogether::put() {
  if (outer_ != nullptr) return;
  change_of_thread = nullptr;  // the change is over: later files do not belong to it
  if (items_.empty()) return;
  const auto whole = finishing();
  if (items_.size() == 1 && !items_.front().part.empty()) {  // a single rename is atomic by itself
    const Item& item = items_.front();
    if (const int error = renamed(item.part, item.place.file)) fail_with(item.place.named, "cannot be written", error);
    sync_folder(item.place.folder());
    forget_part(item.part);
    note_written(item.place.named);
    items_.clear();
    return;
  }
  const fs::path common = common_folder(items_);
  constexpr std::ptrdiff_t kFarthest = 2;  // the reach of settle_changes
  const bool near = std::all_of(items_.begin(), items_.end(), [&](const Item& item) {
    return depth_below(common, fs::canonical(item.place.folder())) <= kFarthest;
  });
  if (near && ::access(common.c_str(), W_OK | X_OK) == 0) {
    put_with_journal(items_, common);
  } else {
    // Places so far apart have no common folder within the readers' search: they change one after the other.
    for (Item& item : items_) {
      std::vector<Item> one{item};
      put_with_journal(one, fs::canonical(item.place.folder()));
    }
  }
  for (const Item& item : items_) {
    for (const fs::path& name : {item.part, item.former})
      if (!name.empty()) forget_part(name);
    if (!item.part.empty()) note_written(item.place.named);
  }
  items_.clear();
}

bool joins_change(const FilePlace& place, const fs::path& part) {
  if (change_of_thread == nullptr) return false;
  std::vector<FilesTogether::Item>& items = change_of_thread->items_;
  const std::string key = key_of(place.file);
  const auto same = std::find_if(items.begin(), items.end(),
                                 [&](const FilesTogether::Item& item) { return key_of(item.place.file) == key; });
  if (same == items.end()) {
    items.push_back({place, part, {}});
  } else {  // written twice: the last one counts
    if (!same->part.empty()) remove_part(same->part);
    same->part = part;
  }
  return true;
}

fs::path as_written(const fs::path& file) {
  if (change_of_thread == nullptr) return file;
  const std::string key = key_of(file);
  for (const FilesTogether::Item& item : change_of_thread->items_)
    if (!item.part.empty() && (key_of(item.place.file) == key || key_of(item.place.named) == key)) return item.part;
  return file;
}

bool settle_changes(const fs::path& file) {
  std::error_code error;
  const fs::path wanted = fs::absolute(file, error).lexically_normal();
  if (error) return true;
  bool all = true;
  fs::path at = wanted.parent_path();
  for (int up = 0; up < 3; ++up, at = at.parent_path()) {
    for (const char* name : {kOn, kBack})
      if (::access((at / name).c_str(), F_OK) == 0) all = settle_journal(at, name, wanted) && all;
    if (at == at.parent_path()) break;
  }
  return all;
}

void report_settled_changes(std::function<void(const std::string&)> report) { report_of_settled() = std::move(report); }

}  // namespace burin
