// burin/capture/preflight.h - checks of a session's photos before any solve.
//
// - Errors: unreadable photos, differing sizes, rotated files, another camera, another focal length, no tag of the
// board in any photo.
// - Warnings about exposure: much of a view clipped in every exposure, the tags' paper among it; no bright enough
// exposure; blur; another aperture; exposures in contradiction to EXIF.
// - Warnings about geometry: a camera in motion within a view; too few views; views with few or small tags; a board
// with little of the frame, or seen from one side only; a photo with another focal length or focus.
// - Notes: files with an EXIF orientation (pixels stay as the sensor had them).
#pragma once

#include <span>
#include <vector>

#include "burin/base/finding.h"
#include "burin/base/progress.h"
#include "burin/capture/exif.h"
#include "burin/capture/photo_look.h"
#include "burin/capture/session.h"

namespace burin {

/// Judges photos from their looks; `exif` and `looks` have one entry per photo of the session. `tags` are the tags of
/// the search.
std::vector<Finding> preflight(const Session& session, std::span<const Exif> exif, std::span<const PhotoLook> looks,
                               const TagSet& tags);

/// Checks a session read from its manifest, board included. Unreadable photos are findings, and nothing else is judged
/// then.
std::vector<Finding> preflight(const Session& session, const Progress& progress = {});

}  // namespace burin
