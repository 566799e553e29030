#include "tools/studio/studio.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <set>

#include "burin/base/error.h"
#include "burin/base/files/file_error.h"
#include "burin/base/files/named_paths.h"
#include "burin/capture/lamp_folders.h"
#include "burin/optimize/machine_profile.h"
#include "burin/pictures/picture_header.h"
#include "tools/content_hash.h"
#include "tools/project.h"
#include "tools/studio/studio_names.h"
#include "tools/version.h"
#include "tools/watch/watched_project.h"
#include "tools/work_lock.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr std::size_t kMostPhotos = 300;
constexpr std::chrono::milliseconds kBetweenLooks = 200ms, kBetweenStatus = 2s, kJudgeAfterLastLook = 30s;

// A part of the state for which a broken file counts as absent: the commands report it.
Json json_or_null(const fs::path& file) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return nullptr;
  try {
    return Json::parse(read_text(file));
  } catch (const std::exception&) {
    return nullptr;
  }
}

std::string stamp_of(const fs::path& file) {
  std::error_code error;
  const auto time = fs::last_write_time(file, error);
  if (error) return {};
  const auto size = fs::is_regular_file(file, error) ? fs::file_size(file, error) : 0;
  return fmt::format("{}:{}:{}\n", file.string(), time.time_since_epoch().count(), size);
}

// When a file was written, ms, to compare it with others; 0 if it is missing.
std::int64_t written_at_ms(const fs::path& file) {
  std::error_code error;
  const auto time = fs::last_write_time(file, error);
  if (error) return 0;
  const auto since_1970 = fs::file_time_type::clock::to_sys(time).time_since_epoch();
  return std::chrono::duration_cast<std::chrono::milliseconds>(since_1970).count();
}

std::vector<fs::path> entries_of(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (!entry->path().filename().string().starts_with(".")) found.push_back(entry->path());
  std::sort(found.begin(), found.end());
  return found;
}

std::string stamps_below(const fs::path& folder) {
  std::string stamps;
  std::error_code ignored;
  for (const fs::path& path : entries_of(folder)) {
    stamps += stamp_of(path);
    if (fs::is_directory(path, ignored))
      for (const fs::path& inner : entries_of(path)) stamps += stamp_of(inner);
  }
  return stamps;
}

std::string photos_stamp(const Project& project) {
  const int last = project.rounds();
  return last == 0 ? std::string() : stamps_below(project.round(last) / "photos");
}

// The keys of a report that the page shows.
Json shown_of_report(const Json& report) {
  Json shown = Json::object();
  if (!report.is_object()) return nullptr;
  for (const char* key :
       {"scratches", "stopped_early", "views", "length_mm", "carving_curve", "eye", "pixels", "notes"})
    if (report.contains(key)) shown[key] = report[key];
  return shown;
}

Json round_json(const Project& project, int number) {
  const fs::path folder = project.round(number);
  std::error_code ignored;
  Json json{{"name", folder.filename().string()}, {"measured", number <= project.measured()}};
  json["report"] = shown_of_report(json_or_null(folder / "design/design-report.json"));
  if (json["report"].is_object())  // for addresses of its pictures, which change with it
    json["report"]["stamp"] = written_at_ms(folder / "design/design-report.json");
  json["files"] = Json::array();
  for (const fs::path& file : entries_of(folder))
    if (fs::is_regular_file(file, ignored))
      json["files"].push_back({{"name", file.filename().string()}, {"bytes", fs::file_size(file, ignored)}});
  json["live"] = written_at_ms(folder / "design/live.png");
  json["photos"] = Json::array();
  for (const fs::path& entry : entries_of(folder / "photos")) {
    if (!fs::is_directory(entry, ignored)) {
      json["photos"].push_back(entry.lexically_relative(folder).string());
      continue;
    }
    for (const fs::path& photo : entries_of(entry)) json["photos"].push_back(photo.lexically_relative(folder).string());
  }
  return json;
}

// An option of a command, if the wish has a value for it.
void add_option(const Json& wish, const std::string& key, std::vector<std::string>& command) {
  if (const std::string value = plain_value(wish, key); !value.empty()) command.push_back("--" + key + "=" + value);
}

std::vector<std::string> loop_command(const Json& wish, const std::string& folder) {
  std::vector<std::string> command{"loop", folder};
  for (const char* key : {"count", "time", "carve-time", "pixels", "iterations", "travel", "force"})
    add_option(wish, key, command);
  const char* const allowed = "allow-undetermined";
  if (wish.contains(allowed) && wish[allowed].is_array())
    for (const Json& name : wish[allowed]) add_option({{allowed, name}}, allowed, command);
  for (const char* flag : {"allow-stale", "another", "carve-curve"})
    if (wish.contains(flag) && wish[flag].is_boolean() && wish[flag].get<bool>())
      command.push_back(std::string("--") + flag);
  return command;
}

}  // namespace

