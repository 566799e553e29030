#include "tools/watch/photo_inbox.h"

#include <sys/stat.h>

#include <algorithm>
#include <cctype>
#include <string_view>

#include "burin/capture/exif.h"
#include "burin/capture/lamp_folders.h"
#include "burin/capture/photo_source.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

// Programs that copy or synchronize use a temporary name first. Without its prefix, it may look like a photo's name.
bool is_in_the_making(const std::string& name) { return name.front() == '.' || name.front() == '~'; }

void add_files(const fs::path& folder, std::error_code& error, std::vector<fs::path>& files) {
  fs::directory_iterator entry(folder, error), end;
  for (; !error && entry != end; entry.increment(error))
    if (!is_in_the_making(entry->path().filename().string())) files.push_back(entry->path());
}

// Returns the files in a folder and in its lamps' folders, without temporary ones. `error`: of the folder itself. An
// unreadable lamp folder is read at the next look.
std::vector<fs::path> files_of(const fs::path& folder, const std::vector<std::string>& lamps, std::error_code& error) {
  std::vector<fs::path> files;
  add_files(folder, error, files);
  if (error) return files;
  for (const LampFolder& lamp : lamp_folders(folder, lamps)) {
    std::erase(files, lamp.folder);
    std::error_code ignored;
    add_files(lamp.folder, ignored, files);
  }
  return files;
}

}  // namespace

PhotoInbox::PhotoInbox(fs::path folder, std::vector<std::string> lamps, std::chrono::milliseconds stays)
    : folder_(std::move(folder)), lamps_(std::move(lamps)), stays_(stays) {}

InboxNews PhotoInbox::look() {
  InboxNews news;
  const Clock::time_point now = Clock::now();
  std::error_code error;
  std::map<fs::path, Entry> seen;
  int passed_over = 0;
  const std::vector<fs::path> files = files_of(folder_, lamps_, error);
  for (const fs::path& file : files) {
    struct stat status {};
    // Removed since the folder was read, or no file. A lost share gives an error for the folder itself.
    if (::stat(file.c_str(), &status) != 0) continue;
    Entry found;
    found.size = static_cast<std::uintmax_t>(status.st_size);
    found.inode = status.st_ino;
    std::error_code ignored;
    found.time = fs::last_write_time(file, ignored);
    // An unchanged photo of the latest look need not be opened again. A file without content yet is judged by its name.
    const auto before = entries_.find(file);
    const bool known = before != entries_.end() && before->second == found;
    if (!S_ISREG(status.st_mode) || (!known && !is_photo(file) && (is_sidecar_name(file) || !is_photo_name(file)))) {
      ++passed_over;
      continue;
    }
    seen.emplace(file, found);
  }
  if (error) {
    news.folder_there = false;
    news.why_not = error.message();
    return news;
  }
  passed_over_ = passed_over;

  for (auto& one : seen) {
    const fs::path& file = one.first;
    Entry& found = one.second;
    const auto known = entries_.find(file);
    found.since = now;
    if (known != entries_.end() && known->second == found) {
      found.state = known->second.state;
      found.since = known->second.since;
      if (found.state == Entry::State::growing && found.size > 0 && now - found.since >= stays_) {
        found.state = Entry::State::taken;
        news.whole.push_back(file);
      } else if ((found.state == Entry::State::growing || found.state == Entry::State::doubted) &&
                 now - found.since >= kGivenUp) {
        found.state = Entry::State::given_up;
        news.given_up.push_back(file);
      }
      continue;
    }
    // A taken file under another name: same inode, unchanged.
    const auto former = std::find_if(entries_.begin(), entries_.end(), [&](const auto& e) {
      return e.second == found && e.second.state == Entry::State::taken && !seen.contains(e.first);
    });
    if (former != entries_.end()) {
      found.state = Entry::State::taken;
      news.renamed.emplace_back(former->first, file);
      entries_.erase(former);
    } else if (!looked_ && found.size > 0) {
      found.state = Entry::State::taken;
      news.whole.push_back(file);
    }
  }
  for (const auto& [file, entry_before] : entries_)
    if (entry_before.state == Entry::State::taken && !seen.contains(file)) news.gone.push_back(file);
  entries_ = std::move(seen);
  looked_ = true;
  std::sort(news.whole.begin(), news.whole.end(), in_name_order);
  return news;
}

void PhotoInbox::not_yet(const fs::path& file) {
  const auto entry = entries_.find(file);
  if (entry == entries_.end()) return;
  entry->second.state = Entry::State::doubted;
  entry->second.since = Clock::now();
}

bool PhotoInbox::expects() const {
  return std::any_of(entries_.begin(), entries_.end(), [](const auto& e) {
    return e.second.state == Entry::State::growing || e.second.state == Entry::State::doubted;
  });
}

}  // namespace burin
