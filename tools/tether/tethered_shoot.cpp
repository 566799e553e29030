#include "tools/tether/tethered_shoot.h"

#include <poll.h>
#include <unistd.h>

#include <CLI/Validators.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <set>

#include "burin/capture/exif.h"
#include "burin/render/error.h"
#include "burin/render/files/json_file.h"
#include "tools/commands.h"
#include "tools/stop_signal.h"
#include "tools/watch/say_shoot.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

constexpr int kMostTries = 8;   // to find the paper's exposure: 3 bits of a dial of 55 times, and some
constexpr int kMostDarker = 5;  // steps of three stops for the glints

// A raw file goes before its JPEG, as in `burin capture`.
fs::path one_of(const std::vector<fs::path>& files) {
  const auto raw = std::find_if(files.begin(), files.end(), [](const fs::path& file) { return is_raw(file); });
  return raw != files.end() ? *raw : files.front();
}

const JudgedPhoto& take_one(TetheredCamera& camera, const fs::path& photos, Shoot& shoot, const PhotoTold& told,
                            std::vector<fs::path>& files) {
  files = camera.take(photos);
  const auto began = std::chrono::steady_clock::now();
  const std::clock_t processor = std::clock();
  PhotoFacts facts = judge_photo(one_of(files), shoot.board, shoot.lens ? &*shoot.lens : nullptr,
                                 shoot.photos.empty() ? nullptr : &shoot.photos.back().facts);
  add_photo(std::move(facts), shoot);
  told(shoot, std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count(),
       static_cast<double>(std::clock() - processor) / CLOCKS_PER_SEC);
  return shoot.photos.back();
}

// Our own copies of a try that was of no use; the camera keeps its.
void drop(const std::vector<fs::path>& files, Shoot& shoot) {
  remove_photo(one_of(files), shoot);
  std::error_code ignored;
  for (const fs::path& file : files) fs::remove(file, ignored);
}

double time_for(double factor, const PhotoFacts& like) {
  const double f_number = like.exif.f_number.value_or(kAssumedAperture);
  return factor * f_number * f_number / (like.exif.iso.value_or(100) / 100);
}

// What a photo of these exposures has that no other exposure mends; empty if nothing.
std::string cannot_go_on(const JudgedPhoto& photo) {
  const bool dark_or_bright = photo.facts.tags.empty();
  for (const Finding& fault : photo.faults)
    if (fault.severity == Finding::Severity::error && (!dark_or_bright || !photo.facts.exposure_factor))
      return fault.what + (fault.remedy.empty() ? "" : "; " + fault.remedy);
  return "";
}

// The exposure time of the tags' paper: 0 where it was not found, and then `why` says so.
double find_paper(TetheredCamera& camera, const fs::path& photos, Shoot& shoot, const PhotoTold& told,
                  const std::function<bool()>& stopped, std::string& why) {
  double time_s = camera.shutter_s();
  if (!(time_s > 0)) time_s = 1.0 / 30;
  std::set<double> tried;
  for (int i = 0; i < kMostTries; ++i) {
    if (stopped()) {
      why = "stopped";
      return 0;
    }
    time_s = camera.set_shutter(time_s);
    if (!tried.insert(time_s).second) break;
    std::vector<fs::path> files;
    const JudgedPhoto& photo = take_one(camera, photos, shoot, told, files);
    if (why = cannot_go_on(photo); !why.empty()) return 0;
    const PhotoFacts facts = photo.facts;
    constexpr double kNearPaper = 2.0 / 3;  // stops
    const bool good = shows_tags_well(facts, shoot.board);
    if (good && std::abs(std::log2(facts.paper / kPaperAt)) < kNearPaper) return time_s;
    double factor = *facts.exposure_factor;
    if (facts.tags.empty())
      factor *= facts.bright < 0.3 ? 8 : 1.0 / 8;
    else if (facts.paper_clipped > kPaperLost)
      factor /= 4;
    else
      factor *= kPaperAt / std::max(facts.paper, 0.005);
    const double best = time_for(factor, facts);
    if (best > 1.3 * camera.shutters_s().back() || best < camera.shutters_s().front() / 1.3)
      why = best > time_s
                ? "the camera's dial has no time that is long enough; more light, a wider aperture or more ISO"
                : "the camera's dial has no time that is short enough; less light or a smaller aperture";
    if (good && !why.empty()) {  // not at 60 %, but of use
      why.clear();
      return time_s;
    }
    if (!why.empty()) return 0;
    time_s = best;
    drop(files, shoot);
  }
  why = "no exposure shows the tags' paper well: is the light steady, and the whole board in the photo?";
  return 0;
}

