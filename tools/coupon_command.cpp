// burin coupon - measures a machine by a patch of test scratches. The work is in burin/optimize/toolpath/coupon.h
// (layout) and burin/calib/coupon.h (reading).

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "burin/base/error.h"
#include "burin/base/files/files_together.h"
#include "burin/base/files/json_file.h"
#include "burin/calib/calibrate.h"
#include "burin/calib/coupon.h"
#include "burin/calib/refine.h"
#include "burin/capture/folder_session.h"
#include "burin/capture/photo.h"
#include "burin/capture/tags/tag_detector.h"
#include "burin/optimize/duration.h"
#include "burin/optimize/toolpath.h"
#include "burin/optimize/toolpath/coupon.h"
#include "burin/optimize/write_measured_machine.h"
#include "tools/commands.h"
#include "tools/local_time.h"
#include "tools/progress_bar.h"
#include "tools/project_settings.h"
#include "tools/work_lock.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

struct WriteOptions {
  std::string machine = "grbl-spring";
  fs::path out, on;
  std::vector<double> at_mm;
  double tool_width_um = 0, depth_um = 0;
  CouponOptions coupon;
};

std::string unit_of(DepthBy depth_by) {
  switch (depth_by) {
    case DepthBy::fixed_z:
      return "mm deep";
    case DepthBy::servo:
      return "(S)";
    default:
      return "mm below contact";
  }
}

// Converts the scratches in the written G-code back to the coupon's own frame.
Scratches in_coupon(const CouponPlan& plan, const Sent& sent) {
  Scratches out = sent.scratches;
  for (std::size_t i = 0; i < out.size(); ++i) {
    out.x0_mm[i] -= plan.coupon.at_mm.x(), out.x1_mm[i] -= plan.coupon.at_mm.x();
    out.y0_mm[i] -= plan.coupon.at_mm.y(), out.y1_mm[i] -= plan.coupon.at_mm.y();
  }
  return out;
}

void report_coupon(const CouponPlan& plan, const ToolpathReport& path, Report& report) {
  const Coupon& coupon = plan.coupon;
  report.all().set("time", path.duration_s, "s");
  report.line("coupon {} of {}: {} fans of {} kinds, {} scratches, about {} on {}\n", fact("coupon", coupon.number),
              fact("date", coupon.date), fact("fans", coupon.fans.size()), coupon.cells.size(),
              fact("scratches", plan.scratches.size()), duration_text(path.duration_s),
              fact("machine", plan.machine.name));
  for (const CouponCell& cell : coupon.cells)
    report.add("cells").line("  {:>6.4g} {} at {:>5.4g} mm/min, {:.2f} mm apart: believed to make {:.1f} um\n",
                             fact("command", cell.command), unit_of(plan.machine.depth_by),
                             fact("feed", cell.feed_mm_min, "mm/min"), fact("spacing", cell.spacing_mm, "mm"),
                             fact("depth", cell.depth_um, "um"));
  const double half = plan.board.size_mm.x() / 2;
  report.all().set("lamp_position", to_json(coupon.lamp_mm), "mm");
  report.line("tags     {} to {} of {}, {:g} mm, as in board.json\n", plan.board.tags.list.front().id,
              plan.board.tags.list.back().id, plan.board.tags.family, plan.board.tags.list.front().size_mm);
  report.line("lamp     {:.0f} mm towards you from the coupon's middle and {:.0f} mm above it; it stays there\n",
              half - coupon.lamp_mm.y(), coupon.lamp_mm.z());
  for (std::size_t i = 0; i < coupon.shots.size(); ++i) {
    const Eigen::Vector3d& eye = coupon.shots[i].eye_mm;
    report.add("shots").set("eye_position", to_json(eye), "mm");
    report.line("photo {}  camera {:.0f} mm {}, {:.0f} mm {} from the middle, {:.0f} mm above the face\n", i + 1,
                std::abs(eye.x() - half), eye.x() < half ? "left" : "right", std::abs(eye.y() - half),
                eye.y() < half ? "towards you" : "away from you", eye.z());
  }
}

