#include <CLI/Error.hpp>
#include <CLI/Validators.hpp>
#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <string>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/files/files_together.h"
#include "burin/calib/refine.h"
#include "burin/scene/groove.h"
#include "burin/scene/parameter_name.h"
#include "tools/commands.h"
#include "tools/hold_out_file.h"
#include "tools/kept_memory.h"
#include "tools/progress_bar.h"
#include "tools/project_settings.h"
#include "tools/steps.h"
#include "tools/work_lock.h"

namespace burin {
namespace {

// "0.0800 +- 0.0003", or the reason for an unknown value.
std::string measured(const Bench& bench, const std::string& name, double value, const std::optional<double>& sigma,
                     int digits, const std::string& unit = "") {
  const Verdict* verdict = find_verdict(bench, name);
  if (verdict == nullptr) return fmt::format("{:.{}f}{}, not fitted", value, digits, unit);
  if (!sigma || !verdict->known())
    return fmt::format("not determined ({:.{}f}{}): {}", value, digits, unit, sentence(*verdict));
  // Value and sigma have as many digits as two significant digits of the sigma need.
  const int both = *sigma > 0 ? std::max(digits, 1 - static_cast<int>(std::floor(std::log10(*sigma)))) : digits;
  const std::string known = fmt::format("{:.{}f} +- {:.{}f}{}", value, both, *sigma, both, unit);
  return verdict->determined() ? known : fmt::format("{}, only weakly: {}", known, sentence(*verdict));
}

// Adds a measured number to the data; its text says more.
void set_measured(Facts facts, const std::string& key, const Bench& bench, const std::string& name, double value,
                  const std::optional<double>& sigma, const std::string& unit = "") {
  const Verdict* verdict = find_verdict(bench, name);
  Facts number = facts.in(key);
  number.set("value", value);
  if (!unit.empty()) number.set("unit", unit);
  if (verdict != nullptr && verdict->known() && sigma) number.set("sigma", *sigma);
  number.set("parameter", name);
  number.set("determined", verdict == nullptr ? Json("not fitted") : Json(verdict->determined()));
}

void print_field(const std::string& name, const GrooveField& field, Report& report) {
  if (field.is_constant()) return;
  const auto sigma = field.sigma.value_or(std::array<double, GrooveField::kTerms>{});
  const auto term = [&](int i) { return fmt::format("{:.1f} +- {:.1f} %", 100 * field.terms[i], 100 * sigma[i]); };
  Facts facts = report.in(name).in("field");
  facts.set("terms", Json(std::vector<double>(field.terms.begin(), field.terms.end())), "",
            Json(std::vector<double>(sigma.begin(), sigma.end())));
  if (field.is_linear())
    report.line("         {} varies by {} from left to right, {} from bottom to top\n", name, term(0), term(1));
  if (field.is_quadratic())
    report.line("         and is not linear: {} x x, {} x y, {} y y\n", term(2), term(3), term(4));
  if (field.wear() != 0) report.line("         {} falls by {} from the first scratch to the last\n", name, term(5));
}

void print_panel(const LampSize& size, Facts lamp) {
  if (size.panel_sigma_mm && size.turn_sigma_deg)
    lamp.line("; a panel of {:.1f} +- {:.1f} x {:.1f} +- {:.1f} mm, turned by {:.1f} +- {:.1f} degrees",
              size.panel_mm.x(), size.panel_sigma_mm->x(), size.panel_mm.y(), size.panel_sigma_mm->y(), size.turn_deg,
              *size.turn_sigma_deg);
  else
    lamp.line("; a panel of {:.0f} x {:.0f} mm, as given,", size.panel_mm.x(), size.panel_mm.y());
}

// A screen has room for a few photos; the report has all.
void print_photos(std::vector<PhotoFit> photos, Report& report) {
  for (const PhotoFit& photo : photos) {
    Facts facts = report.add("photos");
    facts.set("view", photo.view);
    facts.set("light", photo.light);
    facts.set("pixels", photo.pixels);
    facts.set("residual_rms", photo.residual_rms);
    facts.set("residual_to_noise", photo.residual_to_noise);
    facts.set("outliers", photo.outliers);
  }
  constexpr std::size_t kMost = 6;
  const std::size_t all = photos.size();
  std::stable_sort(photos.begin(), photos.end(),
                   [](const PhotoFit& a, const PhotoFit& b) { return a.residual_rms > b.residual_rms; });
  photos.resize(std::min(all, kMost));
  report.line("photos   {:>10} {:>9} {:>13} {:>12} {:>9}{}\n", "view", "pixels", "residual", "/ its noise", "outliers",
              all > kMost ? fmt::format("  (the worst {} of {}; burin report shows all)", kMost, all) : "");
  for (const PhotoFit& photo : photos)
    report.line("         {:>10} {:>9} {:>11.2f} % {:>12.2f} {:>7.1f} %\n", photo.view, photo.pixels,
                100 * photo.residual_rms, photo.residual_to_noise, 100 * photo.outliers);
}

// From the second round on, a loop commands compensated depths. The grooves' depths then differ from the bench's, which
// belongs to the commanded depth in board.json.
void print_groove(const Bench& bench, const Board& board, const Scratches& sent, Report& report) {
  Facts grooves = report.in("grooves");
  double deepest_um = bench.material.depth_um;
  if (!sent.depth_um.empty()) {
    const auto [least, most] = std::minmax_element(sent.depth_um.begin(), sent.depth_um.end());
    const double gain = deepest_um / board.material.depth_um;
    const auto span = [](double from, double to) {
      const std::string first = fixed(from, 1), last = fixed(to, 1);
      return first == last ? first : first + " to " + last;
    };
    deepest_um = gain * *most;
    grooves.set("deepest", deepest_um, "um");
    grooves.set("commanded_deepest", *most, "um");
    grooves.line("         of {:g} um told; this board was told {} um, and its grooves are {} um deep\n",
                 board.material.depth_um, span(*least, *most), span(gain * *least, deepest_um));
  }
  grooves.line("         half-width of the grooves {:.1f} um, from the depth and the tool\n",
               fact("half_width", half_width_um(board.tool_width_um, deepest_um), "um"));
}

void print_lamp(const Bench& b, const Light& light, Report& report) {
  Facts lamp = report.add("lamps");
  if (!light.is_near()) {
    lamp.set("id", light.id);
    if (!light.intensity_sigma) return;
    const std::string name = parameter::light_intensity(light.id);
    set_measured(lamp, "intensity", b, name, light.intensity.mean(), light.intensity_sigma->mean());
    report.line("around   {} {}\n", light.id,
                measured(b, name, light.intensity.mean(), light.intensity_sigma->mean(),
                         light.intensity.mean() < 100 ? 3 : 0, " times its picture's brightness"));
    return;
  }
  report_lamp(light, 1, lamp);
  if (light.falloff_exponent > 0)
    lamp.line("; a spot, exponent {:.1f}", fact("falloff_exponent", light.falloff_exponent));
  const LampSize& size = light.size;
  if (size.disk_mm > 0)
    lamp.line("; a disk of {:.1f}{} mm radius", fact("disk_radius", size.disk_mm, "mm", size.disk_sigma_mm),
              size.disk_sigma_mm ? fmt::format(" +- {:.1f}", *size.disk_sigma_mm) : ", as told,");
  else if (!size.is_point())
    print_panel(size, lamp);
  report.text += '\n';
}

// For programs only: text shows sigmas.
void add_correlations(const Correlations& correlations, Facts facts) {
  for (const Correlations::Number& number : correlations.numbers) {
    Facts entry = facts.add("numbers");
    entry.set("parameter", number.name);
    entry.set("sigma", number.sigma);
    if (!number.unit.empty()) entry.set("unit", number.unit);
  }
  Json rows = Json::array();
  for (const auto& row : correlations.values.rowwise()) rows.push_back(std::vector<double>(row.begin(), row.end()));
  facts.set("values", std::move(rows));
}

void print_result(const Refinement& r, const Board& board, const Sent& sent, Report& report) {
  const Bench& b = r.bench;
  set_measured(report.all(), "alpha", b, parameter::kAlpha, b.material.alpha, b.material_sigma.alpha);
  set_measured(report.all(), "depth", b, parameter::kDepth, b.material.depth_um, b.material_sigma.depth_um, "um");
  set_measured(report.all(), "base_alpha", b, parameter::kBaseAlpha, b.material.base_alpha,
               b.material_sigma.base_alpha);
  report.line("alpha    {}\n", measured(b, parameter::kAlpha, b.material.alpha, b.material_sigma.alpha, 4));
  print_field("alpha", b.alpha_field, report);
  report.line("depth    {}\n",
              measured(b, parameter::kDepth, b.material.depth_um, b.material_sigma.depth_um, 2, " um"));
  print_groove(b, board, sent.scratches, report);
  print_field("depth", b.depth_field, report);
  report.in("grooves").line("grooves  differ from one another by {:.1f} % in alpha and {:.1f} % in depth\n",
                            fact("alpha_scatter", 100 * r.alpha_jitter, "%"),
                            fact("depth_scatter", 100 * r.depth_jitter, "%"));
  report.line("face     base_alpha {}\n",
              measured(b, parameter::kBaseAlpha, b.material.base_alpha, b.material_sigma.base_alpha, 4));
  for (const Light& light : b.lights) print_lamp(b, light, report);
  double worst = 0;
  for (const double x : {board.carve_min_mm.x(), board.carve_max_mm.x()})
    for (const double y : {board.carve_min_mm.y(), board.carve_max_mm.y()}) {
      const Eigen::Vector2d moved = b.machine_affine * Eigen::Vector3d(x, y, 1) - Eigen::Vector2d(x, y);
      worst = std::max(worst, moved.norm());
    }
  const Verdict* machine = find_verdict(b, parameter::kMachine);
  if (machine != nullptr) report.in("machine").set("verdict", sentence(*machine));
  report.in("machine").line("machine  off by at most {:.3f} mm over the carve area; {}\n",
                            fact("largest_offset", worst, "mm"), machine != nullptr ? sentence(*machine) : "");
  if (!r.noise_bounds.empty()) report.line("noise    the camera's noise alone would allow these sigmas:\n");
  for (const auto& [name, sigma, bound, unit] : r.noise_bounds) {
    Facts noise = report.add("noise_bounds");
    noise.set("parameter", name);
    noise.set("sigma", sigma);
    noise.set("noise_alone", bound, in_words(unit));
    noise.line("         {:<24} {} {}; its sigma is {} times that\n", name, significant(bound), in_words(unit),
               significant(sigma / bound));
  }
  add_correlations(r.correlations, report.in("correlations"));
  print_photos(r.photos, report);
  report.line("         residual / its noise: 1 is a perfect model; this one misses {:.1f} % of a pixel's light\n",
              fact("model_error", 100 * r.model_error, "%"));
  report.line("crossing scratches: {}\n", fact("crossings", in_words(r.bench.crossings)));
  if (r.looked_at < 1)
    report.line(
        "looked at {:.0f} % of the carve area, in squares all over it: grooves are cut where they cross, too often to "
        "look at all of it\n",
        fact("used_area", 100 * r.looked_at, "%"));
}

// Returns the bench of a loop's round, for a command without --bench and with another output.
std::filesystem::path bench_of_round(const CLI::App& command, const std::filesystem::path& session, bool elsewhere) {
  std::optional<ProjectSettings> settings = settings_around(session);
  if (!settings || settings->at.round == 0) throw CLI::RequiredError("--bench");
  if (!elsewhere) throw CLI::RequiredError("--out (the round's own bench.json is the loop's)");
  std::filesystem::path bench;
  settings->bench = settings->at.project.round(settings->at.round) / "calibration" / "bench.json";
  take_from_project(command, *settings, {.bench = &bench});
  return bench;
}

}  // namespace

Report run_refine(RefineArguments o) {
  if (std::filesystem::is_directory(o.session)) o.session /= "session.json";
  const std::filesystem::path calibrated = o.bench;
  if (!o.out.empty()) o.bench = o.out / "bench.json";
  const WorkLock lock(o.bench.parent_path(), "burin refine",
                      o.out.empty() ? WorkLock::Where::all_folders : WorkLock::Where::new_folders);
  const Session session = read_session(o.session);
  const Board board = read_board(session.board);
  const Bench measured = read_bench(calibrated);
  if (board.scratches.empty())
    fail(session.board.string(), "it names no scratches", "give the designed scratches as \"scratches\": \"FILE.csv\"");
  const Sent sent(read_scratches(board.scratches));
  RefineOptions options;
  for (const auto& [crossings, name] : kCrossingsNames)
    if (o.crossings == name) options.crossings = crossings;
  options.fit_lamp = o.fix.empty();
  options.finest_pixel_mm = o.pixel_mm;
  options.session = &session;
  ProgressBar bar;
  bar.progress()("reading photos", 0);
  const std::vector<MergedView> merged = [&] {
    const KeptMemory kept;
    return photos_for_refine(session, board, measured);
  }();
  const Refinement result = refine(merged, board, sent, measured, options, bar.progress());
  Bench completed = result.bench;
  if (!o.out.empty()) completed.camera.clear();  // the lens is copied next to it
  FilesTogether all;
  write_bench(completed, board.tool_width_um, o.bench);
  HoldOutFile held;
  if (o.holds_out) {
    std::vector<std::string> views;
    for (const View& view : measured.views) views.push_back(view.name);
    constexpr std::size_t kFewestLeft = 2;
    const auto folds = hold_out_folds(o.hold_out.empty() ? "0.25" : o.hold_out, views, kFewestLeft);
    const std::filesystem::path folder = o.bench.parent_path();
    held = read_hold_out(folder);
    held.pixels = hold_out_pixels(result, merged, board, sent, measured, folds, options, bar.progress());
    write_hold_out(held, folder);
  }
  all.put();
  bar.clear();
  for (const Finding& finding : result.findings) tell(finding);
  Report report;
  print_result(result, board, sent, report);
  if (!held.pixels.empty()) {
    report.data["hold_out"] = to_json(held);
    report.text += pixels_in_words(held.pixels);
  }
  report.line("Completed {}{}\n", o.bench.string(),
              is_in_round(o.bench)
                  ? "."
                  : "; next: burin design DESIGN.json --bench " + shell_word(o.bench.string()) + " --out DIR");
  return report;
}

void add_refine_command(CLI::App& burin) {
  auto options = std::make_shared<RefineArguments>();
  CLI::App* command = burin.add_subcommand(
      "refine", "Estimate roughness, depth, lamp and machine errors from photos, and complete bench.json");
  command->add_option("SESSION.json", options->session, "Read this calibrated session.json, or its folder")->required();
  command->add_option(
      "--bench", options->bench,
      "Complete this bench.json of burin calibrate, in place without --out [default with --out: the round's]");
  command->add_option("--out", options->out,
                      "Write the completed bench.json and its lens to this folder, and leave --bench unchanged");
  command
      ->add_option("--crossings", options->crossings,
                   "Set the crossing rule: sum of light (add), last carved (last), deepest, or the best fit (auto) "
                   "[default: auto]")
      ->check(CLI::IsMember({"auto", "add", "last", "deepest"}));
  command->add_option("--fix", options->fix, "Keep lamp positions (lamp) fixed at the values in bench.json")
      ->take_all()
      ->expected(1)
      ->check(CLI::IsMember({"lamp"}));
  const auto* hold_out = command
                             ->add_option("--hold-out", options->hold_out,
                                          "Cross-validate the pixels: views (v03,v07), a share, folds (one fit each), "
                                          "or no value for a quarter of the views")
                             ->expected(0, 1);
  add_length_option(
      *command, "--pixel", options->pixel_mm,
      "Bin photos until a pixel is this large on the board; 0: no binning [default: 0.8 mm, or 0.25 mm if grooves cut "
      "each other]")
      ->check(CLI::Range(0.0, 100.0));
  command->footer(example("burin refine session/session.json --bench bench/bench.json"));
  command->callback([options, hold_out, command] {
    if (std::filesystem::is_directory(options->session)) options->session /= "session.json";
    if (options->bench.empty()) options->bench = bench_of_round(*command, options->session, !options->out.empty());
    options->holds_out = hold_out->count() > 0;
    print(run_refine(*options));
  });
}

}  // namespace burin