// True once a line came; false at the input's end, at "q", or when asked to stop.
bool wait_for_enter() {
  std::string line;
  while (!StopOnSignal::asked()) {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    if (::poll(&input, 1, 200) <= 0) continue;
    char c = 0;
    const ssize_t got = ::read(STDIN_FILENO, &c, 1);
    if (got <= 0) return false;
    if (c == '\n') return line != "q" && line != "Q";
    line += c;
  }
  return false;
}

}  // namespace

std::string take_bracket(TetheredCamera& camera, const std::vector<double>& stops, const fs::path& photos, Shoot& shoot,
                         const PhotoTold& told, const std::function<bool()>& stopped) {
  std::string why;
  const double paper_s = find_paper(camera, photos, shoot, told, stopped, why);
  if (!(paper_s > 0)) return why;
  const std::size_t first = shoot.photos.size() - 1;  // the paper's photo: a bracket is whole by itself
  std::set<double> taken{paper_s};
  std::vector<fs::path> files;
  if (!stops.empty()) {
    for (const double stop : stops) {
      if (stopped()) return "stopped";
      const double time_s = camera.set_shutter(paper_s * std::exp2(stop));
      if (!taken.insert(time_s).second) continue;  // the paper's own, or the end of the dial
      if (std::string wrong = cannot_go_on(take_one(camera, photos, shoot, told, files)); !wrong.empty()) return wrong;
    }
    camera.set_shutter(paper_s);
    return "";
  }
  for (int i = 0; i < kMostDarker; ++i) {
    const NextStep next = next_exposure(shoot, first);
    if (next.kind != NextStep::Kind::expose || !next.for_glints) break;
    if (stopped()) return "stopped";
    const double time_s = camera.set_shutter(time_for(next.factor, shoot.photos.back().facts));
    if (!taken.insert(time_s).second) {
      why =
          "some glints stay clipped at the shortest time of the camera's dial; a smaller aperture or a neutral filter "
          "holds them";
      break;
    }
    if (std::string wrong = cannot_go_on(take_one(camera, photos, shoot, told, files)); !wrong.empty()) return wrong;
  }
  camera.set_shutter(paper_s);  // where the next place begins
  return why;
}

void add_tether_options(CLI::App& command, CLI::Option* tether, std::vector<double>& stops, std::string& port) {
  command
      .add_option("--brackets", stops,
                  "The exposures of each bracket, in stops from the tags' paper at 60 % of white: 0,-3,-6; without it, "
                  "three stops darker each until no glint is clipped")
      ->delimiter(',')
      ->check(CLI::Range(-15.0, 5.0))
      ->needs(tether);
  command.add_option("--port", port, "The camera's port, where there are several: usb:001,005")->needs(tether);
}

void shoot_tethered(const TetheredShoot& how, Shoot& shoot, const PhotoTold& told) {
  make_output_folder(how.photos);
  const StopOnSignal stop;
  TetheredCamera camera(how.port);
  print_text("Connected to a {}; photos go to {}, and stay on its card.\n", camera.model(), how.photos.string());
  while (!StopOnSignal::asked()) {
    if (!how.once) {
      print_text("now: {}\nEnter takes the bracket from here, q and Enter ends: ", next_words(shoot));
      std::fflush(stdout);
      if (!wait_for_enter()) break;
    }
    const std::string why = take_bracket(camera, how.stops, how.photos, shoot, told, &StopOnSignal::asked);
    if (!why.empty() && !StopOnSignal::asked()) note(make_warning("the bracket is not whole: " + why));
    if (how.once) break;
  }
  print_text("\n");
  camera.put_back();
}

}  // namespace burin
