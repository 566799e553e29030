// burin watch - judges photos of a board as they arrive in a folder, while the camera is still in place. The work is in
// tools/watch: photo_inbox.h (arrived files), kept_copies.h (their copies), shoot.h (their contents and the missing
// shots).
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <map>
#include <memory>
#include <thread>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/files/json_file.h"
#include "burin/capture/exif.h"
#include "burin/capture/lamp_folders.h"
#include "burin/capture/photo_look.h"
#include "burin/capture/same_shot.h"
#include "tools/commands.h"
#include "tools/content_hash.h"
#include "tools/project_settings.h"
#include "tools/stop_signal.h"
#include "tools/tether/tethered_shoot.h"
#include "tools/watch/kept_copies.h"
#include "tools/watch/photo_inbox.h"
#include "tools/watch/say_shoot.h"
#include "tools/watch/watched_project.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

// A photo is judged 0.2 to 0.4 s after its last byte, and copied after two more seconds without change.
constexpr auto kBetweenLooks = 100ms, kStays = 200ms, kStaysForCopies = 2000ms;

// Time limit for the present photo after a request to stop.
constexpr auto kLongestStop = 1500ms;

struct WatchArguments {
  fs::path project, photos, plan;
  bool once = false, copy = false, tether = false;
  std::string port, light;
  std::vector<double> stops;
  double f_number = 0;
};

void say(const std::string& event, const fs::path& file, const std::string& words) {
  Json data{{"words", words}};
  if (!file.empty()) data["photo"] = file.string();
  print_event(event, data, words + "\n");
}

void say_last(const Shoot& shoot, double seconds, double processor_seconds) {
  print_event("photo", last_photo_json(shoot, seconds, processor_seconds), last_photo_words(shoot));
}

std::string why_unreadable(const fs::path& file, const std::string& error) {
  std::error_code ignored;
  if (::access(file.c_str(), R_OK) != 0 && fs::exists(file, ignored))
    return file.string() + ": you have no right to read it; give yourself that: chmod u+r " + shell_word(file.string());
  if (fs::file_size(file, ignored) == 0) return file.string() + ": is empty (0 bytes); copy it from the camera again";
  return error;
}

class Watch {
 public:
  explicit Watch(const WatchArguments& options)
      : options_(options),
        project_(watched_project(options.project, options.photos, options.plan)),
        inbox_(project_.photos, project_.lamps, kStays),
        copies_(kStaysForCopies, say) {
    project_.shoot.f_number = options.f_number;
    take_light();
    if (options.copy && project_.keep.empty())
      fail("--copy", "the project has no round yet whose photos these could be",
           "make one: burin loop " + shell_word(options.project.string()));
    if (options.copy && project_.photos == project_.keep)
      fail("--copy", "the photos arrive where the loop takes them from",
           "leave --copy out, or name another folder with --photos");
  }

  void run() {
    say_what_is_wanted();
    options_.tether ? take_photos() : wait_for_photos();
    copies_.report_rest();
    say_summary();
    if (const int left = copies_.waiting(); left > 0 && !StopOnSignal::asked())
      fail("--copy", counted(static_cast<std::size_t>(left), "photo") + " not copied",
           "correct the causes above, and keep these files; then the same command continues");
  }

 private:
  bool several_lamps() const { return project_.lamps.size() > 1; }

  // Takes the lamp from the options. A tethered camera takes the photos of one lamp after the other.
  void take_light() {
    const std::string& said = options_.light;
    const auto& lamps = project_.lamps;
    if (!said.empty() && std::find(lamps.begin(), lamps.end(), said) == lamps.end()) {
      std::string known;
      for (const std::string& lamp : lamps) known += (known.empty() ? "" : ", ") + lamp;
      fail("--lamp " + said, "no photos are wanted under a lamp of that name",
           known.empty() ? "leave --lamp out: no plan names the lamps" : "choose one of: " + known);
    }
    if (!options_.tether || !several_lamps()) return;
    if (said.empty())
      fail("--tether", "photos are wanted under several lamps, and a photo does not show which is on",
           fmt::format("switch one on alone and name it: burin watch {} --tether --lamp {}; then the next one",
                       shell_word(options_.project.string()), shell_word(lamps.front())));
    std::erase_if(project_.shoot.wanted, [&](const WantedShot& shot) { return shot.light != said; });
  }

