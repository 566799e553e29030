#include "burin/base/files/write_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>

#include "burin/base/error.h"
#include "burin/base/files/descriptor.h"
#include "burin/base/files/file_error.h"
#include "burin/base/files/files_together.h"
#include "burin/base/files/named_paths.h"
#include "burin/base/files/part_file.h"
#include "burin/base/files/unfinished.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

int result_output = -1;

FilePlace place_to_write(const fs::path& file) {
  FilePlace place = find_place(file);
  // Part files of an unsettled change are no leftovers.
  if (settle_changes(place.file)) clear_leftovers_once(place.folder());
  // An interrupted change may just have put it there.
  return find_place(file);
}

void put_in_place(const FilePlace& place, const fs::path& part, bool durable) {
  try {
    fail_if_other_kind(place.named, place.file, part);
  } catch (...) {
    remove_part(part);
    throw;
  }
  allow_change_of(place.file);
  if (joins_change(place, part)) return;
  const auto whole = finishing();
  if (std::rename(part.c_str(), place.file.c_str()) != 0) {
    const int error = errno;
    remove_part(part);
    fail_with(place.named, "cannot be written", error);
  }
  forget_part(part);
  note_written(place.named);
  if (durable) sync_folder(place.folder());
}

}  // namespace

void write_file(std::string_view bytes, const fs::path& file, Durability durability, const CheckFile& check) {
  if (file == "-" && result_output >= 0) {
    const int error = write_all(result_output, bytes);
    if (error != 0) fail_with("standard output", "could not be written whole", error);
    return;
  }
  const FilePlace place = place_to_write(file);
  const bool durable = durability == Durability::on_disk;
  const fs::path part = write_part(place, bytes, durable);
  if (check) try {
      check(part);
    } catch (...) {
      remove_part(part);
      throw;
    }
  put_in_place(place, part, durable);
}

void write_atomically(const fs::path& file, const std::function<void(const fs::path&)>& write) {
  const FilePlace place = place_to_write(file);
  const fs::path part = write_part(place, "", false);
  try {
    write(part);
    sync_part(place, part);
  } catch (...) {
    remove_part(part);
    throw;
  }
  put_in_place(place, part, true);
}

void set_result_output(int descriptor) { result_output = descriptor; }

void write_text(const std::string& text, const fs::path& file) { write_file(text, file); }

void copy_whole(const fs::path& from, const fs::path& to) {
  const FilePlace place = place_to_write(to);
  put_in_place(place, copy_part(as_written(from), place), true);
}

void remove_file(const fs::path& file) {
  std::error_code error;
  if (!fs::exists(fs::symlink_status(file, error))) return;
  FilePlace place;
  place.named = place.file = file;  // the link is removed, not its target
  const fs::path folder = fs::canonical(place.folder(), error);
  if (!error) fail_if_led_outside(file, folder / file.filename());
  place.there = true;
  if (joins_change(place, {})) return;
  if (::unlink(file.c_str()) != 0 && errno != ENOENT) fail_with(file, "cannot be removed", errno);
}

}  // namespace burin
