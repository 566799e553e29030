// burin/capture/preflight.h - what is wrong with a session's photos, before anything is solved from them.
//
// Errors: photos that cannot be read, sizes that differ, files that were rotated, another camera, another focal
// length, no tag of the board's in any photo.
// Warnings: much of a view clipped in every exposure, the tags' paper among it, no exposure that is bright enough,
// blur, another aperture, exposures that contradict their EXIF, a camera that moved within a view, too few views; views
// with few or small tags, a board that fills little of the frame or is always seen from one side, a photo that another
// focal length or focus explains better.
// Notes: files with an EXIF orientation (pixels stay as the sensor had them).
#pragma once

#include <span>
#include <vector>

#include "burin/base/finding.h"
#include "burin/base/progress.h"
#include "burin/capture/exif.h"
#include "burin/capture/photo_look.h"
#include "burin/capture/session.h"

namespace burin {

/// Judges photos that have been looked at; `exif` and `looks` have one entry a photo of the session. `tags`: those that
/// the photos were searched for.
std::vector<Finding> preflight(const Session& session, std::span<const Exif> exif, std::span<const PhotoLook> looks,
                               const TagSet& tags);

/// The same for a session that was read from its manifest, board included. Photos that cannot be read are among the
/// findings, and then nothing else is judged.
std::vector<Finding> preflight(const Session& session, const Progress& progress = {});

}  // namespace burin
