// Report of a design: target, start and preview of each view, and the loss over the iterations.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "burin/base/files/decimals.h"
#include "burin/base/files/json_file.h"
#include "burin/base/image.h"
#include "burin/optimize/duration.h"
#include "tools/commands.h"
#include "tools/picture_quality.h"
#include "tools/report/chart.h"
#include "tools/report/html.h"
#include "tools/report/pictures.h"
#include "tools/report/section.h"

namespace burin {
namespace {

constexpr int kPictureSidePx = 512;
constexpr int kSheetWidthPx = 1400;

// Names the ghost: the other target whose correlation with this picture most exceeds its correlation with the view's
// own target.
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

// Reads a number of design-report.json; null stands for NaN and infinity.
double number_or_nan(JsonObject& object, const char* key) {
  return object.raw(key).is_number() ? object.number(key) : std::numeric_limits<double>::quiet_NaN();
}

// Returns an eye's tolerance without the view's name, which the row already has.
std::string holds_text(JsonObject& view, const std::string& name) {
  const std::string text = view.object("tolerance").text("text"), begin = "view " + name + " holds ";
  return text.starts_with(begin) ? text.substr(begin.size()) : text;
}

struct Views {
  std::vector<std::string> names;
  std::string pictures;
  Table numbers;
  Table colors{{"View in color", "Red, PSNR", "Green", "Blue", "Luminance", "White balance"}, {}};
};

Views read_views(JsonObject& report, const DesignQuality& quality, const std::filesystem::path& home) {
  Views out;
  const std::vector<double> pixels = report.numbers("pixels", 2);
  const int own_px = static_cast<int>(std::max(pixels[0], pixels[1]));
  const auto own = [&](const char* what) { return fmt::format("{} ({} px)", what, own_px); };
  out.numbers.header = {"View", fmt::format("PSNR ({} px)", quality.px), "It looks"};
  if (own_px != quality.px) out.numbers.header.push_back(own("Close by"));
  out.colors.header[1] = own("Red, PSNR");
  for (const std::string& more :
       {own("Start"), own("Plain face"), own("SSIM"), std::string("Ghost"), std::string("Holds")})
    out.numbers.header.push_back(more);
  std::vector<JsonObject> views = report.objects("views");
  for (JsonObject& view : views) out.names.push_back(view.text("view"));
  std::string all;
  for (std::size_t k = 0; k < views.size(); ++k) {
    JsonObject& view = views[k];
    const std::string& name = out.names[k];
    const double psnr = number_or_nan(view, "psnr_db"), start = number_or_nan(view, "start_psnr_db"),
                 allows = number_or_nan(view, "achievable_psnr_db");
    const auto shown = [&](const char* key, const std::string& word, const std::string& value,
                           const std::string& more) {
      return Figure{picture_within(home / view.text(key), kPictureSidePx),
                    fmt::format("View {}: {}{}{}", name, more, value.empty() ? "" : ", ", value),
                    "<b>" + word + "</b>" + (value.empty() ? "" : " " + unbroken(value)), word};
    };
    const std::vector<Figure> figures{
        shown("target", "Target", "", "the target, as it lies on the carve area"),
        shown("preview", "Preview", quality.in_decibels(k), "what this view will show"),
        shown("start", "Start", decibels_of(start, own_px), "what the design began with")};
    all += compared("View " + name, figures, 0, 1);
    std::vector<std::string> row{html(name), decibels(quality.psnr_db[k]), quality.in_words(k)};
    if (own_px != quality.px) row.push_back(decibels(psnr));
    for (const std::string& more :
         {decibels(start), decibels(allows), fixed(number_or_nan(view, "ssim"), 2),
          ghost_sentence(out.names, k, view.numbers("ghost", -1), view.numbers("target_correlation", -1)),
          view.has("tolerance") ? html(holds_text(view, name)) : std::string()})
      row.push_back(more);
    out.numbers.rows.push_back(std::move(row));
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
  std::size_t iterations = 0;
  for (JsonObject& step : report.objects("history")) {
    ++iterations;
    if (step.has("as_carved") && !step.boolean("as_carved")) continue;  // loss without the cuts at crossings
    curves[0].values.push_back(step.number("loss"));
    const std::vector<double> each = step.numbers("views", static_cast<int>(names.size()));
    for (std::size_t k = 0; k < each.size(); ++k) curves[k + 1].values.push_back(each[k]);
  }
  if (curves[0].values.empty()) return "";
  const bool some = curves[0].values.size() < iterations;
  return chart(curves, {some ? "looks at it as it will be carved" : "iteration", "loss",
                        fmt::format("The design's loss over {} iterations, from {} to {}, in all and view by view",
                                    iterations, number(curves[0].values.front()), number(curves[0].values.back()))});
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
             grouped(report.integer("started_with"), "scratch"), grouped(report.integer("dropped")),
             length.number("total") / 1000, length.number("mean")) +
         loss_chart(report, names) + figure_row(figures, FigureSize::single);
}

}  // namespace

std::vector<Finding> design_findings(JsonObject& report) {
  std::vector<Finding> out;
  for (const auto& warning : report.raw("warnings"))
    out.push_back({FindingCode::recorded, Finding::Severity::warning, {}, warning.get<std::string>(), ""});
  if (report.has("notes"))
    for (const auto& note : report.raw("notes"))
      out.push_back({FindingCode::recorded, Finding::Severity::note, {}, note.get<std::string>(), ""});
  return out;
}

std::optional<Section> design_section(const std::filesystem::path& folder) {
  std::filesystem::path home = folder;
  if (!std::filesystem::exists(home / "design-report.json")) home = folder / "design";
  const auto file = home / "design-report.json";
  if (!std::filesystem::exists(file)) return std::nullopt;
  const Json json = read_json(file, "burin/design-report", 1);
  JsonObject report(json, file.string());

  const DesignQuality quality = quality_of_design(report, file);
  Views views = read_views(report, quality, home);
  JsonObject seconds = report.object("seconds");
  const long long scratches = report.integer("scratches");
  const std::string mean = decibels_of(quality.mean_db(), quality.px);
  Section out;
  out.title = "The design";
  out.outcome = fmt::format("The design shows {} with {}: {} on average, the worst is {}.",
                            grouped(static_cast<long long>(views.names.size()), "picture"),
                            grouped(scratches, "scratch"), mean, quality.in_words(quality.worst()));
  if (views.names.size() == 1)
    out.outcome = fmt::format("The design shows its picture with {}: {}, {}.", grouped(scratches, "scratch"), mean,
                              quality.in_words(0));
  const auto command = "burin toolpath " + shell_word((home / "scratches.csv").string()) +
                       " --board BOARD.json --bench BENCH.json --out board.gcode";
  out.next = fmt::format("turn it into a tool path: <code>{}</code>", html(command));
  out.heading = "What it will show";
  out.pictures =
      views.pictures +
      fmt::format(
          "<p class=\"soft\">Pictures as they lie on the carve area, x right and y up. PSNR compares the "
          "preview with its target at the best single exposure, in {} pixels along the longer side{}: 20 dB is "
          "recognizable, 25 dB good, 30 dB hard to tell apart. In other pixels there are other dB.</p>\n",
          quality.px, quality.from_m > 0 ? fmt::format(", which eyes {:.2g} m away tell apart", quality.from_m) : "");
  out.findings = design_findings(report);
  out.parts = folded("View by view",
                     fmt::format("{} to {}", decibels(*std::ranges::min_element(quality.psnr_db)),
                                 decibels_of(*std::ranges::max_element(quality.psnr_db), quality.px)),
                     table(views.numbers) + (views.colors.rows.empty() ? "" : table(views.colors))) +
              folded("How it got there", fmt::format("designed in {}", html(duration_text(seconds.number("total")))),
                     how_it_got_there(report, views.names, home));
  return out;
}

}  // namespace burin