Report write_coupon_files(WriteOptions options, const CLI::App& command) {
  if (const std::optional<ProjectSettings> project = settings_around(options.out))
    take_from_project(command, *project, {.machine = &options.machine});
  const WorkLock lock(options.out, "burin coupon write", WorkLock::Where::new_folders);
  const MachineProfile machine = machine_in_project(options.machine, options.out);
  if (options.coupon.date.empty()) options.coupon.date = local_time("%Y-%m-%d");
  std::optional<Board> on;
  if (!options.on.empty()) {
    on = read_board(options.on);
    options.coupon.tool_width_um = on->tool_width_um;
    options.coupon.material = on->material;
  }
  if (options.tool_width_um > 0) options.coupon.tool_width_um = options.tool_width_um;
  if (options.depth_um > 0) options.coupon.material.depth_um = options.depth_um;
  if (!options.at_mm.empty()) options.coupon.at_mm = {options.at_mm[0], options.at_mm[1]};
  if (fs::exists(options.out / "coupon.json"))
    fail((options.out / "coupon.json").string(), "is there already", "name another folder, or remove that coupon");
  if (on)
    for (const Finding& finding : check_place(*on, options.coupon.at_mm)) tell(finding);
  CouponPlan plan = make_coupon(machine, options.coupon);
  make_output_folder(options.out);
  const Board on_machine = coupon_on_machine(plan, on ? &*on : nullptr);
  ToolpathOptions settings;
  settings.keep_order = true;
  settings.frame = true;
  settings.feed_mm_min = plan.feed_mm_min;
  Scratches shifted = plan.scratches;
  for (std::size_t i = 0; i < shifted.size(); ++i) {
    shifted.x0_mm[i] += plan.coupon.at_mm.x(), shifted.x1_mm[i] += plan.coupon.at_mm.x();
    shifted.y0_mm[i] += plan.coupon.at_mm.y(), shifted.y1_mm[i] += plan.coupon.at_mm.y();
  }
  MachineProfile unasked = plan.machine;
  unasked.depth_table.assumed = false;  // a coupon is carved because the table is assumed
  ProgressBar bar;
  FilesTogether all;
  const ToolpathReport report =
      write_toolpath(shifted, on_machine, nullptr, unasked, settings, options.out / "coupon.gcode", bar.progress());
  bar.clear();
  for (const Finding& finding : plan.findings) tell(finding);
  for (const Finding& finding : report.findings) tell(finding);
  write_scratches(in_coupon(plan, report.sent), options.out / "scratches.csv");
  plan.board.scratches = options.out / "scratches.csv";
  write_board(plan.board, options.out / "board.json");
  write_coupon(plan.coupon, options.out / "coupon.json");
  all.put();
  Report said;
  report_coupon(plan, report, said);
  const std::string zero = on ? "at the board's lower left corner"
                              : fmt::format("at X{:g} Y{:g} left and below of the coupon's corner",
                                            plan.coupon.at_mm.x(), plan.coupon.at_mm.y());
  const bool at_corner = !on && plan.coupon.at_mm.isZero();
  said.next = {{"burin", "print", (options.out / "board.json").string()}};
  said.line(
      "Wrote {}: set work zero {}, carve {}, put the tags on (burin print {}), take the photos with short exposures "
      "beside the usual one; then: burin coupon read {} --photos PHOTOS_DIR --machine {} --out {}\n",
      (options.out / "coupon.json").string(), at_corner ? "at the coupon's lower left corner" : zero,
      shell_word(report.files.front().string()), shell_word((options.out / "board.json").string()),
      shell_word(options.out.string()), shell_word(options.machine),
      shell_word((options.out / "machine.json").string()));
  return said;
}

struct ReadOptions {
  fs::path folder, photos, camera, out;
  std::string machine;
};

