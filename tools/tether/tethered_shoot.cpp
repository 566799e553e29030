#include "tools/tether/tethered_shoot.h"

#include <poll.h>
#include <unistd.h>

#include <CLI/Validators.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <limits>
#include <set>

#include "burin/base/error.h"
#include "burin/base/files/json_file.h"
#include "burin/capture/exif.h"
#include "tools/commands.h"
#include "tools/stop_signal.h"
#include "tools/watch/say_shoot.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

constexpr int kMostDarker = 5;  // steps of three stops for the glints
// Shares of white. Darker paper hides tags in shadows; brighter paper hides them by clipping.
constexpr double kDark = 0.3, kWhite = 0.97;

// Prefers a raw file to its JPEG, as in `burin capture`.
fs::path one_of(const std::vector<fs::path>& files) {
  const auto raw = std::find_if(files.begin(), files.end(), [](const fs::path& file) { return is_raw(file); });
  return raw != files.end() ? *raw : files.front();
}

// Keeps a late file next to its photo, and deletes a late file of a rejected photo.
void put_late(const std::vector<LateFile>& late) {
  std::error_code ignored;
  for (const LateFile& one : late)
    if (std::none_of(one.beside.begin(), one.beside.end(),
                     [&](const fs::path& file) { return fs::exists(file, ignored); }))
      fs::remove(one.file, ignored);
}

// A camera uses a neighboring time if its dial lacks the requested one, or if the request came too early. EXIF has the
// used time.
void name_other_time(const Exif& exif, double asked_s) {
  constexpr double kSameTime = 0.1;  // 1/60 means 1/64; neighbors differ by a fourth
  if (exif.exposure_s && std::abs(std::log(*exif.exposure_s / asked_s)) > kSameTime)
    tell(make_warning(FindingCode::exif, fmt::format("the camera took {} instead of {}; its own time counts",
                                                     shutter_words(*exif.exposure_s), shutter_words(asked_s))));
}

// Takes and judges a photo; null if it was stopped before its first file.
const JudgedPhoto* take_one(TetheredCamera& camera, double asked_s, const fs::path& photos, Shoot& shoot,
                            const PhotoTold& told, const std::function<bool()>& stopped, std::vector<fs::path>& files) {
  const TakenPhoto taken = camera.take(photos, stopped);
  put_late(taken.late);
  files = taken.files;
  if (files.empty()) return nullptr;
  const auto began = std::chrono::steady_clock::now();
  const std::clock_t processor = std::clock();
  PhotoFacts facts = judge_photo(one_of(files), shoot.board, shoot.lens ? &*shoot.lens : nullptr,
                                 shoot.photos.empty() ? nullptr : &shoot.photos.back().facts, shoot.f_number);
  name_other_time(facts.exif, asked_s);
  add_photo(std::move(facts), shoot);
  told(shoot, std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count(),
       static_cast<double>(std::clock() - processor) / CLOCKS_PER_SEC);
  return &shoot.photos.back();
}

// Deletes the copies of a rejected photo; the camera keeps its own.
void drop(const std::vector<fs::path>& files, Shoot& shoot) {
  remove_photo(one_of(files), shoot);
  std::error_code ignored;
  for (const fs::path& file : files) fs::remove(file, ignored);
}

double time_for(double factor, const PhotoFacts& like) {
  const double f_number = like.exif.f_number.value_or(kAssumedAperture);
  return factor * f_number * f_number / (like.exif.iso.value_or(100) / 100);
}

// Returns a fault that no other exposure removes; empty if there is none. Over- and underexposure hide tags, so a photo
// without tags alone is no such fault.
std::string cannot_go_on(const JudgedPhoto& photo) {
  const PhotoFacts& facts = photo.facts;
  const bool lost = facts.tags.empty() || facts.paper_clipped > kPaperLost || facts.paper < kDark;
  for (const Finding& fault : photo.faults)
    if (fault.severity == Finding::Severity::error && (!lost || !facts.exposure_factor))
      return fault.what + (fault.remedy.empty() ? "" : "; " + fault.remedy);
  return "";
}

