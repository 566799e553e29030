// tools/loop/round_lamps.h - photos of a round and their lamps. Each of several lamps has its own folder in photos/
// (photos/red/, burin/capture/lamp_folders.h). A check finds photos of other rounds.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tools/content_hash.h"
#include "tools/project.h"

namespace burin {

/// Returns the lamps for photos of a round's board: those of its design, one by one. Returns nothing for a round
/// without a design. Throws Error for an unreadable design or bench.
std::vector<std::string> lamps_of_round(const Project& project, int round);

/// Returns the photos of a round, including those in its lamps' folders, in the order of their paths.
std::vector<std::filesystem::path> photos_of_round(const Project& project, int round);

/// Returns the photos of the project's other rounds, such as "round-01/photos/IMG_1.JPG", by content_hash(). They come
/// from the records of the measurements, or from the folders.
std::map<std::string, std::string> photos_of_other_rounds(const Project& project, int round, ContentHashes& hashes);

/// Throws Error if a folder belongs to a round and holds photos, byte for byte, of another round.
void refuse_photos_of_other_rounds(const std::filesystem::path& photos);

/// Returns the folders for a round's photos: "round-01/photos", or "round-01/photos/red and round-01/photos/green, ..."
/// if there are several lamps.
std::string photo_folders_in_words(const Project& project, int round);

/// Returns the bench with the lamps of a round's photos: the one before that round. If the user added a lamp for a
/// photo to the project's own bench, returns that one.
std::filesystem::path bench_of_photos(const Project& project, int round);

/// Returns the lamp options of `burin capture` for photos outside of lamp folders. Returns nothing if the bench
/// determines the lamp, or if it is unknown.
std::vector<std::string> lamp_arguments(const Project& project, int round);

/// Makes the folder for a round's photos, with one subfolder per lamp if there are several.
void make_photo_folders(const Project& project, int round);

/// Removes empty lamp folders.
void remove_empty_lamp_folders(const Project& project, int round);

/// Moves a simulated camera's photos into the folders of their lamps, if its session has several. `simulated`: the
/// folder of session.json and photos/.
void sort_by_lamp(const std::filesystem::path& simulated);

}  // namespace burin
