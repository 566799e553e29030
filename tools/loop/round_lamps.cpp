#include "tools/loop/round_lamps.h"

#include <algorithm>

#include "burin/base/error.h"
#include "burin/base/files/input_file.h"
#include "burin/base/files/json_file.h"
#include "burin/base/files/named_paths.h"
#include "burin/base/limits.h"
#include "burin/capture/exif.h"
#include "burin/capture/lamp_folders.h"
#include "burin/capture/session.h"
#include "burin/optimize/design_file.h"
#include "burin/scene/bench.h"
#include "tools/loop/record.h"
#include "tools/photographed_lamps.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

// Returns the lamps of a bench. An unreadable one gives none: its user reports the error.
std::vector<std::string> lamps_named(const fs::path& bench) {
  std::vector<std::string> out;
  if (!fs::is_regular_file(bench)) return out;
  const Json json = Json::parse(read_bytes(bench, limit::kJsonBytes, "a JSON file"), nullptr, false);
  if (!json.is_object() || !json.contains("lights") || !json["lights"].is_array()) return out;
  for (const Json& light : json["lights"])
    if (light.is_object() && light.contains("id") && light["id"].is_string() && !light.contains("sun") &&
        !light.contains("surroundings"))
      out.push_back(light["id"].get<std::string>());
  return out;
}

void add_photos(const fs::path& folder, std::vector<fs::path>& photos) {
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_regular_file() && entry.path().filename().string().front() != '.' && is_photo(entry.path()))
      photos.push_back(entry.path());
}

fs::path photos_folder(const Project& project, int round) { return project.round(round) / "photos"; }

}  // namespace

std::vector<std::string> lamps_of_round(const Project& project, int round) {
  const fs::path design = project.round(round) / "design.json";
  if (!fs::exists(design)) return {};
  const DesignSpec spec = read_design(design);
  return photographed_lamps(spec, read_bench(spec.bench));
}

fs::path bench_of_photos(const Project& project, int round) {
  fs::path before = project.bench_before(round), own = project.folder / "bench.json";
  if (round == 1) return before;
  const std::vector<std::string> known = lamps_named(before), listed = lamps_named(own);
  const bool more = std::any_of(listed.begin(), listed.end(), [&](const std::string& lamp) {
    return std::find(known.begin(), known.end(), lamp) == known.end();
  });
  return more ? own : before;
}

std::vector<fs::path> photos_of_round(const Project& project, int round) {
  std::vector<fs::path> photos;
  const fs::path folder = photos_folder(project, round);
  if (!fs::is_directory(folder)) return photos;
  add_photos(folder, photos);
  for (const LampFolder& lamp : lamp_folders(folder, lamps_named(bench_of_photos(project, round))))
    add_photos(lamp.folder, photos);
  std::sort(photos.begin(), photos.end());
  return photos;
}

std::map<std::string, std::string> photos_of_other_rounds(const Project& project, int round, ContentHashes& hashes) {
  std::map<std::string, std::string> out;
  for (int other = 1; other <= project.rounds(); ++other) {
    if (other == round) continue;
    const std::string within = photos_folder(Project{}, other).generic_string() + "/";
    const auto record = read_record(project.round(other) / "made" / "capture.json");
    if (record)
      for (const auto& [name, hash] : record->inputs)
        if (name.starts_with(within)) out.try_emplace(hash, name);
    if (!record)
      for (const fs::path& photo : photos_of_round(project, other))
        out.try_emplace(hashes.of(photo), path_in_project(project.folder, photo));
  }
  return out;
}

void refuse_photos_of_other_rounds(const fs::path& photos) {
  const fs::path folder = fs::absolute(photos).lexically_normal();
  const fs::path at = folder.has_filename() ? folder : folder.parent_path();
  const Project project{at.parent_path().parent_path()};
  int round = 1;
  while (round <= project.rounds() && project.round(round) != at.parent_path()) ++round;
  if (at.filename() != "photos" || round > project.rounds() || project.rounds() < 2) return;
  ContentHashes hashes;
  const auto others = photos_of_other_rounds(project, round, hashes);
  std::vector<fs::path> known;
  for (const fs::path& photo : photos_of_round(project, round))
    if (others.contains(hashes.of(photo))) known.push_back(photo);
  if (known.empty()) return;
  const std::string first = others.at(hashes.of(known.front()));
  fail((photos / known.front().lexically_relative(at)).string(),
       "is, byte for byte, " + first +
           (known.size() == 1 ? ""
                              : ", and " + std::to_string(known.size() - 1) + " more are photos of other rounds too"),
       "they show another board: take them out, and put photos of this round's board there");
}

std::string photo_folders_in_words(const Project& project, int round) {
  const fs::path folder = photos_folder(project, round);
  std::vector<std::string> lamps;
  try {
    lamps = lamps_of_round(project, round);
  } catch (const Error&) {  // the user of the design or its bench reports the error
  }
  if (lamps.size() < 2) return folder.string();
  return lamp_folders_in_words(folder, lamps) + ", each into that of the lamp that shone on it alone";
}

std::vector<std::string> lamp_arguments(const Project& project, int round) {
  if (lamps_named(bench_of_photos(project, round)).size() < 2) return {};
  const std::vector<std::string> lamps = lamps_of_round(project, round);
  if (lamps.size() != 1) return {};
  return {"--lamp", lamps.front()};
}

void make_photo_folders(const Project& project, int round) {
  const std::vector<std::string> lamps = lamps_of_round(project, round);
  const fs::path folder = photos_folder(project, round);
  make_output_folder(folder);
  if (lamps.size() < 2) return;
  for (const std::string& lamp : lamps) make_output_folder(lamp_folder(folder, lamp, lamps));
}

void remove_empty_lamp_folders(const Project& project, int round) {
  const fs::path folder = photos_folder(project, round);
  for (const LampFolder& lamp : lamp_folders(folder, lamps_named(bench_of_photos(project, round))))
    if (fs::is_empty(lamp.folder)) fs::remove(lamp.folder);
}

void sort_by_lamp(const fs::path& simulated) {
  const fs::path file = simulated / "session.json";
  if (!fs::exists(file)) return;
  const Session session = read_session(file);
  std::vector<std::string> lamps;
  for (const Photo& photo : session.photos)
    if (std::find(lamps.begin(), lamps.end(), photo.light) == lamps.end()) lamps.push_back(photo.light);
  if (lamps.size() < 2) return;
  const fs::path photos = fs::weakly_canonical(simulated / "photos");
  for (const Photo& photo : session.photos) {
    if (fs::weakly_canonical(photo.file).parent_path() != photos) continue;  // in a folder already
    const fs::path folder = lamp_folder(photos, photo.light, lamps);
    make_output_folder(folder);
    const fs::path name = photo.file.filename();
    fs::rename(photo.file, folder / name);
    note_moved(simulated / "photos" / name, simulated / "photos" / folder.filename() / name);
  }
}

}  // namespace burin