Studio::Studio(fs::path folder) : folder_(fs::absolute(std::move(folder)).lexically_normal()) {
  if (!folder_.has_filename()) folder_ = folder_.parent_path();
  std::error_code error;
  if (fs::exists(folder_, error) && !fs::is_directory(folder_, error))
    fail(folder_.string(), "is a file", "name a project, or a folder for a new one");
  if (!is_made() && fs::exists(folder_, error) && !fs::is_empty(folder_, error))
    fail(folder_.string(), "is neither a project nor empty", "name a project, or a folder for a new one");
  work_.take_up(workshop());
  judge_.take_up(workshop());
}

bool Studio::is_made() const { return is_project(folder_); }

// A project keeps the studio's own files; before it exists, they lie next to it, because `burin new` wants no folder.
fs::path Studio::workshop() const { return is_made() ? folder_ / ".burin-studio" : staging(); }

fs::path Studio::staging() const { return folder_.parent_path() / ("." + folder_.filename().string() + ".studio"); }

std::string Studio::fingerprint() const {
  if (!is_made()) return stamps_below(workshop() / "pictures");
  std::string stamps;
  for (const char* name :
       {"design.json", "bench.json", "board.json", "loop.toml", "rounds.json", "preview.png", "report.html",
        "view.html", "tags.pdf", "sheet.pdf", "made/report.json", "coupon/coupon.gcode"})
    stamps += stamp_of(folder_ / name);
  const Project project{folder_};
  for (int round = 1; round <= project.rounds(); ++round) {
    const fs::path folder = project.round(round);
    stamps += stamp_of(folder);
    for (const char* name : {"design/live.png", "design/design-report.json", "names.json"})
      stamps += stamp_of(folder / name);
    stamps += stamps_below(folder / "made");
    stamps += stamps_below(folder / "photos");
  }
  return stamps;
}

void Studio::look() {
  const auto now = std::chrono::steady_clock::now();
  if (now - looked_ < kBetweenLooks) return;
  looked_ = now;
  bool changed = work_.look();
  const bool judged = judge_.is_running();
  changed = judge_.look() || changed;
  const Project project{folder_};
  const bool made = is_made();
  if (judged && !judge_.is_running()) judged_files_ = photos_stamp(project) + std::to_string(project.measured());
  std::string files = fingerprint(), at_work = made ? who_works_in(folder_) : std::string();
  if (files != seen_files_ || made != status_is_made_) {
    seen_files_ = std::move(files);
    status_is_made_ = made;
    status_is_old_ = changed = true;
    known_ = nullptr;
  }
  if (at_work != at_work_) {
    at_work_ = std::move(at_work);
    status_is_old_ = changed = true;
  }
  if (made && !work_.is_running() && work_.action() == "new") {  // the project has its own copies
    std::error_code ignored;
    fs::remove_all(staging(), ignored);
  }
  const bool wanted = now - wanted_judge_ < kJudgeAfterLastLook;
  if (wanted && made && !judge_.is_running() && !work_.is_running() && project.rounds() > project.measured() &&
      fs::exists(project.round(project.rounds()) / "board.json") &&
      judged_files_ != photos_stamp(project) + std::to_string(project.measured()))
    judge_.begin("watch", {"watch", folder_.string()}, workshop());
  if (!changed) return;
  ++revision_;
  changed_.notify_all();
}

// Runs `burin status` without the lock, because it reads and hashes files.
void Studio::refresh_status(std::unique_lock<std::mutex>& lock) {
  const auto now = std::chrono::steady_clock::now();
  if (!status_is_old_ || status_runs_ || work_.is_running() || now - status_at_ < kBetweenStatus) return;
  status_is_old_ = false;
  status_runs_ = true;
  Json status;
  if (is_made()) {
    lock.unlock();
    try {
      status = Json::parse(program_output({"--json", "status", folder_.string()}, folder_), nullptr, false);
    } catch (const std::exception&) {
      status = nullptr;
    }
    lock.lock();
    if (status.is_object() && status.contains("data") && status["data"].contains("stages"))
      for (Json& stage : status["data"]["stages"])
        for (const char* key : {"inputs", "outputs", "options", "accepted_unknown"}) stage.erase(key);
  }
  status_ = status.is_object() ? status : Json();
  status_at_ = std::chrono::steady_clock::now();
  status_runs_ = false;
  ++revision_;
  changed_.notify_all();
}

Json Studio::pictures() const {
  Json list = Json::array();
  if (is_made()) return list;
  std::vector<fs::path> files = entries_of(workshop() / "pictures");
  std::error_code ignored;
  std::stable_sort(files.begin(), files.end(), [&](const fs::path& a, const fs::path& b) {
    return fs::last_write_time(a, ignored) < fs::last_write_time(b, ignored);
  });
  for (const fs::path& file : files) list.push_back(file.filename().string());
  return list;
}