// Throws Error for a photo with tags of other coupons only. No later message would identify mixed up coupons.
void fail_if_another(const fs::path& photo, const Coupon& coupon, const fs::path& folder, const Board& board) {
  Photo linear;
  linear.file = photo;
  linear.encoding = Encoding::srgb;  // tag detection works with any encoding
  std::vector<int> others;
  try {
    TagDetector detector(board.tags.family);
    for (const TagDetection& tag : detector.detect_coarse(read_photo(linear).value)) {
      const int number = (tag.id - first_coupon_tag(1)) / kCouponTags + 1;
      if (number == coupon.number) return;
      if (tag.id >= first_coupon_tag(1) && number <= kMostCoupons) others.push_back(number);
    }
  } catch (const Error&) {
    return;  // the actual reader reports an unreadable photo
  }
  if (others.size() < 3 || std::count(others.begin(), others.end(), others.front()) < 3) return;
  fail(photo.string(),
       fmt::format("shows coupon {}, and {} is coupon {}", others.front(), folder.string(), coupon.number),
       "give the photos of this coupon, or the folder of that one");
}

// Reads a session, or makes one of a plain folder of photos.
Session session_of(const fs::path& photos, const fs::path& board_file, const fs::path& folder, const Coupon& coupon,
                   const Board& board, const Progress& progress) {
  if (photos.extension() == ".json") {
    Session session = read_session(photos);
    if (!session.photos.empty()) fail_if_another(session.photos.front().file, coupon, folder, board);
    return session;
  }
  const CaptureResult captured = capture_folder(photos, board_file, folder, progress);
  std::string first;
  for (const Finding& finding : captured.findings) {
    if (finding.severity == Finding::Severity::error && first.empty()) first = sentence(finding);
    // Findings about the whole session concern boards, which need more photos than a coupon.
    if (finding.severity != Finding::Severity::error && !finding.file.empty()) tell(finding);
  }
  if (captured.written.empty()) {
    for (const Photo& photo : captured.session.photos) fail_if_another(photo.file, coupon, folder, board);
    fail(photos.string(), "cannot be used: " + first, "correct the photos and try again");
  }
  return read_session(captured.written);
}

std::string number_text(const CouponNumber& number, int digits) {
  if (number.degree == Degree::not_determined) return "not determined";
  return fmt::format("{:.{}f} +- {:.{}f}{}", number.value, digits, number.sigma, digits,
                     number.degree == Degree::weakly ? " (weakly)" : "");
}

// Adds a number of a cell or of the coupon to the data; its text says more.
void set_number(Facts facts, const char* name, const CouponNumber& number, const char* unit = "") {
  if (number.degree == Degree::not_determined)
    facts.set(name, nullptr);
  else
    facts.set(name, number.value, unit, number.sigma);
}

void set_estimate(Facts facts, const char* name, const Estimate& e) {
  if (e.known) facts.set(name, 100 * e.value, "%", 100 * e.sigma);
}

void report_trend(const std::string& name, const Estimate& e, const std::string& rises, const std::string& falls,
                  Report& report) {
  if (!e.known)
    report.line("{}not determined: too few fans repeat\n", name);
  else if (std::abs(e.value) < 2 * e.sigma)
    report.line("{}none seen ({:+.1f} +- {:.1f} %)\n", name, 100 * e.value, 100 * e.sigma);
  else
    report.line("{}{} by {:.1f} +- {:.1f} % from the first fan to the last\n", name, e.value > 0 ? rises : falls,
                100 * std::abs(e.value), 100 * e.sigma);
}

