// Report of a calibrated session: prediction and photo side by side, tags and residuals, parameters with uncertainties.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <mutex>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "burin/base/degrees.h"
#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/files/svg.h"
#include "burin/calib/predicted_photo.h"
#include "burin/calib/verdict/effect_findings.h"
#include "burin/capture/photo.h"
#include "burin/capture/session.h"
#include "burin/render/brdf.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/board_face.h"
#include "burin/scene/footprint_grid.h"
#include "burin/scene/groove.h"
#include "burin/scene/parameter_name.h"
#include "burin/scene/scratches.h"
#include "tools/commands.h"
#include "tools/hold_out_file.h"
#include "tools/project.h"
#include "tools/report/bench_section.h"
#include "tools/report/html.h"
#include "tools/report/misfits.h"
#include "tools/report/pictures.h"
#include "tools/report/rectified.h"
#include "tools/report/residuals.h"
#include "tools/report/section.h"

namespace burin {
namespace {

constexpr int kRectifiedSidePx = 420;
constexpr int kPhotoWidthPx = 900;
constexpr double kWhitePercentile = 0.995;  // of the photo: the brightest glints may saturate
constexpr float kDifferenceScale = 0.25F;   // of the displayed white

struct Loaded {
  Session session;
  Board board;
  Bench bench;
  Carved carved;  // with the measured machine error of the bench; empty if the board names no scratches
  ResidualTable residuals;
  HoldOutFile held_out;
};

Surface surface_of(const Loaded& in) { return surface_of(in.board, in.bench); }

Eigen::Vector3d board_center_mm(const Board& board) { return {board.size_mm.x() / 2, board.size_mm.y() / 2, 0}; }

// Clipped in every exposure: brighter than any known value, and excluded from comparisons.
Image with_clipped_infinite(const MergedView& merged) {
  Image out = merged.value;
  for (std::size_t i = 0; i < merged.valid.size(); ++i)
    if (!merged.valid[i])
      for (int c = 0; c < out.channels; ++c) out.data[i * out.channels + c] = std::numeric_limits<float>::infinity();
  return out;
}

struct Agreement {
  double relative_rms = std::numeric_limits<double>::quiet_NaN();  // of photo - predicted, over the photo's own RMS
  double ratio = std::numeric_limits<double>::quiet_NaN();         // mean of photo over mean of predicted
};

Agreement agreement(const Image& photo, const Image& predicted) {
  double squares = 0, photo_squares = 0, photo_sum = 0, predicted_sum = 0;
  for (std::size_t i = 0; i < photo.data.size(); ++i) {
    const double p = photo.data[i], q = predicted.data[i];
    if (!std::isfinite(p) || !std::isfinite(q)) continue;
    squares += (p - q) * (p - q);
    photo_squares += p * p;
    photo_sum += p;
    predicted_sum += q;
  }
  Agreement out;
  if (photo_squares > 0) out.relative_rms = std::sqrt(squares / photo_squares);
  if (predicted_sum > 0) out.ratio = photo_sum / predicted_sum;
  return out;
}

// --- photo beside prediction -----------------------------------------------------------------------------------------

// A photo and its prediction: HTML, and their difference (infinite if it is unknown).
struct PhotoComparison {
  std::string pictures;
  double relative_rms = std::numeric_limits<double>::infinity();
};

std::string percent(double part) { return std::isfinite(part) ? fixed(100 * part, 1) + " %" : "unknown"; }

// Returns the lights of a photo that the bench names. A room without a picture is the bench's ambient light.
std::string known_lights(const Bench& bench, const std::string& joined) {
  std::vector<std::string> known;
  for (const std::string& name : light_names(joined))
    if (std::ranges::find(bench.lights, name, &Light::id) != bench.lights.end()) known.push_back(name);
  return joined_lights(known);
}

PhotoComparison comparison(const Loaded& in, const MergedView& merged, const View& view, const Light& light) {
  const std::string title = "View " + merged.view + (in.bench.lights.size() > 1 ? ", lamp “" + merged.light + "”" : "");
  const Surface surface = surface_of(in);
  const PixelWindow window = carve_window(in.bench, in.board, view);
  if (window.width == 0 || window.height == 0)
    return {"<section class=\"compare\"><h3>" + html(title) +
            "</h3><p>The carve area lies outside this photo.</p></section>\n"};
  const BoardFrame frame = board_frame(in.board.carve_min_mm, in.board.carve_max_mm, kRectifiedSidePx);
  const Image photo =
      rectified(with_clipped_infinite(merged), 0, 0, lens_of(in.bench, view), view.T_camera_board, surface, frame);
  const Image predicted = rectified(predicted_photo(in.bench, in.board, view, light, in.carved,
                                                    {.channels = merged.value.channels, .window = window}),
                                    window.x0, window.y0, lens_of(in.bench, view), view.T_camera_board, surface, frame);
  const float white = percentile(photo, kWhitePercentile);
  const Agreement fit = agreement(photo, predicted);
  const bool clipped = std::any_of(merged.valid.begin(), merged.valid.end(), [](auto v) { return v == 0; });
  const std::string apart = percent(fit.relative_rms);

  const std::vector<Figure> figures{
      {shown(predicted, white), title + ": as the measured bench predicts the photo", "<b>Predicted</b>", "Predicted"},
      {shown(photo, white), title + ": the photo, laid flat, at the same exposure",
       fmt::format("<b>Photo&shy;graphed</b>{}",
                   clipped ? "<span class=\"more\">, white where clipped in every exposure</span>" : ""),
       "Photographed"},
      {difference_shown(photo, predicted, white, kDifferenceScale),
       fmt::format("{}: the difference, {} RMS of the photo's own values", title, apart),
       fmt::format("<b>Difference</b> {}<span class=\"more\"> RMS of the photo's own; mean brightness {} of the "
                   "predicted</span>",
                   unbroken(apart), std::isfinite(fit.ratio) ? fixed(fit.ratio, 3) : "unknown"),
       "Difference"}};
  return {compared(title, figures, 0, 1),
          std::isfinite(fit.relative_rms) ? fit.relative_rms : std::numeric_limits<double>::infinity()};
}

// --- tags and residuals over the photo -------------------------------------------------------------------------------

std::vector<Tag> tags_of(const Loaded& in) { return in.bench.tags.empty() ? in.board.tags.list : in.bench.tags; }

std::string tag_outlines(const Loaded& in, const View& view, const Eigen::Vector2d& corner_px, double scale) {
  const Surface surface = surface_of(in);
  std::string svg;
  for (const Tag& tag : tags_of(in)) {
    std::vector<Eigen::Vector3d> p_camera;
    for (const Eigen::Vector2d& corner : tag_corners_mm(tag))
      p_camera.push_back(view.T_camera_board * above_face(surface, corner.x(), corner.y(), in.board.tags.z_mm));
    if (std::any_of(p_camera.begin(), p_camera.end(), [](const auto& p) { return !(p.z() > 0); })) continue;
    std::vector<Eigen::Vector2d> q_px(p_camera.size());
    project(lens_of(in.bench, view), p_camera, q_px);
    for (Eigen::Vector2d& q : q_px) q = (q - corner_px) * scale;
    svg += svg_polygon(q_px, "fill=\"none\" stroke=\"#19c3ff\" stroke-width=\"1.2\"");
  }
  return svg;
}

// Returns a round scale factor at which a typical residual's arrow is visible.
double arrow_factor(const ResidualTable& residuals) {
  const double rms = residuals.rms_px();
  if (!(rms > 0)) return 100;
  const double wanted = 12 / rms;
  const double decade = std::pow(10, std::floor(std::log10(wanted)));
  return wanted / decade >= 5 ? 5 * decade : wanted / decade >= 2 ? 2 * decade : decade;
}

// Draws all known about the corners over the photo, cropped to the board.
Figure residual_photo(const Loaded& in, const MergedView& merged, const View& view, double factor) {
  PixelWindow window =
      window_of(lens_of(in.bench, view), view.T_camera_board, surface_of(in), {0, 0}, in.board.size_mm, 24);
  if (window.width == 0 || window.height == 0) window = {0, 0, merged.value.width, merged.value.height};
  Image part(window.width, window.height, merged.value.channels);
  for (int y = 0; y < part.height; ++y)
    for (int x = 0; x < part.width; ++x)
      for (int c = 0; c < part.channels; ++c) part.at(x, y, c) = merged.value.at(x + window.x0, y + window.y0, c);
  const int width = std::min(kPhotoWidthPx, part.width);
  const double scale = static_cast<double>(width) / part.width;
  const Image small = resized(part, width, std::max(1, static_cast<int>(std::lround(part.height * scale))));
  const Eigen::Vector2d corner(window.x0, window.y0);

  std::string svg = tag_outlines(in, view, corner, scale);
  for (const ShownResidual& r : in.residuals.corners) {
    if (r.view != view.name) continue;
    const Eigen::Vector2d from = (r.q_px - corner) * scale, to = from + r.residual_px * factor * scale;
    svg += svg_line(from, to,
                    r.left_out ? "stroke=\"#ff3b30\" stroke-width=\"1.6\"" : "stroke=\"#ffcf33\" stroke-width=\"1.6\"");
  }
  std::string told;
  if (view.tags) told += ", " + grouped(*view.tags, "tag");
  if (view.reprojection_rms_px) told += fmt::format(", {:.3f} px RMS per axis", *view.reprojection_rms_px);
  return {shown(small, percentile(small, 0.98)),
          "Photo of view " + view.name + " with its tags and residuals" + told,
          fmt::format("<b>{}</b>{}", html(view.name), told),
          "",
          PictureKind::jpeg,
          svg};
}

// --- numbers ---------------------------------------------------------------------------------------------------------

bool is_determined(const Bench& bench, const std::string& parameter) {
  const Verdict* verdict = find_verdict(bench, parameter);
  return verdict == nullptr || verdict->known();
}

// A cell never shows an undetermined value as if it were measured.
std::string value_cell(const Bench& bench, const std::string& parameter, double value,
                       const std::optional<double>& sigma, const std::string& unit) {
  const std::string space = unit.empty() ? "" : " ";
  if (!is_determined(bench, parameter)) {
    const bool refuted = rests_on(*find_verdict(bench, parameter), Cause::Kind::believed_refuted);
    return fmt::format("<span class=\"unknown\">not known; {}{}{} {}</span>", number(value), space, unit,
                       refuted ? "explains the photos best" : "is believed as before");
  }
  if (sigma) return with_sigma(value, *sigma) + space + unit;
  return number(value) + space + unit;
}

std::string position_cell(const Eigen::Vector3d& p, const std::optional<Eigen::Vector3d>& sigma) {
  if (!sigma) return fmt::format("{:.1f}, {:.1f}, {:.1f} mm", p.x(), p.y(), p.z());
  return fmt::format("{}, {}, {} mm", with_sigma(p.x(), sigma->x()), with_sigma(p.y(), sigma->y()),
                     with_sigma(p.z(), sigma->z()));
}

std::string panel_cell(const LampSize& size) {
  if (!size.panel_sigma_mm) return fmt::format("{:.0f} x {:.0f} mm", size.panel_mm.x(), size.panel_mm.y());
  return fmt::format("{} x {} mm", with_sigma(size.panel_mm.x(), size.panel_sigma_mm->x()),
                     with_sigma(size.panel_mm.y(), size.panel_sigma_mm->y()));
}

std::string numbers(const Loaded& in) {
  const Bench& bench = in.bench;
  const Material& material = bench.material;
  const MaterialSigma& sigma = bench.material_sigma;
  const Material& believed = in.board.material;
  Table out;
  out.header = {"Quantity", "Value", "Believed before", "What is normal"};
  const auto row = [&](const std::string& name, const std::string& value, const std::string& before,
                       const std::string& normal) {
    out.rows.push_back({name, value, before, normal});
  };
  const auto material_row = [&](const char* name, const char* key, double value, const std::optional<double>& s,
                                double before, const std::string& unit, const char* normal) {
    row(name, value_cell(bench, key, value, s, unit), number(before) + (unit.empty() ? "" : " ") + unit, normal);
  };
  material_row("Roughness of the grooves, alpha", parameter::kAlpha, material.alpha, sigma.alpha, believed.alpha, "",
               "0.02 (polished) to 0.12");
  material_row("Depth of the grooves, d", parameter::kDepth, material.depth_um, sigma.depth_um, believed.depth_um, "µm",
               "5 to 30 µm; needs photos whose half vectors straddle the cut-off");
  const double rim = groove_rim(in.board.tool_width_um, material.depth_um);
  const bool depth_known = is_determined(bench, parameter::kDepth);
  row("Half-width of the grooves, w (from d)",
      depth_known ? fixed(in.board.tool_width_um / 2 * rim, 1) + " µm"
                  : "<span class=\"unknown\">unknown, as d is</span>",
      fixed(half_width_um(in.board.tool_width_um, believed.depth_um), 1) + " µm", "");
  row("Cut-off angle, 2 atan(2w / wt)",
      depth_known ? fixed(2 * std::atan(rim) * kRadian_deg, 1) + "°"
                  : "<span class=\"unknown\">unknown, as d is</span>",
      fixed(2 * std::atan(groove_rim(in.board.tool_width_um, believed.depth_um)) * kRadian_deg, 1) + "°",
      "half vectors that lean further give no glint");
  material_row("Roughness of the plain face", parameter::kBaseAlpha, material.base_alpha, sigma.base_alpha,
               believed.base_alpha, "", "0.05 (mirror-like) to 0.3 (brushed)");
  for (const Light& light : bench.lights) {
    if (!light.is_near()) {
      if (light.intensity_sigma)
        row(fmt::format("“{}”: brightness", html(light.id)),
            with_sigma(light.intensity.mean(), light.intensity_sigma->mean()) + " times its picture’s", "",
            "near 1 for a room that was probed with this bench’s camera");
      continue;
    }
    row(fmt::format("Lamp “{}”: position", html(light.id)),
        is_determined(bench, parameter::light_position(light.id))
            ? position_cell(light.position_mm, light.position_sigma_mm)
            : "<span class=\"unknown\">unknown</span>",
        "", "±1 to 10 mm for a lamp a meter away, most of it along the ray to the lamp");
    if (light.falloff_exponent != 0 || light.falloff_exponent_sigma)
      row(fmt::format("Lamp “{}”: fall-off exponent", html(light.id)),
          light.falloff_exponent_sigma ? with_sigma(light.falloff_exponent, *light.falloff_exponent_sigma)
                                       : number(light.falloff_exponent),
          "", "0 is a bare lamp; a spot has 2 to 40");
    if (light.size.disk_mm > 0)
      row(fmt::format("Lamp “{}”: radius of its area", html(light.id)),
          (light.size.disk_sigma_mm ? with_sigma(light.size.disk_mm, *light.size.disk_sigma_mm)
                                    : number(light.size.disk_mm)) +
              " mm",
          light.size.disk_sigma_mm ? "" : "as told", "a bulb has 20 to 50 mm");
    else if (!light.size.is_point())
      row(fmt::format("Lamp “{}”: sides of its area", html(light.id)), panel_cell(light.size),
          light.size.panel_sigma_mm ? "" : "as told", "a panel has 50 to 300 mm");
  }
  row("Bow of the board",
      fmt::format("{}, {}, {} mm", fixed(bench.bow_mm[0], 3), fixed(bench.bow_mm[1], 3), fixed(bench.bow_mm[2], 3)),
      "flat", "below 0.2 mm");
  return table(out);
}

// Returns the effects of metal, machine, paper and light beyond the paper's model.
std::string effects(const Loaded& in) {
  const std::vector<Finding> findings = effect_findings(in.bench, in.board);
  if (findings.empty()) return "";
  std::string out = "<p>Beside that, designs and tool paths made with this bench count on:</p>\n<ul>\n";
  for (const Finding& finding : findings) out += "<li>" + html(sentence(finding)) + "</li>\n";
  return out + "</ul>\n";
}

// Returns every judged parameter with its reason, and the next photo for undetermined ones.
std::string verdicts(const Loaded& in) {
  if (in.bench.verdict.empty()) return "";
  Table out;
  out.header = {"Parameter", "From the photos?", "Why"};
  const bool any_next =
      std::ranges::any_of(in.bench.verdict, [](const auto& v) { return v.second.next_photo.has_value(); });
  if (any_next) out.header.push_back("The photo that would help most");
  std::size_t determined = 0;
  for (const auto& [name, verdict] : in.bench.verdict) {
    determined += verdict.determined() ? 1 : 0;
    out.rows.push_back({html(parameter::in_words(name)),
                        fmt::format("<span class=\"{}\">{}</span>", verdict.determined() ? "good" : "warning",
                                    in_words(verdict.degree)),
                        fmt::format("<span class=\"soft\">{}</span>", html(sentence(verdict)))});
    if (any_next)
      out.rows.back().push_back(verdict.next_photo ? html(sentence(*verdict.next_photo, verdict.unit)) : "");
  }
  return folded(
      "What the photos determine",
      fmt::format("{} of {}", determined, grouped(static_cast<long long>(in.bench.verdict.size()), "parameter")),
      "<p>Each sigma was tested by solving for halves of the photos separately; where they contradict each other "
      "it was made larger, and the table says so.</p>\n" +
          table(out));
}

// Returns the prediction errors of held-out photos and the residuals of used ones.
std::string held_out(const Loaded& in) {
  const HoldOutFile& held = in.held_out;
  std::string out;
  if (held.corners) {
    Table corners;
    corners.header = {"View", "Tags", "Residual when used", "Predicted without it", "What noise alone allows"};
    for (const HeldOutView& v : held.corners->views)
      corners.rows.push_back({html(v.view), std::to_string(v.tags), fmt::format("{:.4f} px", v.fit_rms_px),
                              fmt::format("{:.4f} px", v.held_out_rms_px),
                              fmt::format("{:.4f} px", v.expected_rms_px)});
    corners.rows.push_back({"all", "", fmt::format("{:.4f} px", held.corners->fit_rms_px),
                            fmt::format("{:.4f} px", held.corners->held_out_rms_px),
                            fmt::format("{:.4f} px", held.corners->expected_rms_px)});
    out +=
        "<p>Tag corners: lens, tags and bow were solved without the photo; half its tags gave its pose, the corners "
        "of the other half were predicted.</p>\n" +
        table(corners);
  }
  if (!held.pixels.empty()) {
    Table pixels;
    pixels.header = {"View", "Residual when used", "Predicted without it", "Over noise, used", "Over noise, predicted"};
    for (const HeldOutPhoto& p : held.pixels)
      pixels.rows.push_back({html(p.fit.view), fmt::format("{:.2f} %", 100 * p.fit.residual_rms),
                             fmt::format("{:.2f} %", 100 * p.held_out.residual_rms),
                             fmt::format("{:.2f}", p.fit.residual_to_noise),
                             fmt::format("{:.2f}", p.held_out.residual_to_noise)});
    out +=
        "<p>Pixels: grooves, lamp and machine were fitted without the photo, and its every pixel predicted. A model "
        "that explains what it was fitted to, and no more, shows itself here.</p>\n" +
        table(pixels);
  }
  if (out.empty()) return "";
  return folded("Photos that were held out",
                held.corners ? fmt::format("their corners predicted to {:.3f} px", held.corners->held_out_rms_px)
                             : "how they were predicted",
                out);
}

// Describes the affine machine calibration: scales, rotation, skew, offset, and the largest shift over the carve area.
std::string machine_numbers(const Loaded& in) {
  const Affine2& m = in.bench.machine_affine;
  const auto& s = in.bench.machine_affine_sigma;
  const Eigen::Matrix2d A = m.leftCols<2>();
  const Eigen::Vector2d low = in.board.carve_min_mm, high = in.board.carve_max_mm, middle = (low + high) / 2;
  double largest = 0;
  for (const Eigen::Vector2d& p : {low, high, Eigen::Vector2d(low.x(), high.y()), Eigen::Vector2d(high.x(), low.y())})
    largest = std::max(largest, (A * p + m.col(2) - p).norm());
  const double scale_x = A.col(0).norm(), scale_y = A.col(1).norm();
  const double turn = std::atan2(A(1, 0), A(0, 0));
  const double skew =
      std::acos(std::clamp(A.col(0).dot(A.col(1)) / (scale_x * scale_y), -1.0, 1.0)) - std::numbers::pi / 2;
  const Eigen::Vector2d offset = A * middle + m.col(2) - middle;
  const auto sigma = [&](int r, int c) { return s ? std::optional<double>((*s)(r, c)) : std::nullopt; };
  const auto show = [](double v, const std::optional<double>& sig, double unit) {
    return sig ? with_sigma(v * unit, *sig * unit) : fmt::format("{:.3f}", v * unit);
  };
  Table out;
  out.header = {"Machine", "Measured", "What is normal"};
  out.rows = {
      {"Scale along x", show(scale_x - 1, sigma(0, 0), 1000) + " ‰", "within ±2 ‰"},
      {"Scale along y", show(scale_y - 1, sigma(1, 1), 1000) + " ‰", "within ±2 ‰"},
      {"Turn of the board on the machine", show(turn, sigma(1, 0), kRadian_deg) + "°", "within ±0.1°"},
      {"Skew of the axes", show(-skew, sigma(0, 1), kRadian_deg) + "°", "within ±0.05°"},
      {"Offset at the middle of the carve area", fmt::format("{:.3f}, {:.3f} mm", offset.x(), offset.y()),
       "within ±0.3 mm"},
      {"Largest shift over the carve area", fmt::format("{:.3f} mm", largest), "the next tool path takes it out"}};
  return folded("The machine",
                s ? fmt::format("shifts scratches by at most {:.3f} mm", largest) : "what it does is not measured yet",
                table(out));
}

std::string view_numbers(const Loaded& in) {
  Table out;
  out.header = {
      "View", "Tags", "Residual per axis", "on the board", "Camera's center", "Distance", "Half vector's lean"};
  const Eigen::Vector3d center = board_center_mm(in.board);
  for (const View& view : in.bench.views) {
    const Eigen::Vector3d eye = view.T_camera_board.inverse().translation();
    const double distance = (eye - center).norm();
    const double mm_per_px = in.bench.lens.intrinsics.empty() ? 0 : distance / in.bench.lens.intrinsics[0];
    std::string lean;
    if (!in.bench.lights.empty()) {
      const Eigen::Vector3d h =
          ((in.bench.lights[0].position_mm - center).normalized() + (eye - center).normalized()).normalized();
      lean = fmt::format("{:.1f}°", std::acos(std::clamp(h.z(), -1.0, 1.0)) * kRadian_deg);
    }
    const auto rms = view.reprojection_rms_px;
    out.rows.push_back({html(view.name), view.tags ? std::to_string(*view.tags) : "",
                        rms ? fmt::format("{:.3f} px", *rms) : "",
                        rms ? fmt::format("{:.1f} µm", *rms * mm_per_px * 1000) : "",
                        position_cell(eye, view.center_sigma_mm), fmt::format("{:.0f} mm", distance), lean});
  }
  return table(out) +
         "<p class=\"soft\">Normal: 0.02 to 0.1 px per axis for sharp photos with tags of 40 px or more; above 0.3 px "
         "something moved, is out of focus, or lies elsewhere than <code>board.json</code> says.</p>";
}

// Returns the result in one line.
std::string known_in_words(const Loaded& in) {
  const Bench& bench = in.bench;
  std::string out;
  const auto add = [&](const std::string& part) { out += (out.empty() ? "" : "; ") + part; };
  if (bench.material_sigma.alpha && is_determined(bench, parameter::kAlpha))
    add("alpha " + with_sigma(bench.material.alpha, *bench.material_sigma.alpha));
  if (bench.material_sigma.depth_um && is_determined(bench, parameter::kDepth))
    add("depth " + with_sigma(bench.material.depth_um, *bench.material_sigma.depth_um) + " µm");
  for (const Light& light : bench.lights)
    if (light.position_sigma_mm && is_determined(bench, parameter::light_position(light.id)))
      add(fmt::format("lamp “{}” to ±{} mm", html(light.id), significant(light.position_sigma_mm->norm())));
  return out;
}

// Returns undetermined parameters and the photos that would help.
std::vector<Finding> findings_of(const Loaded& in) {
  std::vector<Finding> out;
  for (const auto& [name, verdict] : in.bench.verdict) {
    if (verdict.determined()) continue;
    out.push_back({FindingCode::parameter_undetermined,
                   verdict.known() ? Finding::Severity::note : Finding::Severity::warning,
                   {},
                   parameter::in_words(name) +
                       (verdict.known() ? ": the photos determine it only weakly" : ": the photos do not determine it"),
                   verdict.next_photo ? "the photo that would help most: " + sentence(*verdict.next_photo, verdict.unit)
                                      : "why stands under “What the photos determine”"});
  }
  const auto left_out = std::ranges::count_if(in.residuals.corners, &ShownResidual::left_out);
  if (left_out > 0)
    out.push_back({FindingCode::outliers_omitted,
                   Finding::Severity::note,
                   {},
                   fmt::format("{} of {} left out: they contradict the others", grouped(left_out, "tag corner"),
                               grouped(static_cast<long long>(in.residuals.corners.size()))),
                   "they are red under “Tags and residuals”: a tag that peels off, or something in front of it"});
  return out;
}

std::string outcome_of(const Loaded& in) {
  const Bench& bench = in.bench;
  double squares = 0;
  int with_tags = 0;
  for (const View& view : bench.views)
    if (view.reprojection_rms_px) {
      squares += *view.reprojection_rms_px * *view.reprojection_rms_px;
      ++with_tags;
    }
  const auto open = std::ranges::count_if(bench.verdict, [](const auto& v) { return !v.second.known(); });
  std::string out =
      fmt::format("The bench was measured from {}", grouped(static_cast<long long>(bench.views.size()), "view"));
  if (with_tags > 0) out += fmt::format("; its tags fit to {:.3f} px", std::sqrt(squares / with_tags));
  if (open > 0)
    out += fmt::format(", but {} not determined by these photos",
                       open == 1 ? "one thing is" : fmt::format("{} things are", open));
  return out + ".";
}

// Grooves are measured after tags and lamp; the design for the bench follows.
std::string next_of(const Loaded& in, const std::filesystem::path& session, const std::filesystem::path& bench) {
  const bool refined = in.bench.material_sigma.alpha || find_verdict(in.bench, parameter::kAlpha) != nullptr;
  if (!refined)
    return "the grooves themselves are not measured yet: <code>" +
           html("burin refine " + shell_word(session.string()) + " --bench " + shell_word(bench.string())) + "</code>";
  if (const std::optional<PlaceInProject> at = project_of(bench); at && at->round > 0)
    return "the next board, designed for the bench as it is: <code>" +
           html("burin loop " + shell_word(folder_on_page(at->project.folder).string())) + "</code>";
  return fmt::format(
      "design for the bench as it is: name <code>{}</code> as <code>\"bench\"</code> in a design.json, then "
      "<code>burin design DESIGN.json --out DIR</code>",
      html(bench.string()));
}

std::string residual_words(const Loaded& in, double factor) {
  const std::string blue = "Blue: where the solved bench says each tag is. ";
  if (in.residuals.corners.empty()) return blue + "No residuals.vnl lies next to bench.json, so no arrows are drawn.";
  return blue +
         fmt::format(
             "Yellow: from each found corner, its residual, drawn {} times as long as it is; red: corners that "
             "were left out. Arrows that point the same way over an area mean a lens model that does not fit; one "
             "long arrow means a tag that sits elsewhere.",
             number(factor));
}

// The worst predictions come first; all but the first few are folded.
std::string photo_beside_prediction(std::vector<PhotoComparison> comparisons) {
  constexpr std::size_t kOpen = 3;
  std::ranges::stable_sort(comparisons, std::ranges::greater{}, &PhotoComparison::relative_rms);
  std::string open, more;
  for (std::size_t i = 0; i < comparisons.size(); ++i) (i < kOpen ? open : more) += comparisons[i].pictures;
  if (open.empty()) return "";
  std::string out = compared_in_lockstep("carve area", open);
  if (!more.empty())
    out += folded(grouped(static_cast<long long>(comparisons.size() - kOpen), "more view"), "which agree better",
                  compared_in_lockstep("carve area", more));
  return out + fmt::format(
                   "<p class=\"soft\">Each view as the measured bench predicts it and as it was photographed, laid "
                   "flat on the "
                   "carve area (x right, y up), both with one exposure; those that agree least come first. In the "
                   "difference, "
                   "red: the photo is brighter; blue: darker; full color at ±{:.0f} % of white; gray: clipped.</p>\n",
                   100 * kDifferenceScale);
}

// One view under one lamp, as shown in the report.
struct ViewShown {
  std::optional<Finding> left_out;
  std::optional<PhotoComparison> comparison;
  std::optional<Figure> photo;  // of the first lamp of each view
};

ViewShown view_shown(const Loaded& in, const MergedView& merged, bool first_of_view, double factor) {
  ViewShown out;
  const auto view = std::ranges::find(in.bench.views, merged.view, &View::name);
  const std::string lights = known_lights(in.bench, merged.light);
  if (view == in.bench.views.end() || lights.empty()) {
    out.left_out = {FindingCode::photo_omitted,
                    Finding::Severity::warning,
                    {},
                    fmt::format("view {} was left out of the calibration: it has no {} in bench.json", merged.view,
                                view == in.bench.views.end() ? "pose" : "lamp"),
                    "burin calibrate's messages give the reason"};
    return out;
  }
  out.comparison = comparison(in, merged, *view, find_lit(in.bench, lights, "session.json"));
  if (first_of_view) out.photo = residual_photo(in, merged, *view, factor);
  return out;
}

// Returns all views in the session's order. A merged color photo of 12 megapixels takes 300 MB, so each one is freed
// after its pictures are drawn.
std::vector<ViewShown> views_shown(const Loaded& in, double factor, const Progress& progress) {
  if (progress) progress("reading photos for the report", 0);
  const std::vector<Bracket> brackets = brackets_of(in.session);
  std::vector<ViewShown> out(brackets.size());
  std::mutex mutex;
  std::size_t done = 0;
  for_each_merged(in.session, brackets, session_noise(in.session, brackets), 1,
                  [&](std::size_t b, MergedView&& merged, GrayView&&) {
                    const auto first = std::ranges::find(brackets, merged.view, &Bracket::view);
                    out[b] = view_shown(in, merged, first - brackets.begin() == static_cast<std::ptrdiff_t>(b), factor);
                    const std::scoped_lock lock(mutex);
                    ++done;
                    if (progress)
                      progress("drawing views", static_cast<double>(done) / static_cast<double>(brackets.size()));
                  });
  return out;
}

}  // namespace

std::optional<Section> session_section(const std::filesystem::path& folder, const std::filesystem::path& session,
                                       const Progress& progress) {
  const auto session_file = session.empty() ? folder / "session.json" : session;
  if (!std::filesystem::exists(folder / "bench.json") || !std::filesystem::exists(session_file)) return std::nullopt;

  Loaded in;
  in.session = read_session(session_file);
  in.board = read_board(in.session.board);
  in.bench = read_bench(folder / "bench.json");
  if (!in.board.scratches.empty() && std::filesystem::exists(in.board.scratches))
    in.carved = carve(Sent(read_scratches(in.board.scratches)), in.bench, in.board);
  in.residuals = read_residuals(folder / "residuals.vnl");
  in.held_out = read_hold_out(folder);
  Section out;
  out.title = "The measured bench";
  out.heading = "Photo beside prediction";
  out.outcome = outcome_of(in);
  out.next = next_of(in, session_file, folder / "bench.json");
  out.findings = findings_of(in);
  std::vector<PhotoComparison> comparisons;
  std::vector<Figure> photos;
  const double factor = arrow_factor(in.residuals);
  for (ViewShown& shown : views_shown(in, factor, progress)) {
    if (shown.left_out) out.findings.push_back(std::move(*shown.left_out));
    if (shown.comparison) comparisons.push_back(std::move(*shown.comparison));
    if (shown.photo) photos.push_back(std::move(*shown.photo));
  }
  out.pictures = photo_beside_prediction(std::move(comparisons));
  out.open = bench_section(in.bench, in.board, {}, "The bench as measured");
  out.has_scene = true;
  const double rms = in.residuals.rms_px();
  out.parts =
      folded("What was measured", known_in_words(in), numbers(in) + effects(in)) + misfits_in_pictures(in.bench) +
      verdicts(in) + machine_numbers(in) + held_out(in) +
      folded("Tags and residuals", rms > 0 ? fmt::format("{:.3f} px RMS per axis", rms) : "over the photos",
             "<p>" + residual_words(in, factor) + "</p>\n" + figure_row(photos, FigureSize::large) + view_numbers(in));
  return out;
}

}  // namespace burin