  // Returns a photo's lamp: its folder's, or the given one; empty if unknown.
  std::string light_of(const fs::path& file) const {
    if (!several_lamps()) return {};
    for (const LampFolder& lamp : lamp_folders(project_.photos, project_.lamps))
      if (file.parent_path() == lamp.folder) return lamp.light;
    return options_.light;
  }

  // Returns the loop's folder for photos under a lamp.
  fs::path folder_for(const fs::path& photos, const std::string& light) const {
    return several_lamps() && !light.empty() ? lamp_folder(photos, light, project_.lamps) : photos;
  }

  // Takes photos with a tethered camera, in addition to those in the folder.
  void take_photos() {
    take_news(inbox_.look());
    project_.shoot.light = several_lamps() ? options_.light : "";
    shoot_tethered({options_.port, options_.stops, folder_for(project_.photos, options_.light), options_.once},
                   project_.shoot, [&](const Shoot& shoot, double seconds, double processor_seconds) {
                     say_last(shoot, seconds, processor_seconds);
                   });
  }

  void wait_for_photos() {
    const StopOnSignal stop(kLongestStop);
    while (!StopOnSignal::asked()) {
      take_news(inbox_.look());
      for (const fs::path& file : copies_.look()) judge(file);
      const bool waits = inbox_.expects() || copies_.waiting() > 0;
      // Failed copies are retried only during watching.
      if (options_.once && there_ && !inbox_.expects() && copies_.waiting() == copies_.refused()) break;
      if (!waits && there_ && !project_.shoot.photos.empty() &&
          next_step(project_.shoot).kind == NextStep::Kind::finished)
        break;
      std::this_thread::sleep_for(kBetweenLooks);
    }
  }

  void say_what_is_wanted() {
    const Shoot& shoot = project_.shoot;
    std::string words = fmt::format("Watching {} for photos of the board and its {}; Ctrl-C ends.\n",
                                    project_.photos.string(), counted(shoot.board.tags.list.size(), "tag"));
    if (!shoot.wanted.empty())
      words += fmt::format("{} wanted ({}).\n", counted(shoot.wanted.size(), "shot"), project_.wanted_from);
    if (several_lamps() && !options_.tether)
      words += fmt::format("A photo does not show which lamp was on: put photos into {}{}.\n",
                           lamp_folders_in_words(project_.photos, project_.lamps),
                           options_.light.empty() ? ", or name it with --lamp NAME"
                                                  : "; others are taken to be under \"" + options_.light + "\"");
    if (!project_.plan_line.empty())
      words += "There is no plan of the further photos; it is made by: " + project_.plan_line + "\n";
    words += "    now: " + next_words(shoot);
    say("began", {}, words);
  }

  void take_news(const InboxNews& news) {
    if (!news.folder_there) {
      if (options_.once)
        fail(project_.photos.string(), "cannot be read (" + news.why_not + ")",
             "check the folder, and that you may read it");
      if (there_)
        say("folder gone", project_.photos,
            fmt::format("{} cannot be read ({}): waiting until it is back", project_.photos.string(), news.why_not));
      there_ = false;
      return;
    }
    if (!there_) say("folder back", project_.photos, project_.photos.string() + " is back");
    there_ = true;
    for (const auto& [from, to] : news.renamed) rename(from, to);
    for (const fs::path& file : news.gone) forget(file);
    for (const fs::path& file : news.whole) {
      if (StopOnSignal::asked()) return;
      judge(file);
    }
    for (const fs::path& file : news.given_up) {
      const std::string why = why_unreadable(file, errors_[file]);
      say("unreadable", file, "error: " + why);
      ++unreadable_;
    }
  }

