// burin/base/finding.h - a diagnostic for people; all libraries return diagnostics in this form.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace burin {

/// Kind of a diagnostic, for programs. docs/json.md lists the codes, and a test compares them.
enum class FindingCode {
  area_covered,
  area_lamp,
  ball,
  blacks_lifted,
  board_shape,
  board_unconfirmed,
  camera_changed,
  camera_colors,
  camera_moved,
  camera_settings,
  carve_time,
  color_unmeasured,
  colors_mixed,
  coupon_cell,
  coupon_place,
  coverage,
  crossings_ignored,
  depth_chosen,
  depth_rounded,
  depth_uncertain,
  direction_light,
  encoding,
  exif,
  exposure,
  face_followed,
  face_uneven,
  feed_unreached,
  file_ignored,
  frame,
  gcode_differs,
  gcode_unsafe,
  glossy_paper,
  groove_profile,
  groove_variation,
  hang_height,
  keep_out_height,
  label_omitted,
  lamp_angle,
  lamp_differs,
  lamp_folder,
  lamp_moved,
  lamp_moves,
  lamp_unexplained,
  layers,
  lens_weak,
  machine_errors,
  machine_travel,
  mesh_stretched,
  model_misfit,
  old_name,
  old_version,
  outdated,
  outliers_omitted,
  page_shortened,
  parameter_at_bound,
  parameter_undetermined,
  photo_copy,
  photo_omitted,
  photo_quality,
  photo_unusable,
  picture,
  picture_pixels,
  position_changed,
  probe_drift,
  recorded,
  region_omitted,
  response_curve,
  scratch_count,
  scratches_changed,
  settings,
  start_cut_short,
  stray_light,
  tags_misplaced,
  tags_omitted,
  tags_small,
  tags_unread,
  value_assumed,
  view_hidden,
  view_limit,
  views_collide,
  views_undecided,
  wall_board,
  wrong_board,
  wrong_grooves
};

/// A code as programs read it, and its meaning.
struct FindingCodeText {
  FindingCode code;
  const char *name, *meaning;
};

/// All codes, in the order of the enumeration.
std::span<const FindingCodeText> finding_codes();

/// "photo-omitted"
const char* name_of(FindingCode code);

/// Note: nothing to do. Warning: the result may be worse. Error: the work stopped, or its result must not be carved.
struct Finding {
  /// Severity of a diagnostic.
  enum class Severity { note, warning, error };
  FindingCode code;
  Severity severity = Severity::warning;
  std::filesystem::path file;  ///< the photo, or another file; empty for the whole work
  std::string what, remedy;    ///< clauses without a full stop
  std::string field = {};      ///< key of the file ("tags.sigma_mm") or option; empty if there is none
};

/// "note", "warning" or "error", as people and programs read it.
const char* in_words(Finding::Severity severity);

/// A warning about the whole work.
Finding make_warning(FindingCode code, std::string what, std::string remedy = "");

/// A note about the whole work.
Finding make_note(FindingCode code, std::string what, std::string remedy = "");

/// "photos/IMG_1.JPG: what; remedy"
std::string sentence(const Finding& finding);

bool has_errors(const std::vector<Finding>& findings);

/// Appends `more` to `findings`.
void append(std::vector<Finding>& findings, const std::vector<Finding>& more);

}  // namespace burin
