#include "tools/report/rerun.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "burin/base/error.h"
#include "burin/base/files/json_file.h"
#include "burin/base/image.h"
#include "burin/optimize/loss/color_metrics.h"
#include "burin/pictures/picture.h"
#include "burin/render/view_renderer.h"
#include "burin/scene/bench.h"
#include "burin/scene/bench_of_board.h"
#include "burin/scene/board.h"
#include "burin/scene/board_face.h"
#include "burin/scene/carve.h"
#include "burin/scene/files/machine_json.h"
#include "burin/scene/scratches.h"
#include "tools/report/html.h"
#include "tools/report/pictures.h"
#include "tools/report/rectified.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

struct DesignedPicture {
  std::string view, light;
  fs::path target;
  double promised_db = 0;
  // White balance of a picture in color: factors on R, G, B.
  std::optional<std::vector<double>> white_gain;
};

struct DesignedBoard {
  std::vector<DesignedPicture> pictures;
  // The grooves that the true bench's machine makes from the design's tool path.
  Carved carved;
};

DesignedBoard read_designed(const fs::path& folder, const Bench& under, const Board& board) {
  const fs::path file = folder / "design-report.json";
  const Json json = read_json(file, "burin/design-report", 1);
  JsonObject report(json, file.string());
  DesignedBoard out;
  for (JsonObject& view : report.objects("views")) {
    out.pictures.push_back(
        {view.text("view"), view.text("light"), folder / view.text("target"), view.number("psnr_db"), {}});
    if (view.has("color")) out.pictures.back().white_gain = view.object("color").numbers("white_gain", 3);
  }
  JsonObject used = report.object("bench");
  // Its tool path compensated the machine error and depth known at that time.
  Bench then;
  if (used.has("machine")) {
    JsonObject machine = used.object("machine");
    then.machine_affine = read_machine_affine(machine, then.machine_affine);
    then.machine_errors = read_machine_errors(machine);
  } else if (used.has("machine_affine")) {  // designs of 0.1
    then.machine_affine = used.matrix("machine_affine", 2, 3);
  }
  then.material.depth_um = used.number("depth_um", board.material.depth_um);
  then.material.alpha = used.number("alpha", board.material.alpha);
  const Designed designed(read_scratches(folder / "scratches.csv"));
  out.carved = carve(compensated(designed, then, board), under, board);
  return out;
}

struct Look {
  Image picture;  // gamma-encoded
  double psnr_db = 0;
};

Look look_at(const Carved& carved, const DesignedPicture& asked, const Image& target, const Bench& under,
             const Board& board, const fs::path& bench_file) {
  const Eigen::Vector3d eye_mm =
      find_view(under, asked.view, bench_file.string()).T_camera_board.inverse().translation();
  const Light& light = find_light(under, asked.light, bench_file.string());
  RenderOptions options;
  options.channels = target.channels;
  ViewRenderer renderer(make_board_scene(under, board, target.width, target.height, eye_mm, light), options);
  Image radiance;
  renderer.forward(carved, radiance);
  for (std::size_t i = 0; asked.white_gain && i < radiance.data.size(); ++i)
    radiance.data[i] *= static_cast<float>((*asked.white_gain)[i % 3]);
  const float brightest = percentile(radiance, 0.99);
  if (!(brightest > 0)) fail("view " + asked.view, "is black under " + bench_file.string(), "check its lamp");
  Look look;
  look.picture = shown(radiance, static_cast<float>(1 / color_best_exposure(radiance, target, 1 / brightest)));
  look.psnr_db = color_psnr_db(look.picture, target);
  return look;
}

// Returns the target of the second design, in color if the report has a white balance.
Image target_of(const DesignedPicture& asked) {
  Image target = read_picture(asked.target);
  if ((target.channels == 3) != asked.white_gain.has_value())
    fail(asked.target.string(),
         fmt::format("has {} channels, and in the design's report view {} is shown in {}", target.channels, asked.view,
                     asked.white_gain ? "color" : "gray"),
         "make the design again: its files do not belong together");
  return target;
}

}  // namespace

std::string rerun_sentence(std::span<const RerunView> views) {
  std::string gains;
  double sum = 0;
  for (const RerunView& v : views) {
    const double gain = v.after_db() - v.seen_before_db;
    sum += gain / static_cast<double>(views.size());
    gains += fmt::format("{}{} {:+.1f} dB", gains.empty() ? "" : ", ", html(v.view), gain);
  }
  return fmt::format("Designing again for the measured bench {} {:.1f} dB on average ({}).",
                     sum < 0 ? "loses" : "gains", std::abs(sum), gains);
}

