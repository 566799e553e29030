#include "burin/base/finding.h"

#include <algorithm>
#include <utility>

#include "burin/base/files/printable.h"

namespace burin {
namespace {

constexpr FindingCodeText kFindingCodes[] = {
    {FindingCode::area_covered, "area-covered", "Keep-outs and tags take a part of the carve area."},
    {FindingCode::area_lamp, "area-lamp", "A lamp is an area light; its size is estimated."},
    {FindingCode::ball, "ball", "The mirror ball's photos determine directions or brightness badly."},
    {FindingCode::blacks_lifted, "blacks-lifted", "A picture's black was raised to a tone that the light can show."},
    {FindingCode::board_shape, "board-shape", "The board is not flat, and its G-code is for the flat sheet."},
    {FindingCode::board_unconfirmed, "board-unconfirmed",
     "The photos are too coarse to confirm that they show this board."},
    {FindingCode::camera_changed, "camera-changed",
     "Camera, zoom, focus, crop or picture size differ among the photos."},
    {FindingCode::camera_colors, "camera-colors", "Demosaicing or chroma subsampling distorts the glints."},
    {FindingCode::camera_moved, "camera-moved", "The camera moved within a bracket, or between lamps."},
    {FindingCode::camera_settings, "camera-settings",
     "The camera changes its pictures: white balance, sharpening, tone mapping, flash, aperture."},
    {FindingCode::carve_time, "carve-time", "Carving takes longer than the given time."},
    {FindingCode::color_unmeasured, "color-unmeasured", "No photo determines a color."},
    {FindingCode::colors_mixed, "colors-mixed", "The lamps of a view limit its colors."},
    {FindingCode::coupon_cell, "coupon-cell", "Some grooves of a coupon could not be measured."},
    {FindingCode::coupon_place, "coupon-place", "The coupon lies in the board's carve area."},
    {FindingCode::coverage, "coverage", "The photos cover too few places, directions or parts of the frame."},
    {FindingCode::crossings_ignored, "crossings-ignored",
     "Light was added where grooves cross, although a cutter leaves only the lower groove."},
    {FindingCode::depth_chosen, "depth-chosen",
     "The design's depth was chosen from a measurement or a machine's table."},
    {FindingCode::depth_rounded, "depth-rounded", "The coordinates' decimals round the depth."},
    {FindingCode::depth_uncertain, "depth-uncertain",
     "The groove depth on this machine is a guess, or differs from a measurement."},
    {FindingCode::direction_light, "direction-light", "Light from many directions lowers the contrast."},
    {FindingCode::encoding, "encoding", "A photo's tone curve or color space is assumed or unknown."},
    {FindingCode::exif, "exif", "EXIF lacks exposure facts, or they contradict the pictures."},
    {FindingCode::exposure, "exposure", "Photos are clipped or dark: add other exposures."},
    {FindingCode::face_followed, "face-followed", "The tool's height follows a height map or a measured warp."},
    {FindingCode::face_uneven, "face-uneven", "The sheet's unevenness changes the depth, or is unknown."},
    {FindingCode::feed_unreached, "feed-unreached", "Short scratches do not reach the feed."},
    {FindingCode::file_ignored, "file-ignored", "A file or folder next to the photos is not used."},
    {FindingCode::frame, "frame", "The air run around the job is missing, or belongs to another job."},
    {FindingCode::gcode_differs, "gcode-differs", "The G-code does not carve the designed scratches."},
    {FindingCode::gcode_unsafe, "gcode-unsafe", "The G-code can damage tool, clamps or sheet."},
    {FindingCode::glossy_paper, "glossy-paper", "The tags' paper has a glossy coating, which was estimated."},
    {FindingCode::groove_profile, "groove-profile", "The cross-section differs from the paper's profile."},
    {FindingCode::groove_variation, "groove-variation", "Grooves differ from one another."},
    {FindingCode::hang_height, "hang-height",
     "The board's height on the wall suits the viewpoints badly, or was chosen."},
    {FindingCode::keep_out_height, "keep-out-height", "The height of a keep-out is unknown, so G-code is refused."},
    {FindingCode::label_omitted, "label-omitted", "The coupon's label was left out."},
    {FindingCode::lamp_angle, "lamp-angle",
     "Lamp and viewpoint suit the grooves badly: too steep, or near the mirror direction."},
    {FindingCode::lamp_differs, "lamp-differs", "Photos under one lamp are lit differently."},
    {FindingCode::lamp_folder, "lamp-folder", "A folder names no lamp, or a photo lies in no lamp's folder."},
    {FindingCode::lamp_moved, "lamp-moved", "A lamp was moved during the session."},
    {FindingCode::lamp_moves, "lamp-moves", "The lamp moves with the camera."},
    {FindingCode::lamp_unexplained, "lamp-unexplained", "No lamp explains the brightness of paper and face."},
    {FindingCode::layers, "layers", "A drawing puts depths on layers."},
    {FindingCode::lens_weak, "lens-weak", "The photos determine the lens badly."},
    {FindingCode::machine_errors, "machine-errors", "Backlash or screw errors of the machine were estimated."},
    {FindingCode::machine_travel, "machine-travel", "The machine's travel is unknown, so its limits are unchecked."},
    {FindingCode::mesh_stretched, "mesh-stretched", "The mesh stretches the flat board."},
    {FindingCode::model_misfit, "model-misfit", "Residuals contradict the model; sigmas are larger."},
    {FindingCode::old_name, "old-name", "An option has a new name."},
    {FindingCode::old_version, "old-version", "A file has an older version, which lacks information."},
    {FindingCode::outdated, "outdated", "A file is older than its inputs."},
    {FindingCode::outliers_omitted, "outliers-omitted", "Contradictory tag corners are left out."},
    {FindingCode::page_shortened, "page-shortened", "A page leaves something out, or shows it in a simpler form."},
    {FindingCode::parameter_at_bound, "parameter-at-bound",
     "An estimate ran to the end of its range, so it is not determined."},
    {FindingCode::parameter_undetermined, "parameter-undetermined",
     "The photos determine a parameter weakly or not at all."},
    {FindingCode::photo_copy, "photo-copy", "A photo is a copy or another version of one that is used."},
    {FindingCode::photo_omitted, "photo-omitted", "A photo or a view is left out."},
    {FindingCode::photo_quality, "photo-quality", "A photo is blurred, soft, or near the lamp's mirror image."},
    {FindingCode::photo_unusable, "photo-unusable", "A photo cannot be read or used."},
    {FindingCode::picture, "picture", "A target picture is small, dark, bright, cropped or used twice."},
    {FindingCode::picture_pixels, "picture-pixels", "The size of the pictures was chosen."},
    {FindingCode::position_changed, "position-changed",
     "A view or a lamp was photographed at another place than designed."},
    {FindingCode::probe_drift, "probe-drift", "The probe's zero moved while it measured the sheet."},
    {FindingCode::recorded, "recorded", "A result's own note or warning, from the command that wrote it."},
    {FindingCode::region_omitted, "region-omitted", "A region that does not look like the board is left out."},
    {FindingCode::response_curve, "response-curve",
     "Brackets determine the camera's response curve badly, or not at all."},
    {FindingCode::scratch_count, "scratch-count",
     "The number of scratches was changed, or does not suit the pictures."},
    {FindingCode::scratches_changed, "scratches-changed", "Scratches were moved or left out for the machine's limits."},
    {FindingCode::settings, "settings", "A command takes a value from its project, or differs from it."},
    {FindingCode::start_cut_short, "start-cut-short",
     "The design, or its search for initial scratches, was ended early."},
    {FindingCode::stray_light, "stray-light", "There is a light beside the lamp; it was estimated."},
    {FindingCode::tags_misplaced, "tags-misplaced", "Tags lie elsewhere than board.json has them."},
    {FindingCode::tags_omitted, "tags-omitted", "A tag is not used in some photos."},
    {FindingCode::tags_small, "tags-small", "Tags are small in the photos."},
    {FindingCode::tags_unread, "tags-unread", "Tags that should be visible cannot be read."},
    {FindingCode::value_assumed, "value-assumed", "A missing value was assumed."},
    {FindingCode::view_hidden, "view-hidden", "A part of the board is not visible or not lit in a view."},
    {FindingCode::view_limit, "view-limit", "A view's quality and its causes."},
    {FindingCode::views_collide, "views-collide", "Scratches of one view show in another (crosstalk)."},
    {FindingCode::views_undecided, "views-undecided", "The photos of the designed views are not decided."},
    {FindingCode::wall_board, "wall-board", "A board of a wall failed, or waits for an answer."},
    {FindingCode::wrong_board, "wrong-board", "A photo shows another board."},
    {FindingCode::wrong_grooves, "wrong-grooves", "Photos show other grooves than the scratches of board.json."},
};

}  // namespace

std::span<const FindingCodeText> finding_codes() { return kFindingCodes; }

const char* name_of(FindingCode code) { return kFindingCodes[static_cast<std::size_t>(code)].name; }

const char* in_words(Finding::Severity severity) {
  switch (severity) {
    case Finding::Severity::note:
      return "note";
    case Finding::Severity::warning:
      return "warning";
    case Finding::Severity::error:
      break;
  }
  return "error";
}

Finding make_warning(FindingCode code, std::string what, std::string remedy) {
  return {code, Finding::Severity::warning, {}, std::move(what), std::move(remedy)};
}

Finding make_note(FindingCode code, std::string what, std::string remedy) {
  return {code, Finding::Severity::note, {}, std::move(what), std::move(remedy)};
}

std::string sentence(const Finding& finding) {
  return printable((finding.file.empty() ? "" : finding.file.string() + ": ") + finding.what +
                   (finding.remedy.empty() ? "" : "; " + finding.remedy));
}

bool has_errors(const std::vector<Finding>& findings) {
  return std::any_of(findings.begin(), findings.end(),
                     [](const Finding& f) { return f.severity == Finding::Severity::error; });
}

void append(std::vector<Finding>& findings, const std::vector<Finding>& more) {
  findings.insert(findings.end(), more.begin(), more.end());
}

}  // namespace burin
