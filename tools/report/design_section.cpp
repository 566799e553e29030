// How a design is shown: what each view is to show, what it began with, what it will show, and how it got there.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "burin/render/error.h"
#include "burin/render/files/json_file.h"
#include "burin/render/image.h"
#include "tools/report/html.h"
#include "tools/report/section.h"

namespace burin {
namespace {

constexpr int kPictureSidePx = 512;

Image picture(const std::filesystem::path& file) {
  Image image = read_picture(file);
  const int longer = std::max(image.width, image.height);
  if (longer <= kPictureSidePx) return image;
  return resized(image, std::max(1, image.width * kPictureSidePx / longer),
                 std::max(1, image.height * kPictureSidePx / longer));
}

// The other view whose target this view's picture resembles most: a ghost if it does so more than the targets do.
std::string ghost_sentence(const std::vector<std::string>& names, std::size_t view, const std::vector<double>& ghost,
                           const std::vector<double>& target_correlation) {
  std::size_t worst = view;
  double excess = 0;
  for (std::size_t j = 0; j < std::min(ghost.size(), target_correlation.size()); ++j)
    if (j != view && ghost[j] - target_correlation[j] > excess) {
      excess = ghost[j] - target_correlation[j];
      worst = j;
    }
  if (worst == view || excess < 0.05) return "no ghost of another view";
  return fmt::format("a ghost of {} (correlation {:.2f}, the targets' own {:.2f})", html(names[worst]), ghost[worst],
                     target_correlation[worst]);
}

}  // namespace

std::optional<Section> design_section(const std::filesystem::path& folder) {
  std::filesystem::path home = folder;
  if (!std::filesystem::exists(home / "design-report.json")) home = folder / "design";
  const auto file = home / "design-report.json";
  if (!std::filesystem::exists(file)) return std::nullopt;
  const Json json = read_json(file, "burin/design-report", 1);
  JsonObject report(json, file.string());

  std::vector<JsonObject> views = report.objects("views");
  std::vector<std::string> names;
  names.reserve(views.size());
  for (JsonObject& view : views) names.push_back(view.text("view"));
  Section out;
  std::string pictures;
  double worst_psnr = INFINITY, sum_psnr = 0;
  for (std::size_t k = 0; k < views.size(); ++k) {
    JsonObject& view = views[k];
    const double psnr = view.number("psnr_db"), ssim = view.number("ssim");
    worst_psnr = std::min(worst_psnr, psnr);
    sum_psnr += psnr;
    pictures += fmt::format("<h3>View {}</h3>\n", html(names[k]));
    std::vector<std::string> row;
    row.push_back(figure(picture(home / view.text("target")), "<b>Target</b>, as it lies on the carve area."));
    row.push_back(figure(picture(home / view.text("start")),
                         fmt::format("<b>Start</b>: {:.1f} dB.", view.number("start_psnr_db"))));
    row.push_back(figure(
        picture(home / view.text("preview")),
        fmt::format("<b>Preview</b>: what this view will show. PSNR {:.1f} dB, SSIM {:.2f}; {}. The plain face's own "
                    "light allows {:.1f} dB.",
                    psnr, ssim,
                    ghost_sentence(names, k, view.numbers("ghost", -1), view.numbers("target_correlation", -1)),
                    view.number("achievable_psnr_db"))));
    pictures += figure_row(row);
  }

  std::vector<Curve> curves(names.size() + 1);
  curves[0].name = "sum";
  for (std::size_t k = 0; k < names.size(); ++k) curves[k + 1].name = names[k];
  for (JsonObject& step : report.objects("history")) {
    curves[0].values.push_back(step.number("loss"));
    const std::vector<double> each = step.numbers("views", static_cast<int>(names.size()));
    for (std::size_t k = 0; k < each.size(); ++k) curves[k + 1].values.push_back(each[k]);
  }
  JsonObject length = report.object("length_mm");
  JsonObject seconds = report.object("seconds");
  out.outcome =
      fmt::format("The design shows {} picture{} with {} scratches: {:.1f} dB on average, {:.1f} dB in the worst view.",
                  names.size(), names.size() == 1 ? "" : "s", report.integer("scratches"),
                  sum_psnr / static_cast<double>(names.size()), worst_psnr);
  out.body =
      "<h2>The design</h2>\n<p>Pictures as they lie on the carve area, x right and y up. PSNR compares the preview "
      "with its target at the best single exposure: 20 dB is recognizable, 25 dB good, 30 dB hard to tell apart."
      "</p>\n" +
      pictures;
  out.body += fmt::format(
      "<h3>How it got there</h3>\n<p>It began with {} scratches; {} were dropped because the pictures hardly need "
      "them. {:.1f} m of scratches in all, {:.1f} mm each on average. Designed in {:.1f} s.</p>\n",
      report.integer("started_with"), report.integer("dropped"), length.number("total") / 1000, length.number("mean"),
      seconds.number("total"));
  out.body += chart(curves, "iteration", "loss");
  const std::string sheet = report.text("contact_sheet");
  out.body +=
      "<div class=\"wide\">" +
      figure(read_picture(home / sheet),
             "<b>Contact sheet</b>: a row for each view, iterations from left to right, the target at the end.") +
      "</div>\n";
  std::string warnings;
  for (const auto& warning : report.raw("warnings")) warnings += "<li>" + html(warning.get<std::string>()) + "</li>\n";
  if (!warnings.empty()) out.body += "<h3>What to mind</h3>\n<ul>\n" + warnings + "</ul>\n";
  return out;
}

}  // namespace burin
