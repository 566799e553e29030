#include "burin/optimize/design/design_output.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "burin/base/error.h"
#include "burin/base/files/file_names.h"
#include "burin/base/files/files_together.h"
#include "burin/base/files/json_file.h"
#include "burin/base/simd_width.h"
#include "burin/optimize/design/carving_plot.h"
#include "burin/pictures/picture.h"
#include "burin/scene/files/machine_json.h"

namespace burin {
namespace {

Json list(const std::vector<double>& values) {
  Json json = Json::array();
  for (const double v : values) json.push_back(v);
  return json;
}

// Names of each view's files: "v00", or "v00-lamp" if a view shows pictures under several lamps.
std::vector<std::string> labels_of(const std::vector<DesignedView>& views) {
  std::vector<std::string> names;
  for (const DesignedView& view : views) {
    const auto same =
        std::count_if(views.begin(), views.end(), [&](const DesignedView& v) { return v.view == view.view; });
    names.push_back(same > 1 ? view.view + "-" + view.light : view.view);
  }
  return distinct_file_names(names, {"-start"});
}

Json bench_as_used(const DesignSpec& spec, const Board& board, const Bench& bench) {
  Json json;
  json["file"] = spec.bench.filename().string();
  json["alpha"] = bench.material.alpha;
  json["depth_um"] = bench.material.depth_um;
  json["width_um"] = board.tool_width_um;
  json["base_alpha"] = bench.material.base_alpha;
  json["carve_mm"] = {to_json(board.carve_min_mm), to_json(board.carve_max_mm)};
  json["machine"] = machine_json(bench.machine_affine, bench.machine_errors);
  Json lights = Json::array(), cameras = Json::array();
  std::set<std::string> seen;
  for (const DesignView& v : spec.views) {
    if (seen.insert("light " + v.light).second)
      lights.push_back({{"id", v.light}, {"position_mm", to_json(find_light(bench, v.light, "design").position_mm)}});
    if (seen.insert("view " + v.view).second)
      cameras.push_back(
          {{"view", v.view},
           {"center_mm",
            to_json(Eigen::Vector3d(find_view(bench, v.view, "design").T_camera_board.inverse().translation()))}});
  }
  json["lights"] = lights;
  json["views"] = cameras;
  return json;
}

Json place_json(const PlaceTolerance& p) {
  const auto range = [](const MoveRange& r) { return Json::array({-r.minus_mm, r.plus_mm}); };
  return {{"sideways", range(p.sideways)}, {"up", range(p.up)}, {"depth", range(p.depth)}};
}

// One square per position: white (no loss) to blue at the limit, then orange to black at twice the limit.
Image tolerance_map(const ViewTolerance& t) {
  constexpr int kSquare = 32;
  Image map(t.lost_db.width * kSquare, t.lost_db.height * kSquare, 3);
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      const double lost = t.lost_db.at(x / kSquare, y / kSquare) / kLostDb;
      const auto f = static_cast<float>(std::clamp(lost < 1 ? lost : lost - 1, 0.0, 1.0));
      const std::array<float, 3> color = lost < 1 ? std::array<float, 3>{1 - 0.75F * f, 1 - 0.5F * f, 1 - 0.15F * f}
                                                  : std::array<float, 3>{1 - f, 0.55F * (1 - f), 0.1F * (1 - f)};
      for (int c = 0; c < 3; ++c) map.at(x, y, c) = color[c];
    }
  return map;
}

// Writes one view's pictures to the folder, and returns its entry of the report.
Json write_view(const DesignResult& result, std::size_t k, const std::string& name,
                const std::filesystem::path& folder) {
  const DesignedView& v = result.views[k];
  Json json;
  json["view"] = v.view;
  json["light"] = v.light;
  json["rotation_deg"] = v.rotation_deg;
  json["preview"] = "preview-" + name + ".png";
  json["start"] = "preview-" + name + "-start.png";
  json["target"] = "target-" + name + ".png";
  json["achievable"] = "achievable-" + name + ".png";
  write_picture(v.shown, folder / json["preview"].get<std::string>());
  write_picture(v.start, folder / json["start"].get<std::string>());
  write_picture(v.target, folder / json["target"].get<std::string>());
  write_picture(v.achievable, folder / json["achievable"].get<std::string>());
  json["eye_psnr_db"] = v.eye_psnr_db;
  json["psnr_db"] = v.psnr_db;
  json["ssim"] = v.ssim;
  json["start_psnr_db"] = v.start_psnr_db;
  json["start_ssim"] = v.start_ssim;
  json["achievable_psnr_db"] = v.achievable_psnr_db;
  json["loss"] = {{"total", v.loss.total}, {"perceptual", v.loss.perceptual}, {"l2", v.loss.l2}, {"gram", v.loss.gram}};
  json["exposure"] = v.exposure;
  json["best_exposure"] = v.best_exposure;
  json["ghost"] = list(v.ghost);
  json["target_correlation"] = list(v.target_correlation);
  if (v.color) {
    for (std::size_t c = 0; c < 3; ++c)
      json["color"]["psnr_db"][kChannelNames[c]] = v.color->quality.channel_psnr_db[c];
    json["color"]["psnr_db"]["luminance"] = v.color->quality.luminance_psnr_db;
    json["color"]["white_gain"] = v.color->white_gain;
  }
  if (k < result.tolerance.size()) {
    const ViewTolerance& t = result.tolerance[k];
    const std::string map = "tolerance-" + name + ".png";
    write_picture(tolerance_map(t), folder / map);
    json["tolerance"] = {{"text", tolerance_text(v.view, t)}, {"psnr_db", t.psnr_db}, {"eye_mm", place_json(t.eye)},
                         {"lamp_mm", place_json(t.lamp)},     {"map", map},           {"map_half_mm", t.map_half_mm}};
    Json rows = Json::array();
    for (int y = 0; y < t.lost_db.height; ++y) {
      Json row = Json::array();
      for (int x = 0; x < t.lost_db.width; ++x) row.push_back(t.lost_db.at(x, y));
      rows.push_back(row);
    }
    json["tolerance"]["lost_db"] = rows;
  }
  return json;
}

// The view's row of the contact sheet.
std::vector<Image> contact_row(const DesignResult& result, std::size_t k) {
  const DesignedView& v = result.views[k];
  std::vector<Image> row;
  for (const ContactFrame& frame : result.frames) row.push_back(frame.pictures[k]);
  row.push_back(v.target);
  for (Image& image : row) image = for_contact_sheet(image);
  return row;
}

}  // namespace

