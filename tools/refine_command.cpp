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

void print_field(const std::string& name, const GrooveField& field) {
  if (field.is_constant()) return;
  const auto sigma = field.sigma.value_or(std::array<double, GrooveField::kTerms>{});
  const auto term = [&](int i) { return fmt::format("{:.1f} +- {:.1f} %", 100 * field.terms[i], 100 * sigma[i]); };
  if (field.is_linear())
    print_text("         {} varies by {} from left to right, {} from bottom to top\n", name, term(0), term(1));
  if (field.is_quadratic())
    print_text("         and is not linear: {} x x, {} x y, {} y y\n", term(2), term(3), term(4));
  if (field.wear() != 0) print_text("         {} falls by {} from the first scratch to the last\n", name, term(5));
}

void print_panel(const LampSize& size) {
  if (size.panel_sigma_mm && size.turn_sigma_deg)
    print_text("; a panel of {:.1f} +- {:.1f} x {:.1f} +- {:.1f} mm, turned by {:.1f} +- {:.1f} degrees",
               size.panel_mm.x(), size.panel_sigma_mm->x(), size.panel_mm.y(), size.panel_sigma_mm->y(), size.turn_deg,
               *size.turn_sigma_deg);
  else
    print_text("; a panel of {:.0f} x {:.0f} mm, as told,", size.panel_mm.x(), size.panel_mm.y());
}

// A screen has room for a few photos; the report has all.
void print_photos(std::vector<PhotoFit> photos) {
  constexpr std::size_t kMost = 6;
  const std::size_t all = photos.size();
  std::stable_sort(photos.begin(), photos.end(),
                   [](const PhotoFit& a, const PhotoFit& b) { return a.residual_rms > b.residual_rms; });
  photos.resize(std::min(all, kMost));
  print_text("photos   {:>10} {:>9} {:>13} {:>12} {:>9}{}\n", "view", "pixels", "residual", "/ its noise", "outliers",
             all > kMost ? fmt::format("  (the worst {} of {}; burin report shows all)", kMost, all) : "");
  for (const PhotoFit& photo : photos)
    print_text("         {:>10} {:>9} {:>11.2f} % {:>12.2f} {:>7.1f} %\n", photo.view, photo.pixels,
               100 * photo.residual_rms, photo.residual_to_noise, 100 * photo.outliers);
}

// From the second round on, a loop commands compensated depths. The grooves' depths then differ from the bench's, which
// belongs to the commanded depth in board.json.
void print_groove(const Bench& bench, const Board& board, const Scratches& sent) {
  double deepest_um = bench.material.depth_um;
  if (!sent.depth_um.empty()) {
    const auto [least, most] = std::minmax_element(sent.depth_um.begin(), sent.depth_um.end());
    const double gain = deepest_um / board.material.depth_um;
    const auto span = [](double from, double to) {
      const std::string first = fixed(from, 1), last = fixed(to, 1);
      return first == last ? first : first + " to " + last;
    };
    deepest_um = gain * *most;
    print_text("         of {:g} um told; this board was told {} um, and its grooves are {} um deep\n",
               board.material.depth_um, span(*least, *most), span(gain * *least, deepest_um));
  }
  print_text("         half-width of the grooves {:.1f} um, from the depth and the tool\n",
             half_width_um(board.tool_width_um, deepest_um));
}

