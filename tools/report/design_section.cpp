// How a design is shown: what each view is to show, what it began with, what it will show, and how it got there.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "burin/optimize/duration.h"
#include "burin/render/error.h"
#include "burin/render/files/decimals.h"
#include "burin/render/files/json_file.h"
#include "burin/render/image.h"
#include "tools/commands.h"
#include "tools/report/chart.h"
#include "tools/report/html.h"
#include "tools/report/pictures.h"
#include "tools/report/section.h"

namespace burin {
namespace {

constexpr int kPictureSidePx = 512;
constexpr int kSheetWidthPx = 1400;

// The other view whose target this view's picture resembles most: a ghost if it does so more than the targets do.
std::string ghost_sentence(const std::vector<std::string>& names, std::size_t view, const std::vector<double>& ghost,
                           const std::vector<double>& target_correlation) {
  constexpr double kSeen = 0.05;
  std::size_t worst = view;
  double excess = 0;
  for (std::size_t j = 0; j < std::min(ghost.size(), target_correlation.size()); ++j)
    if (j != view && ghost[j] - target_correlation[j] > excess) {
      excess = ghost[j] - target_correlation[j];
      worst = j;
    }
  if (worst == view || excess < kSeen) return "none";
  return fmt::format("of {} (correlation {:.2f}, the targets' own {:.2f})", html(names[worst]), ghost[worst],
                     target_correlation[worst]);
}

// Numbers of a design-report.json; null stands for what is not finite.
double number_or_nan(JsonObject& object, const char* key) {
  return object.raw(key).is_number() ? object.number(key) : std::numeric_limits<double>::quiet_NaN();
}

struct Views {
  std::vector<std::string> names;
  std::vector<double> psnr_db;
  std::string pictures;
  Table numbers{{"View", "Preview, PSNR", "It looks", "SSIM", "Start", "The face allows", "Ghost", "Holds"}, {}};
  Table colors{{"View in color", "Red, PSNR", "Green", "Blue", "Luminance", "White balance"}, {}};
};

Views read_views(JsonObject& report, const std::filesystem::path& home) {
  Views out;
  std::vector<JsonObject> views = report.objects("views");
  for (JsonObject& view : views) out.names.push_back(view.text("view"));
  std::string all;
  for (std::size_t k = 0; k < views.size(); ++k) {
    JsonObject& view = views[k];
    const std::string& name = out.names[k];
    const double psnr = number_or_nan(view, "psnr_db"), start = number_or_nan(view, "start_psnr_db"),
                 allows = number_or_nan(view, "achievable_psnr_db");
    out.psnr_db.push_back(psnr);
    const auto shown = [&](const char* key, const std::string& word, const std::string& value,
                           const std::string& more) {
      return Figure{picture_within(home / view.text(key), kPictureSidePx),
                    fmt::format("View {}: {}{}{}", name, more, value.empty() ? "" : ", ", value),
                    "<b>" + word + "</b>" + (value.empty() ? "" : " " + unbroken(value)), word};
    };
    const std::vector<Figure> figures{shown("target", "Target", "", "the target, as it lies on the carve area"),
                                      shown("preview", "Preview", decibels(psnr), "what this view will show"),
                                      shown("start", "Start", decibels(start), "what the design began with")};
    all += compared("View " + name, figures, 0, 1);
    out.numbers.rows.push_back(
        {html(name), decibels(psnr), quality_in_words(psnr), fixed(number_or_nan(view, "ssim"), 2), decibels(start),
         decibels(allows),
         ghost_sentence(out.names, k, view.numbers("ghost", -1), view.numbers("target_correlation", -1)),
         view.has("tolerance") ? html(view.object("tolerance").text("text")) : ""});
  }
  for (JsonObject& view : views) {
    if (!view.has("color")) continue;
    JsonObject color = view.object("color");
    JsonObject psnr = color.object("psnr_db");
    const std::vector<double> gain = color.numbers("white_gain", 3);
    out.colors.rows.push_back({html(view.text("view")), decibels(number_or_nan(psnr, "red")),
                               decibels(number_or_nan(psnr, "green")), decibels(number_or_nan(psnr, "blue")),
                               decibels(number_or_nan(psnr, "luminance")),
                               fmt::format("{:.2f} : {:.2f} : {:.2f}", gain[0], gain[1], gain[2])});
  }
  out.pictures = compared_in_lockstep("carve area", all);
  return out;
}

std::string loss_chart(JsonObject& report, const std::vector<std::string>& names) {
  std::vector<Curve> curves(names.size() + 1);
  curves[0].name = "all views";
  for (std::size_t k = 0; k < names.size(); ++k) curves[k + 1].name = names[k];
  for (JsonObject& step : report.objects("history")) {
    curves[0].values.push_back(step.number("loss"));
    const std::vector<double> each = step.numbers("views", static_cast<int>(names.size()));
    for (std::size_t k = 0; k < each.size(); ++k) curves[k + 1].values.push_back(each[k]);
  }
  if (curves[0].values.empty()) return "";
  return chart(curves, {"iteration", "loss",
                        fmt::format("The design's loss over {} iterations, from {} to {}, in all and view by view",
                                    curves[0].values.size(), number(curves[0].values.front()),
                                    number(curves[0].values.back()))});
}

std::string how_it_got_there(JsonObject& report, const std::vector<std::string>& names,
                             const std::filesystem::path& home) {
  JsonObject length = report.object("length_mm");
  const std::string sheet = report.text("contact_sheet");
  const std::vector<Figure> figures{
      {picture_within(home / sheet, kSheetWidthPx),
       "Contact sheet of the design: a row for each view, iterations from left to right, the target at the end",
       "<b>Contact sheet</b>: a row for each view, iterations from left to right, the target at the end."}};
  return fmt::format(
             "<p>It began with {}; {} were dropped because the pictures hardly need them. {:.1f} m of scratches in "
             "all, "
             "{:.1f} mm each on average.</p>\n",
             counted(report.integer("started_with"), "scratch"), grouped(report.integer("dropped")),
             length.number("total") / 1000, length.number("mean")) +
         loss_chart(report, names) + figure_row(figures, FigureSize::single);
}

}  // namespace

std::optional<Section> design_section(const std::filesystem::path& folder) {
  std::filesystem::path home = folder;
  if (!std::filesystem::exists(home / "design-report.json")) home = folder / "design";
  const auto file = home / "design-report.json";
  if (!std::filesystem::exists(file)) return std::nullopt;
  const Json json = read_json(file, "burin/design-report", 1);
  JsonObject report(json, file.string());

  Views views = read_views(report, home);
  if (views.names.empty()) fail(file.string(), "\"views\" is empty", "run burin design again");
  double sum = 0;
  std::size_t worst = 0;
  for (std::size_t k = 0; k < views.names.size(); ++k) {
    sum += views.psnr_db[k];
    if (views.psnr_db[k] < views.psnr_db[worst]) worst = k;
  }
  JsonObject seconds = report.object("seconds");
  const long long scratches = report.integer("scratches");
  const std::string mean = decibels(sum / static_cast<double>(views.names.size()));
  Section out;
  out.title = "The design";
  out.outcome = fmt::format("The design shows {} with {}: {} on average, the worst is {}.",
                            counted(static_cast<long long>(views.names.size()), "picture"),
                            counted(scratches, "scratch"), mean, quality_in_words(views.psnr_db[worst]));
  if (views.names.size() == 1)
    out.outcome = fmt::format("The design shows its picture with {}: {}, {}.", counted(scratches, "scratch"), mean,
                              quality_in_words(views.psnr_db[0]));
  const auto command = "burin toolpath " + shell_word((home / "scratches.csv").string()) +
                       " --board BOARD.json --bench BENCH.json --out board.gcode";
  out.next = fmt::format("turn it into a tool path: <code>{}</code>", html(command));
  out.heading = "What it will show";
  out.pictures =
      views.pictures +
      "<p class=\"soft\">Pictures as they lie on the carve area, x right and y up. PSNR compares the preview "
      "with its target at the best single exposure: 20 dB is recognizable, 25 dB good, 30 dB hard to tell "
      "apart.</p>\n";
  for (const auto& warning : report.raw("warnings"))
    out.findings.push_back({Finding::Severity::warning, {}, warning.get<std::string>(), ""});
  out.parts = folded("View by view",
                     fmt::format("{} to {}", decibels(*std::ranges::min_element(views.psnr_db)),
                                 decibels(*std::ranges::max_element(views.psnr_db))),
                     table(views.numbers) + (views.colors.rows.empty() ? "" : table(views.colors))) +
              folded("How it got there", fmt::format("designed in {}", html(duration_text(seconds.number("total")))),
                     how_it_got_there(report, views.names, home));
  return out;
}

}  // namespace burin