  void judge(const fs::path& file) {
    Shoot& shoot = project_.shoot;
    const auto began = std::chrono::steady_clock::now();
    const std::clock_t processor = std::clock();
    try {
      fs::path other;
      const std::optional<SharedShot> shared = shared_shot(file, other);
      if (shared && shared->newcomer_goes) {
        pass_over(file, other, shared->said);
        return;
      }
      PhotoFacts facts = judge_photo(file, shoot.board, shoot.lens ? &*shoot.lens : nullptr,
                                     shoot.photos.empty() ? nullptr : &shoot.photos.back().facts, shoot.f_number);
      shoot.light = light_of(file);
      add_photo(std::move(facts), shoot);
      find_no_lamp(file);
      find_other_round(file);
      if (shared) pass_over(other, file, shared->said);
    } catch (const Error& error) {
      errors_[file] = error.what();
      inbox_.not_yet(file);
      return;
    }
    say_last(shoot, std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count(),
             static_cast<double>(std::clock() - processor) / CLOCKS_PER_SEC);
    if (!options_.copy || has_errors(shoot.photos.back().faults)) return;
    if (several_lamps() && shoot.light.empty())
      say("not copied", file, "    not copied: the lamp is unknown");
    else
      copies_.want(file, folder_for(project_.keep, shoot.light));
  }

  // One photo per shot, as in `burin capture`: looks for a judged photo of the same shot as this file.
  std::optional<SharedShot> shared_shot(const fs::path& file, fs::path& other) {
    passed_over_.erase(file);
    looks_.erase(file);
    std::vector<IncomingPhoto> others;
    for (const JudgedPhoto& photo : project_.shoot.photos)
      if (photo.facts.file != file) others.push_back({photo.facts.file, photo.facts.exif, {}, photo.light});
    const std::size_t judged = others.size();
    for (const auto& [passed_over, kept] : passed_over_)
      others.push_back({passed_over, read_exif(passed_over), {}, light_of(passed_over)});
    const auto look_of = [&](const Photo& photo) {
      const auto known = looks_.find(photo.file);
      return known != looks_.end() ? known->second : looks_[photo.file] = look_at(photo);
    };
    const auto shared = find_shared_shot({file, read_exif(file), {}, light_of(file)}, others, look_of);
    if (!shared || (shared->with >= judged && !shared->newcomer_goes)) return std::nullopt;
    other = others[shared->with].file;
    if (shared->with >= judged) other = passed_over_[other];
    return shared;
  }

  void pass_over(const fs::path& file, const fs::path& kept, const Finding& said) {
    passed_over_[file] = kept;
    remove_photo(file, project_.shoot);
    say("passed over", file, sentence(said));
  }

  // `burin capture` refuses photos of another round; here the user can still correct it at the board.
  void find_other_round(const fs::path& file) {
    if (project_.other_rounds.empty()) return;
    const auto other = project_.other_rounds.find(content_hash(file));
    if (other == project_.other_rounds.end()) return;
    project_.shoot.photos.back().faults.push_back({FindingCode::wrong_board,
                                                   Finding::Severity::error,
                                                   {},
                                                   "is, byte for byte, " + other->second + ": it shows another board",
                                                   "take it out, and photograph this round's board"});
  }

  // With several lamps, `burin capture` needs to know the one that was on; here the order of the shots decides.
  void find_no_lamp(const fs::path& file) {
    if (!several_lamps() || !project_.shoot.light.empty() || file.parent_path() != project_.photos) return;
    project_.shoot.photos.back().faults.push_back(
        {FindingCode::lamp_folder,
         Finding::Severity::warning,
         {},
         "lies in no lamp's folder: the lamp is unknown",
         "put it into " + lamp_folders_in_words(project_.photos, project_.lamps) + ", or name it with --lamp NAME"});
  }

  void rename(const fs::path& from, const fs::path& to) {
    Shoot& shoot = project_.shoot;
    copies_.rename(from, to);
    for (auto& [file, kept] : passed_over_)
      if (kept == from) kept = to;
    const auto photo = std::find_if(shoot.photos.begin(), shoot.photos.end(),
                                    [&](const JudgedPhoto& p) { return p.facts.file == from; });
    // moved to its lamp's folder, so perhaps another shot
    if (photo != shoot.photos.end() && photo->light != light_of(to)) {
      PhotoFacts facts = photo->facts;
      facts.file = to;
      remove_photo(from, shoot);
      shoot.light = light_of(to);
      add_photo(std::move(facts), shoot);
      find_no_lamp(to);
      say("renamed", to, fmt::format("{} is {} now", from.string(), to.string()));
      say_last(shoot, 0, 0);
      if (options_.copy && !has_errors(shoot.photos.back().faults) && !shoot.light.empty())
        copies_.want(to, folder_for(project_.keep, shoot.light));
      return;
    }
    if (photo != shoot.photos.end()) photo->facts.file = to;
    say("renamed", to, fmt::format("{} is called {} now", from.filename().string(), to.filename().string()));
  }