// Result of the photos so far: the wanted time is between dark_s and bright_s.
struct PaperSearch {
  std::set<double> tried;
  double dark_s = 0;                                          // longest time with too dark paper
  double bright_s = std::numeric_limits<double>::infinity();  // shortest time with too bright paper
  double dark_paper = 0;                                      // share of white at dark_s; 0 if no tag was detected
  std::string no_tag;  // message for a photo without tags that is neither dark nor clipped
  bool tag_seen = false;
  double useful_s = 0;                                            // of the photos with good tags, the nearest to 60 %
  double useful_stops = std::numeric_limits<double>::infinity();  // its distance from 60 %
};

// Returns the untried time on the dial between the limits that is nearest to the wanted one; 0 if there is none.
double next_time(const TetheredCamera& camera, const PaperSearch& search, double wanted_s) {
  double best = 0;
  for (const double time_s : camera.shutters_s()) {
    if (time_s <= search.dark_s || time_s >= search.bright_s || search.tried.contains(time_s)) continue;
    if (best == 0 || std::abs(std::log(time_s / wanted_s)) < std::abs(std::log(best / wanted_s))) best = time_s;
  }
  return best;
}

// Updates the search with a photo, and returns the right exposure time for its paper.
double learn(double time_s, const JudgedPhoto& photo, const Board& board, PaperSearch& search) {
  const PhotoFacts& facts = photo.facts;
  search.tag_seen |= !facts.tags.empty();
  if (facts.tags.empty() && facts.bright >= kDark && facts.bright <= kWhite && !photo.faults.empty())
    search.no_tag = photo.faults.front().what + "; " + photo.faults.front().remedy;
  double factor = *facts.exposure_factor;
  const bool bright =
      facts.tags.empty() ? facts.bright > kWhite : facts.paper_clipped > kPaperLost || facts.paper > kPaperAt;
  if (facts.tags.empty())
    factor *= bright ? 1.0 / 8 : 8;
  else if (facts.paper_clipped > kPaperLost)
    factor /= 4;
  else
    factor *= kPaperAt / std::max(facts.paper, 0.005);
  if (bright) {
    search.bright_s = time_s;
  } else {
    search.dark_s = time_s;
    search.dark_paper = facts.paper;
  }
  const double stops = facts.tags.empty() ? 0 : std::abs(std::log2(facts.paper / kPaperAt));
  if (shows_tags_well(facts, board) && stops < search.useful_stops) {
    search.useful_stops = stops;
    search.useful_s = time_s;
  }
  return time_for(factor, facts);
}

// Explains why no time shows the paper well.
std::string no_time_words(const PaperSearch& search) {
  if (!search.tag_seen && !search.no_tag.empty()) return search.no_tag;
  if (!(search.dark_s > 0))
    return "the camera's dial has no time that is short enough; less light or a smaller aperture";
  if (!std::isfinite(search.bright_s))
    return "the camera's dial has no time that is long enough; more light, a wider aperture or more ISO";
  const std::string both =
      fmt::format("{} is too dark and {} too bright", shutter_words(search.dark_s), shutter_words(search.bright_s));
  if (search.dark_paper > 0 && search.dark_paper * search.bright_s / search.dark_s < kPaperAt / 2)
    return both + ", more than such times differ: the light changed, or the camera changes ISO or aperture by itself";
  return both +
         ", and the camera's dial has no time between that shows the tags' paper well; change the aperture by half a "
         "stop";
}