std::vector<Finding> rerun_findings(std::span<const RerunView> views) {
  std::vector<Finding> out;
  const auto note = [&](std::string what) {
    out.push_back({FindingCode::view_limit, Finding::Severity::note, {}, std::move(what), ""});
  };
  for (const RerunView& v : views) {
    const double cost = v.promised_before_db - v.seen_before_db, gain = v.after_db() - v.seen_before_db;
    if (cost < kHardlySeen_db)
      note(fmt::format("view {} had little to regain: the first design promised it {:.1f} dB, seen were {:.1f} dB",
                       v.view, v.promised_before_db, v.seen_before_db));
    else if (gain < cost / 2)
      note(fmt::format(
          "view {}: the believed bench cost it {:.1f} dB (promised {:.1f}, seen {:.1f}), and the second "
          "design {}; it promises {:.1f} dB on the bench as it is",
          v.view, cost, v.promised_before_db, v.seen_before_db,
          gain > 0 ? fmt::format("regains {:.1f} dB of them", gain) : "regains none of them", v.promised_after_db));
    if (v.seen_after_db && v.promised_after_db - *v.seen_after_db > kHardlySeen_db)
      out.push_back(make_warning(FindingCode::view_limit,
                                 fmt::format("view {} still loses {:.1f} dB to what the measured bench does not know",
                                             v.view, v.promised_after_db - *v.seen_after_db)));
  }
  return out;
}

Section rerun_section(const RerunInput& input, const Progress& progress) {
  const Board board = read_board(input.board);
  Bench under = read_bench(input.under);
  fill_material(under, board);
  const DesignedBoard before = read_designed(input.before, under, board),
                      after = read_designed(input.after, under, board);
  std::vector<RerunView> views;
  std::string pictures;
  Table results{{"View", "Before: promised", "Before: as seen", "After: promised", "After: as seen", "Gain"}, {}};
  for (const DesignedPicture& asked : after.pictures) {
    if (progress)
      progress("looking at both boards",
               static_cast<double>(views.size()) / static_cast<double>(after.pictures.size()));
    const auto old = std::find_if(before.pictures.begin(), before.pictures.end(), [&](const DesignedPicture& p) {
      return p.view == asked.view && p.light == asked.light;
    });
    if (old == before.pictures.end())
      fail(input.before.string(), "has no view \"" + asked.view + "\" under \"" + asked.light + "\"",
           "compare two designs of the same pictures");
    if (old->white_gain.has_value() != asked.white_gain.has_value())
      fail(input.before.string(),
           fmt::format("shows view \"{}\" in {}, and the design after it in {}", asked.view,
                       old->white_gain ? "color" : "gray", asked.white_gain ? "color" : "gray"),
           "compare two designs of the same pictures");
    const Image target = target_of(asked);
    // Both are under the same lamps and use the measured bench's white balance.
    const Look was = look_at(before.carved, asked, target, under, board, input.under);
    const Look is = look_at(after.carved, asked, target, under, board, input.under);
    views.push_back({asked.view, old->promised_db, was.psnr_db, asked.promised_db, is.psnr_db});
    results.rows.push_back({html(asked.view), decibels(old->promised_db), decibels(was.psnr_db),
                            decibels(asked.promised_db), decibels(is.psnr_db),
                            fmt::format("{:+.1f} dB", is.psnr_db - was.psnr_db)});
    const auto shown = [&](const Image& picture, const std::string& name, const std::string& what,
                           const std::string& value) {
      return Figure{picture, fmt::format("View {}: {}{}{}", asked.view, what, value.empty() ? "" : ", ", value),
                    "<b>" + name + "</b> " + (value.empty() ? "" : unbroken(value)), name};
    };
    const std::vector<Figure> figures{
        shown(target, "Target", "the target", ""),
        shown(was.picture, "Before", "the board designed for the believed bench", decibels(was.psnr_db)),
        shown(is.picture, "After", "the board designed for the measured bench", decibels(is.psnr_db))};
    pictures += compared("View " + asked.view, figures, 1, 2);
  }
  Section out;
  out.title = out.heading = "Before and after";
  out.outcome = rerun_sentence(views);
  out.findings = rerun_findings(views);
  out.pictures = compared_in_lockstep("carve area", pictures) +
                 "<p class=\"soft\">Before: designed for the bench as it was believed to be; after: for the bench as "
                 "measured.</p>\n";
  out.parts = folded(
      "View by view", "promised and seen, before and after",
      table(results) +
          fmt::format("<p>Two boards for the same pictures, both looked at under the bench of {}: its views and lamp, "
                      "the machine's map, the grooves' depth and roughness and how they vary over the board and along "
                      "the carving, and what is seen where grooves cross. Promised is what each design expected of the "
                      "bench that it was made for. PSNR after gamma 1/2.2, each at the exposure that comes nearest to "
                      "the target; in color over red, green and blue, with the white that the second design is seen "
                      "by.</p>\n",
                      html(input.under.filename().string())));
  return out;
}

}  // namespace burin
