#include "tools/loop/aside.h"

#include <fmt/format.h>

#include <optional>
#include <utility>
#include <vector>

#include "burin/base/files/json_file.h"
#include "burin/base/files/part_file.h"
#include "burin/base/files/write_file.h"
#include "tools/loop/state.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

// Returns true for "02-design" among the folders of former/.
bool is_former(const fs::path& folder, StageKind stage) {
  const std::string name = folder.filename().string();
  const std::size_t dash = name.find('-');
  return dash != std::string::npos && name.substr(dash + 1) == name_of(stage);
}

fs::path new_folder(const fs::path& former, const char* stage) {
  for (int number = 1;; ++number) {
    const std::string begin = fmt::format("{:02}-", number);
    bool taken = false;
    if (fs::is_directory(former))
      for (const auto& entry : fs::directory_iterator(former))
        taken = taken || entry.path().filename().string().starts_with(begin);
    if (!taken) return former / (begin + stage);
  }
}

// Returns true for a finished result of the same inputs without later edits. Other accepted differences do not matter,
// because the inputs are again the original ones.
bool is_the_same(const MadeRecord& former, const MadeRecord& begun) {
  return former.status == MadeRecord::Status::done && former.stage == begun.stage && former.burin == begun.burin &&
         former.options == begun.options && former.inputs == begun.inputs && former.kept.outputs.empty() &&
         !former.outputs.empty();
}

// Returns the files of `former` in `aside`, and their targets; none if one is missing or changed.
std::vector<std::pair<fs::path, fs::path>> whole_files(const MadeRecord& former, const fs::path& aside,
                                                       const LoopProject& loop, const fs::path& folder,
                                                       ContentHashes& hashes) {
  std::vector<std::pair<fs::path, fs::path>> files;
  for (const auto& [name, hash] : former.outputs) {
    const fs::path place = (loop.project.folder / name).lexically_normal();
    const fs::path file = aside / place.lexically_relative(folder.lexically_normal());
    if (hash.empty() || hashes.of(file) != hash) return {};
    files.emplace_back(file, place);
  }
  return files;
}

void move_to(const fs::path& aside, const fs::path& file, const fs::path& folder) {
  const fs::path to = aside / file.lexically_relative(folder);
  fs::create_directories(to.parent_path());
  fs::rename(file, to);
}

// Completes the latest move of this stage: files in its record with the same contents.
void complete_last_move(const LoopProject& loop, const StageOfRound& at, ContentHashes& hashes) {
  const fs::path folder = folder_of(loop.project, at);
  fs::path last;
  if (fs::is_directory(folder / "former"))
    for (const auto& entry : fs::directory_iterator(folder / "former"))
      if (is_former(entry.path(), at.stage) && entry.path() > last) last = entry.path();
  if (last.empty()) return;
  const std::optional<MadeRecord> record = read_record(last / "made.json");
  if (!record) return;
  for (const fs::path& file : outputs_of(loop, at)) {
    const std::string name = path_in_project(loop.project.folder, file);
    const auto kept = record->kept.outputs.find(name), made = record->outputs.find(name);
    const std::string hash = kept != record->kept.outputs.end() ? kept->second
                             : made != record->outputs.end()    ? made->second
                                                                : "";
    if (hash == hashes.of(file) && !fs::exists(last / file.lexically_relative(folder))) move_to(last, file, folder);
  }
}

}  // namespace

fs::path begin_stage(const LoopProject& loop, const StageOfRound& at, const MadeRecord& begun, ContentHashes& hashes) {
  const fs::path folder = folder_of(loop.project, at), record = record_file(loop.project, at);
  const std::optional<MadeRecord> before = read_record(record);
  const bool not_ended = before && before->status == MadeRecord::Status::begun;
  if (not_ended) complete_last_move(loop, at, hashes);
  std::vector<fs::path> files = outputs_of(loop, at);
  // An unused partial result, or the page of a refused check.
  if (not_ended && (at.stage == StageKind::check || !has_result(loop, at))) {
    for (const fs::path& file : files) fs::remove(file);
    files.clear();
  }
  fs::path aside;
  if (!files.empty()) {
    aside = new_folder(folder / "former", name_of(at.stage));
    MadeRecord former = before.value_or(MadeRecord{});
    former.stage = name_of(at.stage);
    if (!before) former.burin = "unknown";
    for (const auto& [name, hash] : hashes_of(loop.project, files, hashes))
      if (const auto made = former.outputs.find(name); made == former.outputs.end() || made->second != hash)
        former.kept.outputs[name] = hash;
    write_record(former, aside / "made.json");
  }
  write_record(begun, record);
  for (const fs::path& file : files) move_to(aside, file, folder);
  return aside;
}

fs::path restore_former(const LoopProject& loop, const StageOfRound& at, const MadeRecord& begun,
                        ContentHashes& hashes) {
  if (at.stage != StageKind::design && at.stage != StageKind::calibrate && at.stage != StageKind::refine) return {};
  const fs::path folder = folder_of(loop.project, at);
  if (!fs::is_directory(folder / "former")) return {};
  fs::path aside;
  std::optional<MadeRecord> record;
  std::vector<std::pair<fs::path, fs::path>> files;
  for (const auto& entry : fs::directory_iterator(folder / "former")) {
    if (!is_former(entry.path(), at.stage) || entry.path() < aside) continue;
    const std::optional<MadeRecord> former = read_record(entry.path() / "made.json");
    if (!former || !is_the_same(*former, begun)) continue;
    std::vector<std::pair<fs::path, fs::path>> found = whole_files(*former, entry.path(), loop, folder, hashes);
    if (found.empty()) continue;
    aside = entry.path();
    record = former;
    files = std::move(found);
  }
  if (!record) return {};
  // Copied first, and removed after the record: an interruption leaves the former result complete.
  for (const auto& [file, place] : files) {
    make_output_folder(place.parent_path());
    copy_whole(file, place);
  }
  record->kept = {};
  write_record(*record, record_file(loop.project, at));
  fs::remove_all(aside);
  return aside;
}

void remove_half_written(const Project& project) {
  clear_leftovers(project.folder);
  for (int round = 1; round <= project.rounds(); ++round)
    for (const char* folder : {"", "made", "design", "calibration", "refinement"})
      clear_leftovers(project.round(round) / folder);
}

}  // namespace burin