Json Studio::project_json() const {
  Json json{{"made", is_made()}, {"pictures", pictures()}};
  if (!is_made()) return json;
  for (const char* name : {"design", "bench", "rounds"})
    json[name] = json_or_null(folder_ / (std::string(name) + ".json"));
  Json board = json_or_null(folder_ / "board.json");
  if (board.is_object()) {
    board.erase("scratches");
    json["board"] = std::move(board);
  }
  json["files"] = Json::array();
  std::error_code ignored;
  for (const fs::path& file : entries_of(folder_))
    if (fs::is_regular_file(file, ignored)) json["files"].push_back(file.filename().string());
  if (fs::exists(folder_ / "coupon/coupon.gcode", ignored)) json["files"].push_back("coupon/coupon.gcode");
  json["viewer"] = written_at_ms(folder_ / "view.html");
  const Project project{folder_};
  json["boards"] = Json::array();
  for (int round = 1; round <= project.rounds(); ++round) json["boards"].push_back(round_json(project, round));
  json["former"] = entries_of(workshop() / "former").size();
  return json;
}

Json Studio::state() {
  if (known_.is_null()) known_ = project_json();
  return {{"revision", revision_},
          {"burin", version()},
          {"folder", folder_.string()},
          {"name", folder_.filename().string()},
          {"machines", built_in_machines()},
          {"project", known_},
          {"status", status_},
          {"at_work", at_work_},
          {"phone", phone_address_},
          {"work", work_.json()},
          {"judge", judge_.json()}};
}

Json Studio::wait_for_state(std::uint64_t seen, bool looks, std::chrono::milliseconds longest) {
  std::unique_lock lock(mutex_);
  const auto until = std::chrono::steady_clock::now() + longest;
  for (;;) {
    if (looks) wanted_judge_ = std::chrono::steady_clock::now();
    look();
    refresh_status(lock);
    if (ending_ || revision_ != seen || std::chrono::steady_clock::now() >= until) return state();
    changed_.wait_for(lock, work_.is_running() || judge_.is_running() ? 250ms : 1000ms);
  }
}

Json Studio::wait_for_shots(std::uint64_t seen, std::chrono::milliseconds longest) {
  const Json whole = wait_for_state(seen, true, longest);
  Json json{{"revision", whole["revision"]}, {"name", whole["name"]}, {"judge", whole["judge"]}};
  json["measuring"] = whole["work"].is_object() && whole["work"]["running"] == true;
  for (const char* key : {"bench", "board"})
    if (whole["project"].contains(key)) json[key] = whole["project"][key];
  json["lamps"] = Json::array();
  if (whole["project"].contains("design") && whole["project"]["design"].is_object()) {
    std::set<std::string> lamps;
    for (const Json& view : whole["project"]["design"].value("views", Json::array()))
      if (view.contains("light") && view["light"].is_string()) lamps.insert(view["light"].get<std::string>());
    for (const std::string& lamp : lamps) json["lamps"].push_back(lamp);
  }
  const Json& boards = whole["project"].contains("boards") ? whole["project"]["boards"] : Json::array();
  json["photos"] = boards.empty() ? 0 : boards.back()["photos"].size();
  return json;
}

void Studio::begin(const Json& wish) {
  const std::string action = plain_value(wish, "action"), folder = folder_.string();
  const std::lock_guard lock(mutex_);
  std::vector<std::string> command;
  if (action == "new") {
    command = {"new", folder, "--pictures"};
    if (!wish.contains("pictures") || !wish["pictures"].is_array() || wish["pictures"].empty())
      fail("new", "no picture is named", "add one to nine pictures");
    const fs::path pictures = workshop() / "pictures";
    for (const Json& name : wish["pictures"])
      command.push_back(confined(pictures, name.is_string() ? name.get<std::string>() : "").string());
    for (const char* key : {"board", "camera", "lamp", "stand", "machine", "count"}) add_option(wish, key, command);
  } else if (action == "loop") {
    command = loop_command(wish, folder);
  } else if (action == "print" || action == "sheet" || action == "view" || action == "report") {
    command = {action, folder};
    if (action == "print" || action == "sheet") add_option(wish, "paper", command);
  } else if (action == "coupon") {
    command = {"coupon", "write", "--out", (folder_ / "coupon").string()};
  } else {
    fail("action", "\"" + action + "\" is none of the studio's actions", "reload the page");
  }
  if (action != "new" && !is_made()) fail(action, "there is no board yet", "add pictures and make the board first");
  judge_.stop();
  looked_ = {};
  work_.begin(action, command, workshop());
  ++revision_;
  changed_.notify_all();
}