Image for_contact_sheet(const Image& picture) {
  const double scale = std::min(1.0, 192.0 / std::max(picture.width, picture.height));
  return resized(picture, std::max(1, static_cast<int>(std::lround(picture.width * scale))),
                 std::max(1, static_cast<int>(std::lround(picture.height * scale))));
}

Image tiled(const std::vector<std::vector<Image>>& rows, int gap_px) {
  int w = 0, h = 0, channels = 1;
  std::size_t columns = 0;
  for (const auto& row : rows) {
    columns = std::max(columns, row.size());
    for (const Image& image : row) {
      w = std::max(w, image.width);
      h = std::max(h, image.height);
      channels = std::max(channels, image.channels);
    }
  }
  if (w == 0 || columns == 0) fail("contact sheet", "there are no pictures", "give at least one");
  Image sheet(static_cast<int>(columns) * (w + gap_px) + gap_px, static_cast<int>(rows.size()) * (h + gap_px) + gap_px,
              channels, 0.15F);
  for (std::size_t r = 0; r < rows.size(); ++r)
    for (std::size_t c = 0; c < rows[r].size(); ++c) {
      const Image& image = rows[r][c];
      const int left = gap_px + static_cast<int>(c) * (w + gap_px), top = gap_px + static_cast<int>(r) * (h + gap_px);
      for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
          for (int ch = 0; ch < channels; ++ch)
            sheet.at(left + x, top + y, ch) = image.at(x, y, std::min(ch, image.channels - 1));
    }
  return sheet;
}

