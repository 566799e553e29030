// tools/loop/round_lamps.h - a round's photos: the lamps that they are taken under, the folders of photos/ that tell
// which was on (photos/red/ and so on where there are several, burin/capture/lamp_folders.h), and whether they are
// those of another round.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tools/content_hash.h"
#include "tools/project.h"

namespace burin {

/// The lamps that a round's board is to be photographed under, one by one: those of its design. Nothing where the round
/// has no design yet. Throws Error for a design or a bench that cannot be read.
std::vector<std::string> lamps_of_round(const Project& project, int round);

/// The photos of a round, those in its lamps' folders too, in the order of their paths.
std::vector<std::filesystem::path> photos_of_round(const Project& project, int round);

/// The photos of the project's other rounds, "round-01/photos/IMG_1.JPG" by content_hash(): as recorded when they were
/// measured, or as they lie there.
std::map<std::string, std::string> photos_of_other_rounds(const Project& project, int round, ContentHashes& hashes);

/// Throws Error if a folder of photos is that of a project's round and holds photos, byte for byte, of another one.
void refuse_photos_of_other_rounds(const std::filesystem::path& photos);

/// Where a round's photos go: "round-01/photos", or "round-01/photos/red and round-01/photos/green, each photo into the
/// folder of the lamp that shone on it alone".
std::string photo_folders_in_words(const Project& project, int round);

/// The bench that names the lamps of a round's photos: the one before that round or, where a person has added a lamp to
/// the project's own (one that was put somewhere for a photo), that one.
std::filesystem::path bench_of_photos(const Project& project, int round);

/// What `burin capture` is to be told of the lamp of photos that lie in no lamp's folder: nothing where its bench
/// tells, or where nobody knows.
std::vector<std::string> lamp_arguments(const Project& project, int round);

/// Makes the folder that a round's photos are put into and, where it is to be photographed under several lamps, theirs.
void make_photo_folders(const Project& project, int round);

/// Removes those that are empty.
void remove_empty_lamp_folders(const Project& project, int round);

/// Puts a simulated camera's photos into the folders of their lamps, where its session has several: as a person would.
/// `simulated`: the folder of session.json and photos/.
void sort_by_lamp(const std::filesystem::path& simulated);

}  // namespace burin