  void forget(const fs::path& file) {
    passed_over_.erase(file);
    if (!remove_photo(file, project_.shoot)) return;
    say("gone", file,
        fmt::format("{} is gone: it counts no more  [{}]", file.filename().string(), state_words(project_.shoot)));
    const auto stands_in =
        std::find_if(passed_over_.begin(), passed_over_.end(), [&](const auto& one) { return one.second == file; });
    if (stands_in != passed_over_.end()) judge(fs::path(stands_in->first));
  }

  void say_summary() {
    const Shoot& shoot = project_.shoot;
    if (options_.once && shoot.photos.empty())
      fail(project_.photos.string(),
           unreadable_ > 0 ? "holds no photo that can be read"
           : inbox_.passed_over() > 0
               ? fmt::format("holds no photo, but {}; folders within are not looked into",
                             counted(static_cast<std::size_t>(inbox_.passed_over()), "other thing"))
               : "holds no photo",
           "give the folder that the photos arrive in");
    std::string words = missing_words(shoot);
    if (!words.empty()) words = "Still wanted:\n" + words;
    const bool finished = !shoot.photos.empty() && next_step(shoot).kind == NextStep::Kind::finished;
    words += fmt::format("{}{}: {}; {}: {}", finished ? "All is there" : "Not all is there yet",
                         unreadable_ > 0 ? fmt::format(" ({} unreadable)", unreadable_) : "", state_words(shoot),
                         finished ? "next" : "go on with burin watch, or, with what there is, next", next_line());
    say(finished ? "finished" : "ended", {}, words);
  }

  std::string next_line() const {
    return options_.copy ? "burin loop " + shell_word(options_.project.string()) : project_.next;
  }

  WatchArguments options_;
  WatchedProject project_;
  PhotoInbox inbox_;
  KeptCopies copies_;
  std::map<fs::path, std::string> errors_;
  std::map<fs::path, PhotoLook> looks_;
  std::map<fs::path, fs::path> passed_over_;  // by skipped file: the photo of the same shot
  bool there_ = true;
  int unreadable_ = 0;
};

}  // namespace

void add_watch_command(CLI::App& burin) {
  auto o = std::make_shared<WatchArguments>();
  CLI::App* command = burin.add_subcommand(
      "watch", "Check photos as they arrive in a folder: tags, exposure, blur, shot, and the next photo");
  command->add_option("PROJECT_DIR", o->project,
                      "Check photos of this project's board [default: the working directory's project]");
  command->add_option("--photos", o->photos,
                      "Watch this folder of a tethered camera or a phone's sync [default: the round's own]");
  command->add_option("--plan", o->plan, "Use this plan.json of burin plan [default: the project's]");
  CLI::Option* tether = command->add_flag(
      "--tether", o->tether, "Take the photos with a USB camera (libgphoto2), as burin capture --tether does");
  add_tether_options(*command, tether, o->stops, o->port);
  command->add_option("--lamp", o->light,
                      "Assign this lamp to --tether's photos and to photos outside the lamps' folders");
  command->add_flag("--copy", o->copy, "Copy usable photos from --photos into the round's folder")->excludes(tether);
  command->add_flag("--once", o->once, "Check the present photos, then exit");
  command->footer(
      example("burin watch my-board\n"
              "  burin watch my-board --photos ~/Phone/Camera --copy\n"
              "  burin watch my-board --tether"));
  add_f_number_option(*command, o->f_number);
  command->callback([o, command] {
    o->project = project_folder(o->project, "PROJECT_DIR");
    if (const auto project = settings_around(o->project))
      take_from_project(*command, *project, {.f_number = &o->f_number});
    Watch(*o).run();
  });
}

}  // namespace burin