// Finds the exposure time of the tags' paper; its photo is the last of `shoot`. Returns 0, with the reason in `why`, if
// it fails.
double find_paper(TetheredCamera& camera, const fs::path& photos, Shoot& shoot, const PhotoTold& told,
                  const std::function<bool()>& stopped, std::string& why) {
  constexpr double kNearPaper = 2.0 / 3;  // stops
  double wanted_s = camera.shutter_s();
  if (!(wanted_s > 0)) wanted_s = 1.0 / 30;
  PaperSearch search;
  std::vector<fs::path> files;
  for (double time_s = next_time(camera, search, wanted_s); time_s > 0;) {
    why = "stopped";
    if (stopped()) return 0;
    search.tried.insert(camera.set_shutter(time_s));
    const JudgedPhoto* photo = take_one(camera, time_s, photos, shoot, told, stopped, files);
    if (photo == nullptr || !(why = cannot_go_on(*photo)).empty()) return 0;
    wanted_s = learn(time_s, *photo, shoot.board, search);
    const double next_s = next_time(camera, search, wanted_s);
    const bool is_best = search.useful_s == time_s;
    if (is_best && (search.useful_stops < kNearPaper || !(next_s > 0))) return time_s;
    drop(files, shoot);
    time_s = next_s;
  }
  if (!(search.useful_s > 0)) {
    why = no_time_words(search);
    return 0;
  }
  camera.set_shutter(search.useful_s);  // not at 60 %, but useful: repeat it
  const JudgedPhoto* photo = take_one(camera, search.useful_s, photos, shoot, told, stopped, files);
  why = photo == nullptr ? "stopped" : cannot_go_on(*photo);
  return why.empty() ? search.useful_s : 0;
}

// Returns true after a line; false at the end of the input, at "q", or after a request to stop.
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
  const std::size_t first = shoot.photos.size() - 1;  // start of the bracket: only its own photos count
  std::set<double> taken{paper_s};
  std::vector<fs::path> files;
  const auto take = [&](double time_s) -> std::string {
    const JudgedPhoto* photo = take_one(camera, time_s, photos, shoot, told, stopped, files);
    return photo == nullptr ? "stopped" : cannot_go_on(*photo);
  };
  for (const double stop : stops) {
    if (stopped()) return "stopped";
    const double time_s = camera.set_shutter(paper_s * std::exp2(stop));
    if (!taken.insert(time_s).second) continue;  // the paper's own time, or the end of the dial
    if (std::string wrong = take(time_s); !wrong.empty()) return wrong;
  }
  for (int i = 0; stops.empty() && i < kMostDarker; ++i) {
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
    if (std::string wrong = take(time_s); !wrong.empty()) return wrong;
  }
  put_late(camera.late_files(photos));
  camera.set_shutter(paper_s);  // start for the next place
  return why;
}

void add_tether_options(CLI::App& command, CLI::Option* tether, std::vector<double>& stops, std::string& port) {
  command
      .add_option("--brackets", stops,
                  "Set a bracket's exposures, stops from tag paper at 60 % of white: 0,-3,-6 [default: 3 darker each "
                  "until no glint clips]")
      ->delimiter(',')
      ->check(CLI::Range(-15.0, 5.0))
      ->needs(tether);
  command.add_option("--port", port, "Use the camera at this port: usb:001,005 [default: the only camera]")
      ->needs(tether);
}

void shoot_tethered(const TetheredShoot& how, Shoot& shoot, const PhotoTold& told) {
  make_output_folder(how.photos);
  const StopOnSignal stop;
  TetheredCamera camera(how.port);
  print_event(
      "connected", {{"camera", camera.model()}, {"folder", how.photos.string()}},
      fmt::format("Connected to a {}; photos go to {}, and stay on its card.\n", camera.model(), how.photos.string()));
  while (!StopOnSignal::asked()) {
    if (!how.once) {
      print_event("waiting", {{"now", next_words(shoot)}},
                  fmt::format("now: {}\nEnter takes the bracket from here, q and Enter ends: ", next_words(shoot)));
      if (!wait_for_enter()) break;
    }
    const std::string why = take_bracket(camera, how.stops, how.photos, shoot, told, &StopOnSignal::asked);
    if (!why.empty() && !StopOnSignal::asked())
      tell(make_warning(FindingCode::exposure, "the bracket is not whole: " + why));
    if (how.once) break;
  }
  print_event("disconnected", {}, "\n");
  camera.put_back();
}

}  // namespace burin