void report_reading(const Coupon& coupon, const CouponReading& r, Report& report) {
  report.line("coupon {} of {}, {} fans\n", fact("coupon", coupon.number), fact("date", coupon.date),
              fact("fans", coupon.fans.size()));
  set_estimate(report.in("depth"), "repeat", r.depth.repeat);
  set_estimate(report.in("depth"), "wear", r.depth.wear);
  set_estimate(report.in("depth"), "tilt_x", r.depth.tilt_x);
  set_estimate(report.in("depth"), "tilt_y", r.depth.tilt_y);
  set_estimate(report.in("alpha"), "repeat", r.alpha.repeat);
  set_estimate(report.in("alpha"), "wear", r.alpha.wear);
  if (r.travel.known) {
    report.in("direction").set("share", 100 * r.travel.share, "%", 100 * r.travel.sigma);
    report.in("direction").set("towards", r.travel.towards_deg, "deg", r.travel.towards_sigma_deg);
  }
  report.line("  {:>8}  {:>8}  {:>8}  {:>5}  {:<18}  {}\n", "command", "mm/min", "apart mm", "fans", "depth um",
              "alpha");
  for (std::size_t c = 0; c < r.cells.size(); ++c) {
    const CouponCell& cell = coupon.cells[c];
    Facts facts = report.add("cells");
    set_number(facts, "depth", r.cells[c].depth_um, "um");
    set_number(facts, "alpha", r.cells[c].alpha);
    facts.line("  {:>8.4g}  {:>8.4g}  {:>8.2f}  {:>5}  {:<18}  {}\n", fact("command", cell.command),
               fact("feed", cell.feed_mm_min, "mm/min"), fact("spacing", cell.spacing_mm, "mm"),
               fact("fans", r.cells[c].fans), number_text(r.cells[c].depth_um, 2), number_text(r.cells[c].alpha, 4));
  }
  if (r.depth.repeat.known)
    report.line("repeats   fans carved alike differ by {:.1f} +- {:.1f} % in depth, {:.1f} +- {:.1f} % in alpha\n",
                100 * r.depth.repeat.value, 100 * r.depth.repeat.sigma, 100 * r.alpha.repeat.value,
                100 * r.alpha.repeat.sigma);
  report_trend("wear      depth: ", r.depth.wear, "grows", "falls", report);
  report_trend("          alpha: ", r.alpha.wear, "grows", "falls", report);
  for (const auto& [tilt, way] :
       {std::pair(r.depth.tilt_x, "left to right"), std::pair(r.depth.tilt_y, "bottom to top")})
    if (tilt.known && std::abs(tilt.value) > 3 * tilt.sigma)
      report.line("tilt      depth changes by {:+.0f} +- {:.0f} % from {}: the sheet does not lie level\n",
                  100 * tilt.value, 100 * tilt.sigma, way);
  if (!r.travel.known)
    report.line("direction not determined ({:.0f} +- {:.0f} %)\n", 100 * r.travel.share, 100 * r.travel.sigma);
  else if (!r.travel.seen)
    report.line("direction no difference seen ({:.1f} +- {:.1f} %)\n", 100 * r.travel.share, 100 * r.travel.sigma);
  else
    report.line(
        "direction {:.1f} +- {:.1f} % deeper going towards {:.0f} +- {:.0f} degrees (0: right, 90: up) than going "
        "back\n",
        100 * r.travel.share, 100 * r.travel.sigma, r.travel.towards_deg, r.travel.towards_sigma_deg);
}

// Returns the values for the machine's file.
MachineMeasured measured_of(const Coupon& coupon, const CouponReading& r, const Board& board, const Scratches& told) {
  MachineMeasured out;
  out.coupon = coupon.number;
  out.date = coupon.date;
  out.tool_width_um = board.tool_width_um;
  out.usual_feed_mm_min = coupon.usual_feed_mm_min;
  out.usual_spacing_mm = coupon.cells.front().spacing_mm;
  const auto number = [](const CouponNumber& n) {
    return n.degree == Degree::not_determined ? std::nullopt : std::optional(MeasuredNumber{n.value, n.sigma});
  };
  const auto estimate = [](const Estimate& e) {
    return e.known ? std::optional(MeasuredNumber{e.value, e.sigma}) : std::nullopt;
  };
  for (std::size_t c = 0; c < coupon.cells.size(); ++c)
    out.cells.push_back({coupon.cells[c].command, coupon.cells[c].feed_mm_min, coupon.cells[c].spacing_mm,
                         static_cast<int>(r.cells[c].fans), number(r.cells[c].depth_um), number(r.cells[c].alpha)});
  out.repeat_depth = estimate(r.depth.repeat);
  out.repeat_alpha = estimate(r.alpha.repeat);
  for (std::size_t i = 0; i < told.size(); ++i)
    out.wear_over_mm += std::hypot(told.x1_mm[i] - told.x0_mm[i], told.y1_mm[i] - told.y0_mm[i]);
  out.wear_depth = estimate(r.depth.wear);
  out.wear_alpha = estimate(r.alpha.wear);
  if (r.travel.known) {
    out.travel_depth = MeasuredNumber{r.travel.share, r.travel.sigma};
    out.travel_towards_deg = r.travel.towards_deg;
  }
  return out;
}

