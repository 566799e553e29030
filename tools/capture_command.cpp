#include <fmt/ranges.h>

#include <CLI/Error.hpp>
#include <CLI/Validators.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/capture/folder_session.h"
#include "burin/scene/bench.h"
#include "tools/commands.h"
#include "tools/kept_memory.h"
#include "tools/loop/round_lamps.h"
#include "tools/photographed_lamps.h"
#include "tools/progress_bar.h"
#include "tools/project_settings.h"
#include "tools/steps.h"
#include "tools/tether/tethered_shoot.h"
#include "tools/watch/say_shoot.h"
#include "tools/watch/wanted_shots.h"
#include "tools/work_lock.h"

namespace burin {
namespace {

// Returns true for the name of a light of the bench, or of several: "lamp + room".
bool names_lights_of(const std::string& name, const Bench& bench) {
  const std::string_view between = " + ";
  const std::size_t end = name.find(between);
  const std::string first = name.substr(0, end);
  const bool known =
      std::any_of(bench.lights.begin(), bench.lights.end(), [&](const Light& light) { return light.id == first; });
  return known && (end == std::string::npos || names_lights_of(name.substr(end + between.size()), bench));
}

// Returns the lamp of photos outside of lamp folders (the given one, or that of the bench) and the possible names of
// lamp folders.
PhotoLamps photo_lamps(const std::string& said, bool is_new, const std::filesystem::path& bench_file) {
  if (bench_file.empty()) return {said.empty() ? Photo().light : said, {}};
  const Bench bench = read_bench(bench_file);
  PhotoLamps out{said, lamps_of(bench)};
  if (!said.empty()) {
    if (!is_new && !names_lights_of(said, bench))
      fail("--lamp " + said, fmt::format("{} has no lamp of that name", bench_file.string()),
           out.names.empty() ? "add --new-lamp if it is to be measured now"
                             : fmt::format("known are {}; add --new-lamp if it is another, which is to be measured now",
                                           fmt::join(out.names, ", ")));
    return out;
  }
  if (bench.lights.size() == 1)
    out.of_folder = bench.lights.front().id;
  else if (out.names.size() == 1)  // besides the sun, or in a room
    out.of_folder = out.names.front();
  else if (out.names.empty())
    fail(bench_file.string(), "has no lamp whose name the photos could take", "name it with --lamp NAME");
  return out;
}

// Takes photos with a tethered camera into the folder of photos, or of their lamp if there are several. Reports each
// photo at its arrival.
void take_photos(const CaptureArguments& o, const PhotoLamps& lamps) {
  if (lamps.names.size() > 1 && o.light.empty())
    fail("--tether", fmt::format("{} has several lamps, and a photo does not show which is on", o.bench.string()),
         fmt::format("switch one on alone and name it: --lamp {}; then the next one", shell_word(lamps.names.front())));
  const std::filesystem::path into = lamps.names.size() > 1 ? lamp_folder(o.photos, o.light, lamps.names) : o.photos;
  Shoot shoot;
  shoot.board = read_board(o.board);
  if (!o.bench.empty()) shoot.lens = read_bench(o.bench).lens;
  shoot.f_number = o.f_number;
  shoot.least_places = kFewestPlaces;
  if (!o.plan.empty()) {
    shoot.wanted = planned_shots(o.plan, shoot.board);
    shoot.least_places = 0;
  }
  if (lamps.names.size() > 1) {
    shoot.light = o.light;
    std::erase_if(shoot.wanted, [&](const WantedShot& shot) { return shot.light != o.light; });
  }
  shoot_tethered({o.port, o.stops, into, o.once}, shoot, [](const Shoot& so_far, double, double) {
    print_event("photo", last_photo_json(so_far, 0, 0), last_photo_words(so_far));
  });
}

// Fills missing options from the project of the photos' round.
void take_round(const CLI::App& command, CaptureArguments& o) {
  if (std::optional<ProjectSettings> settings = settings_around(o.photos.empty() ? o.out : o.photos)) {
    const Project& project = settings->at.project;
    const int round = settings->at.round;
    if (round > 0 && std::filesystem::exists(project.round(round) / "board.json")) {
      std::error_code ignored;
      if (std::filesystem::equivalent(o.photos, project.round(round), ignored)) o.photos /= "photos";
      settings->board = project.round(round) / "board.json";
      settings->bench = bench_of_photos(project, round);
      if (const std::vector<std::string> lamp = lamp_arguments(project, round); !lamp.empty())
        settings->light = lamp.back();
    }
    take_from_project(command, *settings,
                      {.board = &o.board, .bench = &o.bench, .light = &o.light, .f_number = &o.f_number});
  }
  if (o.board.empty()) throw CLI::RequiredError("--board");
}

}  // namespace

void add_f_number_option(CLI::App& command, double& f_number) {
  command.add_option("--f-number", f_number, "Set the aperture of photos whose EXIF has none or 0: 8 for f/8")
      ->check(CLI::Range(0.5, 128.0));
}

void add_capture_options(CLI::App& command, CaptureArguments& arguments) {
  add_f_number_option(command, arguments.f_number);
}

Report run_capture(const CaptureArguments& o) {
  const PhotoLamps lamps = photo_lamps(o.light, o.new_lamp, o.bench);
  if (o.tether) take_photos(o, lamps);
  const WorkLock lock(o.out, "burin capture", WorkLock::Where::new_folders);
  refuse_photos_of_other_rounds(o.photos);
  ProgressBar bar;
  const KeptMemory kept;
  const CaptureResult result = capture_folder(o.photos, o.board, o.out, bar.progress(), lamps, o.f_number);
  bar.clear();
  std::size_t errors = 0;
  for (const Finding& finding : result.findings) {
    tell(finding);
    errors += finding.severity == Finding::Severity::error ? 1 : 0;
  }
  if (result.written.empty())
    fail(o.photos.string(), counted(errors, "error") + " found, no session was written",
         "correct or remove the photos named above");
  std::set<std::string> lit;
  for (const Photo& photo : result.session.photos) lit.insert(photo.light);
  Report report;
  report.data = {{"session", result.written.string()},
                 {"photos", result.session.photos.size()},
                 {"views", result.views},
                 {"lamps", lit}};
  if (!is_in_round(o.out))
    report.next.push_back({"burin", "calibrate", result.written.string(), "--out", o.out.string()});
  report.line("Wrote {}: {} of {}{}{}\n", result.written.string(), counted(result.session.photos.size(), "photo"),
              counted(static_cast<std::size_t>(result.views), "view"),
              lit.size() > 1 ? fmt::format(" under {} lamps", lit.size()) : "",
              report.next.empty() ? "." : "; next: " + command_text(report.next.front()));
  return report;
}

void add_capture_command(CLI::App& burin) {
  auto options = std::make_shared<CaptureArguments>();
  CLI::App* command = burin.add_subcommand("capture", "Build a session from a folder of photos, and check the photos");
  command->add_option(
      "PHOTOS_DIR", options->photos,
      "Read photos with EXIF from here: JPEG, HEIC, PNG, TIFF, EXR or raw [default with --tether: OUT/photos]");
  command->add_option("--board", options->board, "Use the board in the photos (board.json) [default: the project's]");
  command->add_option("--out", options->out, "Write session.json to this folder")->required();
  command->add_option(
      "--bench", options->bench,
      "Take lamp names from this bench.json; photos of several lamps are in PHOTOS_DIR/LAMP [default: the project's]");
  command->add_option("--lamp", options->light, "Assign this lamp to photos outside the lamps' folders");
  command->add_flag("--new-lamp", options->new_lamp, "Allow --lamp to name a lamp that the bench does not have yet");
  add_f_number_option(*command, options->f_number);
  CLI::Option* tether =
      command->add_flag("--tether", options->tether,
                        "Take a bracket per place with a USB camera (libgphoto2) at M, and check each photo");
  add_tether_options(*command, tether, options->stops, options->port);
  command->add_option("--plan", options->plan, "Take the places of this plan.json of burin plan")->needs(tether);
  command->add_flag("--once", options->once, "Take one bracket at the camera's present place, without questions")
      ->needs(tether);
  command->footer(
      example("burin capture photos --board board.json --bench bench.json --out session\n"
              "  burin capture --tether --board board.json --bench bench.json --plan plan/plan.json --out session"));
  command->callback([options, command] {
    if (options->photos.empty() && !options->tether) throw CLI::RequiredError("PHOTOS_DIR");
    take_round(*command, *options);
    if (options->photos.empty()) options->photos = options->out / "photos";
    print(run_capture(*options));
  });
}

}  // namespace burin
