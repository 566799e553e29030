// burin/capture/same_shot.h - one photo per shot. Cameras, phones and people keep one exposure of the sensor in several
// files: raw beside JPEG, HEIC beside JPEG, an edited version, a copy. Two of them in a session would count as two
// measurements, of which one may have a tone curve that the other has not.
//
// Which files belong together is decided by their bytes, by the time and exposure in their EXIF, and by their pixels.
// Names only help to choose which file is kept. Photos of a burst or a bracket share a second, but not all of these.
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

/// Takes out, with a finding each, what headers, names and bytes show to be another file's shot: a file with the same
/// bytes, and a JPEG or HEIC beside a raw file of its stem whose EXIF does not contradict it. The same bytes in the
/// folders of two lamps are an error.
void pass_over_copies(std::vector<IncomingPhoto>& photos, std::vector<Finding>& findings);

/// The photos that show another photo's shot by EXIF and pixels: true for those to leave out, with a finding each.
/// `photos` and `looks` belong together; photos without a look stay.
std::vector<bool> twins_of(const std::vector<std::pair<Photo, Exif>>& photos,
                           const std::vector<std::optional<PhotoLook>>& looks, std::vector<Finding>& findings);

/// A photo that comes to others one by one, and one of these that shows the same shot.
struct SharedShot {
  std::size_t with = 0;        ///< which of the others
  bool newcomer_goes = false;  ///< the photo that came is left out, else the other one
  Finding said;                ///< of the one that is left out
};

/// By the same rules as above. `look_of` is asked for the looks of photos that headers leave open.
std::optional<SharedShot> find_shared_shot(const IncomingPhoto& newcomer, const std::vector<IncomingPhoto>& others,
                                           const std::function<PhotoLook(const Photo&)>& look_of);

/// Whether time, exposure and camera in two files' EXIF may be those of one shot. A time to the second agrees with
/// one to its fraction; a value that a file lacks contradicts nothing.
bool may_be_one_shot(const Exif& a, const Exif& b);

}  // namespace burin
