// burin/capture/same_shot.h - one photo per shot. Cameras, phones and people keep one exposure of the sensor in several
// files: raw and JPEG, HEIC and JPEG, an edited version, a copy. Two of them in a session would count as two
// measurements, possibly with different tone curves.
//
// Bytes, time and exposure in EXIF, and pixels decide which files belong together. Names only help to choose the kept
// file. Photos of a burst or a bracket share a second, but not all of these.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "burin/base/finding.h"
#include "burin/capture/exif.h"
#include "burin/capture/incoming_photo.h"
#include "burin/capture/photo_look.h"
#include "burin/capture/session.h"

namespace burin {

/// Removes other files of the same shot, as headers, names and bytes show them, with a finding each. These are files
/// with equal bytes, and a JPEG or HEIC with the stem of a raw file whose EXIF does not contradict it. Equal bytes in
/// the folders of two lamps are an error.
void pass_over_copies(std::vector<IncomingPhoto>& photos, std::vector<Finding>& findings);

/// Finds photos of another photo's shot by EXIF and pixels: true for those to leave out, with a finding each. `photos`
/// and `looks` belong together; photos without a look stay.
std::vector<bool> twins_of(const std::vector<std::pair<Photo, Exif>>& photos,
                           const std::vector<std::optional<PhotoLook>>& looks, std::vector<Finding>& findings);

/// A new photo and an earlier one of the same shot.
struct SharedShot {
  std::size_t with = 0;        ///< index of the earlier photo
  bool newcomer_goes = false;  ///< the new photo is left out, else the earlier one
  Finding said;                ///< finding about the omitted photo
};

/// Applies the rules above. `look_of` returns the looks of photos with inconclusive headers.
std::optional<SharedShot> find_shared_shot(const IncomingPhoto& newcomer, const std::vector<IncomingPhoto>& others,
                                           const std::function<PhotoLook(const Photo&)>& look_of);

/// True if time, exposure and camera in two EXIF headers may belong to one shot. A time to the second agrees with one
/// to its fraction; a missing value contradicts nothing.
bool may_be_one_shot(const Exif& a, const Exif& b);

}  // namespace burin