void Studio::stop() {
  const std::lock_guard lock(mutex_);
  work_.stop();
  ++revision_;
  changed_.notify_all();
}

StudioFile Studio::file(const std::string& path) const {
  const fs::path file = confined(folder_, path);
  StudioFile out{read_text(file), media_type(file), false};
  if (out.type.empty()) fail(path, "is of no kind that the page shows", "look into the folder itself");
  out.is_page = out.type.starts_with("text/html") || out.type.starts_with("image/svg");
  return out;
}

// Receives a body into a hidden file of the workshop. The caller moves or removes it.
fs::path Studio::store(const UploadBody& body, std::uintmax_t most_bytes) const {
  const fs::path folder = workshop();
  make_output_folder(folder);
  std::string name = (folder / ".upload-XXXXXX").string();
  const int fd = ::mkstemp(name.data());
  if (fd < 0) fail_with(folder.string(), "an upload cannot be stored", errno);
  std::uintmax_t bytes = 0;
  int error = 0;
  const bool whole = body([&](const char* data, std::size_t size) {
    bytes += size;
    while (size > 0 && bytes <= most_bytes) {
      const ssize_t n = ::write(fd, data, size);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) {
        error = errno;
        return false;
      }
      data += n;
      size -= static_cast<std::size_t>(n);
    }
    return bytes <= most_bytes;
  });
  if (::close(fd) != 0 && error == 0) error = errno;
  if (whole && error == 0 && bytes > 0) return name;
  ::unlink(name.c_str());
  if (error != 0) fail_with(folder.string(), "the upload cannot be stored", error);
  if (bytes > most_bytes)
    fail("the upload", fmt::format("has more than {} MB", most_bytes / 1'000'000), "send a smaller file");
  if (bytes == 0) fail("the upload", "is empty (0 bytes)", "send the file again");
  fail("the upload", "was cut off", "send the file again");
}

Json Studio::add_photo(const std::string& given, const std::string& lamp, const UploadBody& body) {
  const std::string name = upload_name(given);
  const WatchedProject watched = watched_project(folder_, {}, {});
  if (watched.photos.empty() || entries_of(watched.photos).size() >= kMostPhotos)
    fail("photos", fmt::format("{} are there already", kMostPhotos), "measure with these");
  fs::path folder = watched.photos;
  if (watched.lamps.size() > 1) {
    if (std::find(watched.lamps.begin(), watched.lamps.end(), lamp) == watched.lamps.end())
      fail("photo " + name, "nothing tells which lamp was on", "choose the lamp first");
    folder = lamp_folder(watched.photos, lamp, watched.lamps);
    make_output_folder(folder);
  }
  const fs::path stored = store(body, kMostPicture_bytes);
  if (picture_kind(stored).empty()) {
    ::unlink(stored.c_str());
    fail(name, "is no picture of a kind that Burin reads", "send the camera's own file");
  }
  fs::path to = folder / name;
  std::error_code error;
  // A connection that dropped may send the same photo twice.
  if (fs::is_regular_file(to, error) && fs::file_size(to, error) == fs::file_size(stored, error) &&
      content_hash(to) == content_hash(stored)) {
    ::unlink(stored.c_str());
    return {{"file", to.filename().string()}, {"known", true}};
  }
  to = free_name(folder, name);
  fs::permissions(
      stored, fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read | fs::perms::others_read, error);
  fs::rename(stored, to, error);
  if (error) {
    ::unlink(stored.c_str());
    fail_with(to, "the photo cannot be put into its folder", error.value());
  }
  const std::lock_guard lock(mutex_);
  looked_ = {};
  changed_.notify_all();
  return {{"file", to.filename().string()}, {"known", false}};
}

void Studio::remove_picture(const std::string& name) {
  if (is_made()) fail(name, "belongs to a board that is made", "begin another project for other pictures");
  const fs::path file = confined(workshop() / "pictures", name);
  std::error_code error;
  fs::remove(file, error);
  const std::lock_guard lock(mutex_);
  looked_ = {};
  changed_.notify_all();
}

void Studio::set_phone_address(const std::string& address) {
  const std::lock_guard lock(mutex_);
  phone_address_ = address;
  ++revision_;
}

std::string Studio::phone_address() const {
  const std::lock_guard lock(mutex_);
  return phone_address_;
}

void Studio::end(bool with_work) {
  const std::lock_guard lock(mutex_);
  ending_ = true;
  judge_.stop();
  if (with_work) work_.stop();
  changed_.notify_all();
}

void Studio::tidy() {
  const std::lock_guard lock(mutex_);
  if (judge_.is_running() && std::chrono::steady_clock::now() - wanted_judge_ > kJudgeAfterLastLook) {
    judge_.stop();
    judge_.look();
  }
}

}  // namespace burin