void write_design_result(const DesignResult& result, const DesignSpec& spec, const Board& board, const Bench& bench,
                         const std::filesystem::path& folder) {
  make_output_folder(folder);
  FilesTogether all;
  write_scratches(result.scratches, folder / "scratches.csv");

  const std::vector<std::string> names = labels_of(result.views);
  Json views = Json::array();
  std::vector<std::vector<Image>> sheet;
  for (std::size_t k = 0; k < result.views.size(); ++k) {
    views.push_back(write_view(result, k, names[k], folder));
    sheet.push_back(contact_row(result, k));
  }
  write_picture(tiled(sheet, 4), folder / "contact-sheet.png");

  double total_mm = 0;
  const Scratches& s = result.scratches;
  for (std::size_t i = 0; i < s.size(); ++i) total_mm += std::hypot(s.x1_mm[i] - s.x0_mm[i], s.y1_mm[i] - s.y0_mm[i]);

  Json json;
  json["format"] = "burin/design-report";
  json["version"] = 1;
  json["scratches"] = s.size();
  json["started_with"] = result.started_with;
  json["dropped"] = result.dropped;
  json["relocated"] = result.relocated;
  json["carved"] = result.carved;
  json["dropped_by_limits"] = Json::object();
  for (std::size_t r = 0; r < kRules; ++r)
    if (result.dropped_by_rule[r] > 0)
      json["dropped_by_limits"][rule_name(static_cast<Rule>(r))] = result.dropped_by_rule[r];
  json["pixels"] = {result.views.front().shown.width, result.views.front().shown.height};
  json["eye"] = {{"px", result.eye_px}, {"from_m", result.eye_from_m}};
  json["pairs"] = result.pairs;
  json["stopped_early"] = result.stopped_early;
  json["simd"] = name(SimdWidth::best);
  json["loss_start"] = result.history.front().loss;
  json["loss_final"] = result.final_loss;
  json["loss_before_drop"] = result.loss_before_drop;
  json["views"] = views;
  if (!result.curve.empty()) {
    json["carving_curve"] = {{"plot", "carving-curve.svg"}, {"points", Json::array()}};
    for (const CarvingPoint& p : result.curve)
      json["carving_curve"]["points"].push_back(
          {{"scratches", p.scratches}, {"hours", p.hours}, {"psnr_db", list(p.psnr_db)}, {"ssim", list(p.ssim)}});
    write_text(carving_plot(result.curve, names), folder / "carving-curve.svg");
  }
  json["contact_sheet"] = "contact-sheet.png";
  json["contact_iterations"] = Json::array();
  for (const ContactFrame& frame : result.frames) json["contact_iterations"].push_back(frame.iteration);
  json["seconds"] = {{"iterations", result.iteration_seconds}, {"total", result.total_seconds}};
  json["length_mm"] = {{"total", total_mm},
                       {"mean", total_mm / static_cast<double>(std::max<std::size_t>(1, s.size()))}};
  Json material = Json::object();
  if (result.width_um) material["width_um"] = *result.width_um;
  if (result.depth_um) material["depth_um"] = *result.depth_um;
  if (result.alpha) material["alpha"] = *result.alpha;
  json["material"] = material;
  json["bench"] = bench_as_used(spec, board, bench);
  for (const char* list : {"notes", "warnings"}) json[list] = Json::array();
  for (const Finding& finding : result.findings)
    json[finding.severity == Finding::Severity::note ? "notes" : "warnings"].push_back(sentence(finding));
  json["history"] = Json::array();
  for (const DesignIteration& i : result.history) {
    json["history"].push_back({{"loss", i.loss}, {"views", list(i.view_loss)}, {"seconds", i.seconds}});
    if (!i.as_carved) json["history"].back()["as_carved"] = false;
  }
  write_json(json, folder / "design-report.json");
  all.put();
}

}  // namespace burin