void write_machine(const ReadOptions& options, const MachineProfile& machine, const MachineMeasured& measured,
                   Report& report) {
  const DepthTable table = measured_table(measured);
  const bool presses = machine.depth_by != DepthBy::fixed_z;
  if (presses && table.rows.empty())
    tell(
        make_warning(FindingCode::depth_uncertain,
                     "no depth table: it takes two commands at the usual speed whose depths are known, and depths that "
                     "rise with them",
                     "take the photos that the notes above name"));
  const std::optional<fs::path> former = write_measured_machine(options.machine, measured, options.out);
  if (former) report.line("The former file is kept as {}\n", fact("former_file", former->string()));
  const std::string what = presses && !table.rows.empty()
                               ? fmt::format("a depth table of {} rows, {:.1f} to {:.1f} um", table.rows.size(),
                                             table.rows.front().depth_um, table.rows.back().depth_um)
                               : "what the coupon told";
  report.line("Wrote {}: {}; next: burin loop PROJECT_DIR --machine {} (kept in the project's loop.toml)\n",
              options.out.string(), what, shell_word(options.out.string()));
}

Report read_coupon_files(ReadOptions options, const CLI::App& command) {
  const std::optional<ProjectSettings> project = settings_around(options.folder);
  if (project && !options.out.empty()) take_from_project(command, *project, {.machine = &options.machine});
  if (!options.out.empty() && options.machine.empty()) throw CLI::RequiredError("--machine");
  const WorkLock lock(options.folder, "burin coupon read");
  const Coupon coupon = read_coupon(options.folder / "coupon.json");
  std::optional<MachineProfile> machine;
  if (!options.machine.empty()) {
    machine = machine_profile(options.machine);
    if (coupon.depth_by != depth_by_name(machine->depth_by))
      fail(options.machine,
           std::string("is a machine of depth_by ") + depth_by_name(machine->depth_by) +
               ", and the coupon was carved by " + coupon.machine + ", whose depth_by is " + coupon.depth_by,
           "give the machine that carved it");
    if (coupon.usual_feed_mm_min != machine->carve_feed_mm_min)
      tell(make_warning(FindingCode::settings,
                        fmt::format("{} carves at {:g} mm/min by now; the depth table will be that of {:g} mm/min",
                                    machine->name, machine->carve_feed_mm_min, coupon.usual_feed_mm_min)));
    if (options.out.extension() != ".json") fail(options.out.string(), "is no .json file", "name one for --out");
    std::error_code unknown;
    if (fs::exists(options.out) && !fs::equivalent(options.machine, options.out, unknown))
      fail(options.out.string(), "is there already",
           "name another file, or give it as --machine to be brought up to date");
  }
  const fs::path board_file = options.folder / "board.json";
  const Board board = read_board(board_file);
  const Scratches told = read_scratches(board.scratches);
  ProgressBar bar;
  const Session session = session_of(options.photos, board_file, options.folder, coupon, board, bar.progress());
  CalibrateOptions calibration;
  if (!options.camera.empty()) {
    calibration.lens = read_cameramodel(options.camera);
    calibration.fix_lens = true;
  }
  const Calibration calibrated = calibrate(session, board, calibration, bar.progress());
  const std::vector<MergedView> photos = photos_for_refine(session, board, calibrated.bench);
  const CouponReading reading = read_coupon_photos(photos, coupon, board, told, calibrated.bench, {}, bar.progress());
  bar.clear();
  for (const Finding& finding : calibrated.findings) tell(finding);
  for (const Finding& finding : reading.findings) tell(finding);
  Report report;
  report_reading(coupon, reading, report);
  if (machine)
    write_machine(options, *machine, measured_of(coupon, reading, board, told), report);
  else
    report.line(
        "Read coupon {}; next, into the machine's file: burin coupon read {} --photos {} --machine {} --out {}\n",
        coupon.number, shell_word(options.folder.string()), shell_word(options.photos.string()),
        project && !project->machine.empty() ? shell_word(project->machine) : "MACHINE",
        shell_word((options.folder / "machine.json").string()));
  return report;
}

}  // namespace