void print_result(const Refinement& r, const Board& board, const Sent& sent) {
  const Bench& b = r.bench;
  print_text("alpha    {}\n", measured(b, parameter::kAlpha, b.material.alpha, b.material_sigma.alpha, 4));
  print_field("alpha", b.alpha_field);
  print_text("depth    {}\n", measured(b, parameter::kDepth, b.material.depth_um, b.material_sigma.depth_um, 2, " um"));
  print_groove(b, board, sent.scratches);
  print_field("depth", b.depth_field);
  print_text("grooves  differ from one another by {:.1f} % in alpha and {:.1f} % in depth\n", 100 * r.alpha_jitter,
             100 * r.depth_jitter);
  print_text("face     base_alpha {}\n",
             measured(b, parameter::kBaseAlpha, b.material.base_alpha, b.material_sigma.base_alpha, 4));
  for (const Light& light : b.lights) {
    if (!light.is_near()) {
      if (light.intensity_sigma)
        print_text(
            "around   {} {}\n", light.id,
            measured(b, parameter::light_intensity(light.id), light.intensity.mean(), light.intensity_sigma->mean(),
                     light.intensity.mean() < 100 ? 3 : 0, " times its picture's brightness"));
      continue;
    }
    print_text("lamp     {} at {:.1f}, {:.1f}, {:.1f} mm", light.id, light.position_mm.x(), light.position_mm.y(),
               light.position_mm.z());
    if (light.position_sigma_mm)
      print_text(", +- {:.2f}, {:.2f}, {:.2f} mm", light.position_sigma_mm->x(), light.position_sigma_mm->y(),
                 light.position_sigma_mm->z());
    if (light.falloff_exponent > 0) print_text("; a spot, exponent {:.1f}", light.falloff_exponent);
    if (light.size.disk_mm > 0)
      print_text("; a disk of {:.1f}{} mm radius", light.size.disk_mm,
                 light.size.disk_sigma_mm ? fmt::format(" +- {:.1f}", *light.size.disk_sigma_mm) : ", as told,");
    else if (!light.size.is_point())
      print_panel(light.size);
    print_text("\n");
  }
  double worst = 0;
  for (const double x : {board.carve_min_mm.x(), board.carve_max_mm.x()})
    for (const double y : {board.carve_min_mm.y(), board.carve_max_mm.y()}) {
      const Eigen::Vector2d moved = b.machine_affine * Eigen::Vector3d(x, y, 1) - Eigen::Vector2d(x, y);
      worst = std::max(worst, moved.norm());
    }
  const Verdict* machine = find_verdict(b, parameter::kMachine);
  print_text("machine  off by at most {:.3f} mm over the carve area; {}\n", worst,
             machine != nullptr ? sentence(*machine) : "");
  if (!r.noise_bounds.empty()) print_text("noise    the camera's noise alone would allow these sigmas:\n");
  for (const auto& [name, sigma, bound, unit] : r.noise_bounds)
    print_text("         {:<24} {} {}; its sigma is {} times that\n", name, significant(bound), in_words(unit),
               significant(sigma / bound));
  print_photos(r.photos);
  print_text("         residual / its noise: 1 is a perfect model; this one misses {:.1f} % of a pixel's light\n",
             100 * r.model_error);
  print_text("crossing scratches: {}\n", in_words(r.bench.crossings));
  if (r.looked_at < 1)
    print_text(
        "looked at {:.0f} % of the carve area, in squares all over it: grooves are cut where they cross, too often to "
        "look at all of it\n",
        100 * r.looked_at);
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

void add_refine_command(CLI::App& burin) {
  struct Options {
    std::filesystem::path session, bench, out;
    std::string crossings = "auto";
    bool keep_lamp = false;
    std::string hold_out;
    std::optional<double> pixel_mm;
  };
  auto options = std::make_shared<Options>();
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
  command->add_flag("--keep-lamp", options->keep_lamp, "Keep lamp positions fixed at the values in bench.json");
  const auto* hold_out = command
                             ->add_option("--hold-out", options->hold_out,
                                          "Cross-validate the pixels: views (v03,v07), a share, folds (one fit each), "
                                          "or no value for a quarter of the views")
                             ->expected(0, 1);
  command
      ->add_option("--pixel-mm", options->pixel_mm,
                   "Bin photos until a pixel is this large on the board, mm; 0: no binning [default: 0.8, or 0.25 if "
                   "grooves cut each other]")
      ->check(CLI::Range(0.0, 100.0));
  command->footer(example("burin refine session/session.json --bench bench/bench.json"));
  command->callback([options, hold_out, command] {
    if (std::filesystem::is_directory(options->session)) options->session /= "session.json";
    if (options->bench.empty()) options->bench = bench_of_round(*command, options->session, !options->out.empty());
    const std::filesystem::path calibrated = options->bench;
    if (!options->out.empty()) options->bench = options->out / "bench.json";
    const WorkLock lock(options->bench.parent_path(), "burin refine",
                        options->out.empty() ? WorkLock::Where::all_folders : WorkLock::Where::new_folders);
    const Session session = read_session(options->session);
    const Board board = read_board(session.board);
    const Bench measured = read_bench(calibrated);
    if (board.scratches.empty())
      fail(session.board.string(), "it names no scratches",
           "give the designed scratches as \"scratches\": \"FILE.csv\"");
    const Sent sent(read_scratches(board.scratches));
    RefineOptions o;
    for (const auto& [crossings, name] : kCrossingsNames)
      if (options->crossings == name) o.crossings = crossings;
    o.fit_lamp = !options->keep_lamp;
    o.finest_pixel_mm = options->pixel_mm;
    o.session = &session;
    ProgressBar bar;
    bar.progress()("reading photos", 0);
    const std::vector<MergedView> merged = [&] {
      const KeptMemory kept;
      return photos_for_refine(session, board, measured);
    }();
    const Refinement result = refine(merged, board, sent, measured, o, bar.progress());
    Bench completed = result.bench;
    if (!options->out.empty()) completed.camera.clear();  // the lens is copied next to it
    FilesTogether all;
    write_bench(completed, board.tool_width_um, options->bench);
    HoldOutFile held;
    if (hold_out->count() > 0) {
      std::vector<std::string> views;
      for (const View& view : measured.views) views.push_back(view.name);
      constexpr std::size_t kFewestLeft = 2;
      const auto folds = hold_out_folds(options->hold_out.empty() ? "0.25" : options->hold_out, views, kFewestLeft);
      const std::filesystem::path folder = options->bench.parent_path();
      held = read_hold_out(folder);
      held.pixels = hold_out_pixels(result, merged, board, sent, measured, folds, o, bar.progress());
      write_hold_out(held, folder);
    }
    all.put();
    bar.clear();
    for (const Finding& finding : result.findings) tell(finding);
    print_result(result, board, sent);
    if (!held.pixels.empty()) print_text("{}", pixels_in_words(held.pixels));
    const std::string bench = options->bench.string();
    print_text("Completed {}{}\n", bench,
               is_in_round(options->bench)
                   ? "."
                   : "; next: burin design DESIGN.json --bench " + shell_word(bench) + " --out DIR");
  });
}

}  // namespace burin