void add_coupon_command(CLI::App& burin) {
  CLI::App* coupon =
      burin.add_subcommand("coupon", "Calibrate a machine's groove depth from a test patch and at least three photos");
  coupon->require_subcommand(1);
  coupon->footer(example("burin coupon write --machine grbl-spring --number 3 --out coupon-3"));
  auto options = std::make_shared<WriteOptions>();
  CLI::App* write = coupon->add_subcommand(
      "write", "Write a 60 mm coupon: tags, number, date, and fans of scratches per preload and speed");
  write
      ->add_option("--machine", options->machine,
                   "Use this machine instead of the project's: " + built_in_machines() +
                       ", or a burin/machine file (JSON or TOML)")
      ->capture_default_str();
  write
      ->add_option("--out", options->out,
                   "Write coupon.json, board.json, scratches.csv and coupon.gcode to this folder")
      ->required();
  write->add_option("--on", options->on,
                    "Carve on this board (board.json), in a corner without tags [default: scrap metal]");
  write
      ->add_option("--at", options->at_mm,
                   "Place the coupon's lower left corner at X Y from work zero, mm [default: 0 0]")
      ->expected(2);
  CLI::Option* preloads =
      write->add_option("--preloads", options->coupon.commands,
                        "Carve at these preloads, softest first: mm below contact, or S values [default: auto]");
  write
      ->add_option("--depths", options->coupon.depths_um,
                   "Carve at these depths instead of --preloads, um, shallowest first")
      ->excludes(preloads);
  write->add_option("--feeds", options->coupon.feeds_mm_min,
                    "Test these speeds too, mm/min [default: a quarter and a half of carve_feed_mm_min]");
  write->add_option("--spacings", options->coupon.spacings_mm,
                    "Set the spacing of all fans, mm, then others to test at the middle preload [default: 0.27 0.2]");
  write->add_option("--date", options->coupon.date, "Carve this text as the date [default: today]");
  write->add_option("--number", options->coupon.number, "Set the coupon's number, which selects its tags")
      ->check(CLI::Range(1, kMostCoupons))
      ->capture_default_str();
  write
      ->add_option("--tool-width", options->tool_width_um,
                   "Set the tool's width wt, four times its tip's radius, um [default: the board's, else 400]")
      ->check(CLI::PositiveNumber);
  write
      ->add_option("--depth", options->depth_um,
                   "Set the nominal depth of a machine with fixed Z, um [default: the board's, else 10]")
      ->check(CLI::PositiveNumber);
  write->footer(
      example("burin coupon write --machine grbl-spring --number 3 --out coupon-3\n"
              "  burin coupon write --machine grbl --depths 6 10 14 20 --feeds 300 --number 4 --out coupon-4"));
  write->callback([options, write] { print(write_coupon_files(*options, *write)); });
  auto reading = std::make_shared<ReadOptions>();
  CLI::App* read =
      coupon->add_subcommand("read", "Measure depth and roughness per preload and speed from at least three photos");
  read->add_option("COUPON_DIR", reading->folder, "Read the coupon from this output folder of burin coupon write")
      ->required();
  read->add_option("--photos", reading->photos, "Read the photos from this folder or session.json")->required();
  read->add_option("--camera", reading->camera,
                   "Use this calibrated lens (.cameramodel) [default: solved from the photos]");
  CLI::Option* machine =
      read->add_option("--machine", reading->machine,
                       "Add the measurements to this machine: " + built_in_machines() + ", or a burin/machine file");
  CLI::Option* out = read->add_option(
      "--out", reading->out, "Write this machine file (.json); if it is --machine's own, keep the old one as .former");
  machine->needs(out);
  read->footer(example("burin coupon read coupon-3 --photos photos --machine grbl-spring --out machine.json"));
  read->callback([reading, read] { print(read_coupon_files(*reading, *read)); });
}

}  // namespace burin
