// burin watch - photos of a board are judged as they arrive in a folder, while the camera still stands there.
// The work is in tools/watch: photo_inbox.h (what has arrived), shoot.h (what it is and what is missing).
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <map>
#include <memory>
#include <thread>

#include "burin/render/error.h"
#include "burin/render/files/json_file.h"
#include "tools/commands.h"
#include "tools/stop_signal.h"
#include "tools/tether/tethered_shoot.h"
#include "tools/watch/photo_inbox.h"
#include "tools/watch/say_shoot.h"
#include "tools/watch/watched_project.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr auto kBetweenLooks = 300ms;

struct WatchArguments {
  fs::path project, photos, plan;
  bool once = false, json = false, copy = false, tether = false;
  std::string port;
  std::vector<double> stops;
};

// All that is said while watching, in words or as lines of JSON.
class Teller {
 public:
  explicit Teller(bool json) : json_(json) {}

  void say(const std::string& event, const fs::path& file, const std::string& words) const {
    if (json_) {
      Json line{{"event", event}, {"words", words}};
      if (!file.empty()) line["photo"] = file.string();
      fmt::print("{}\n", line.dump(-1, ' ', false, Json::error_handler_t::replace));
    } else {
      fmt::print("{}\n", words);
    }
    std::fflush(stdout);
  }

  void say_last(const Shoot& shoot, double seconds, double processor_seconds) const {
    if (json_)
      fmt::print("{}\n", last_photo_json(shoot, seconds, processor_seconds));
    else
      fmt::print("{}", last_photo_words(shoot));
    std::fflush(stdout);
  }

 private:
  bool json_;
};

// A copy for the loop; a file of that name that is there already stays.
void copy_photo(const fs::path& file, const fs::path& into, const Teller& teller) {
  const fs::path to = into / file.filename();
  std::error_code ignored;
  if (fs::exists(to, ignored)) {
    if (fs::file_size(to, ignored) != fs::file_size(file, ignored))
      teller.say("not copied", file, "    not copied: " + to.string() + " is there already, and is another photo");
    return;
  }
  make_output_folder(into);
  copy_whole(file, to);
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
        teller_(options.json),
        project_(watched_project(options.project, options.photos, options.plan)),
        inbox_(project_.photos) {
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
    say_summary();
  }

 private:
  // By a connected camera, beside those that lie in the folder.
  void take_photos() {
    take_news(inbox_.look());
    shoot_tethered({options_.port, options_.stops, project_.photos, options_.once}, project_.shoot,
                   [&](const Shoot& shoot, double seconds, double processor_seconds) {
                     teller_.say_last(shoot, seconds, processor_seconds);
                   });
  }

  void wait_for_photos() {
    const StopOnSignal stop;
    while (!StopOnSignal::asked()) {
      take_news(inbox_.look());
      const bool waits = inbox_.expects();
      if (options_.once && !waits && there_) break;
      if (!waits && there_ && !project_.shoot.photos.empty() &&
          next_step(project_.shoot).kind == NextStep::Kind::finished)
        break;
      std::this_thread::sleep_for(kBetweenLooks);
    }
  }

  void say_what_is_wanted() {
    const Shoot& shoot = project_.shoot;
    std::string words = fmt::format("Watching {} for photos of the board and its {} tags; Ctrl-C ends.\n",
                                    project_.photos.string(), shoot.board.tags.list.size());
    if (!shoot.wanted.empty())
      words += fmt::format("{} shot{} wanted ({}).\n", shoot.wanted.size(), shoot.wanted.size() == 1 ? " is" : "s are",
                           project_.wanted_from);
    if (!project_.plan_line.empty())
      words += "There is no plan of the further photos; it is made by: " + project_.plan_line + "\n";
    words += "    now: " + next_words(shoot);
    teller_.say("began", {}, words);
  }

  void take_news(const InboxNews& news) {
    if (!news.folder_there) {
      if (options_.once)
        fail(project_.photos.string(), "cannot be read (" + news.why_not + ")",
             "check the folder, and that you may read it");
      if (there_)
        teller_.say(
            "folder gone", project_.photos,
            fmt::format("{} cannot be read ({}): waiting until it is back", project_.photos.string(), news.why_not));
      there_ = false;
      return;
    }
    if (!there_) teller_.say("folder back", project_.photos, project_.photos.string() + " is back");
    there_ = true;
    for (const auto& [from, to] : news.renamed) rename(from, to);
    for (const fs::path& file : news.gone) forget(file);
    for (const fs::path& file : news.whole) {
      if (StopOnSignal::asked()) return;
      judge(file);
    }
    for (const fs::path& file : news.given_up) {
      const std::string why = why_unreadable(file, errors_[file]);
      teller_.say("unreadable", file, "BAD " + why);
      ++unreadable_;
    }
  }

  void judge(const fs::path& file) {
    Shoot& shoot = project_.shoot;
    const auto began = std::chrono::steady_clock::now();
    const std::clock_t processor = std::clock();
    try {
      PhotoFacts facts = judge_photo(file, shoot.board, shoot.lens ? &*shoot.lens : nullptr,
                                     shoot.photos.empty() ? nullptr : &shoot.photos.back().facts);
      add_photo(std::move(facts), shoot);
    } catch (const Error& error) {
      errors_[file] = error.what();
      inbox_.not_yet(file);
      return;
    }
    teller_.say_last(shoot, std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count(),
                     static_cast<double>(std::clock() - processor) / CLOCKS_PER_SEC);
    if (options_.copy && !has_errors(shoot.photos.back().faults)) copy_photo(file, project_.keep, teller_);
  }

  void rename(const fs::path& from, const fs::path& to) {
    for (JudgedPhoto& photo : project_.shoot.photos)
      if (photo.facts.file == from) photo.facts.file = to;
    teller_.say("renamed", to, fmt::format("{} is called {} now", from.filename().string(), to.filename().string()));
  }

  void forget(const fs::path& file) {
    if (!remove_photo(file, project_.shoot)) return;
    std::error_code ignored;
    const bool for_raw = fs::exists(file, ignored);
    teller_.say("gone", file,
                fmt::format("{} {}  [{}]", file.filename().string(),
                            for_raw ? "is passed over for the raw file of its name" : "is gone: it counts no more",
                            state_words(project_.shoot)));
  }

  void say_summary() {
    const Shoot& shoot = project_.shoot;
    if (options_.once && shoot.photos.empty())
      fail(project_.photos.string(),
           unreadable_ > 0 ? "holds no photo that can be read"
           : inbox_.passed_over() > 0
               ? fmt::format("holds no photo ({} other file{} or folder{} there; folders within are not looked into)",
                             inbox_.passed_over(), inbox_.passed_over() == 1 ? "" : "s",
                             inbox_.passed_over() == 1 ? " is" : "s are")
               : "holds no photo",
           "give the folder that the photos arrive in");
    std::string words = missing_words(shoot);
    if (!words.empty()) words = "Still wanted:\n" + words;
    const bool finished = !shoot.photos.empty() && next_step(shoot).kind == NextStep::Kind::finished;
    words += fmt::format("{}{}: {}; {}: {}", finished ? "All is there" : "Not all is there yet",
                         unreadable_ > 0 ? fmt::format(" ({} unreadable)", unreadable_) : "", state_words(shoot),
                         finished ? "next" : "go on with burin watch, or, with what there is, next", next_line());
    teller_.say(finished ? "finished" : "ended", {}, words);
  }

  std::string next_line() const {
    return options_.copy ? "burin loop " + shell_word(options_.project.string()) : project_.next;
  }

  WatchArguments options_;
  Teller teller_;
  WatchedProject project_;
  PhotoInbox inbox_;
  std::map<fs::path, std::string> errors_;
  bool there_ = true;
  int unreadable_ = 0;
};

}  // namespace

void add_watch_command(CLI::App& burin) {
  auto o = std::make_shared<WatchArguments>();
  CLI::App* command = burin.add_subcommand(
      "watch", "Judge photos as they arrive in a folder: tags, exposure, blur, which shot it is, what to take now");
  command->add_option("PROJECT_DIR", o->project, "The project whose board is photographed")->required();
  command->add_option("--photos", o->photos,
                      "The folder that photos arrive in (a tethered camera's, a phone's sync), instead of the round's "
                      "own");
  command->add_option("--plan", o->plan, "The plan.json of `burin plan`, if it is not in the project");
  CLI::Option* tether = command->add_flag(
      "--tether", o->tether, "Take the photos by a camera on a USB cable (libgphoto2): as burin capture --tether");
  add_tether_options(*command, tether, o->stops, o->port);
  command->add_flag("--copy", o->copy, "Copy photos that are of use from --photos into the round's folder")
      ->excludes(tether);
  command->add_flag("--once", o->once, "Judge the photos that are there, and end");
  command->add_flag("--json", o->json, "One JSON object a line instead of words")->excludes(tether);
  command->footer(
      example("burin watch my-board\n"
              "  burin watch my-board --photos ~/Phone/Camera --copy\n"
              "  burin watch my-board --tether"));
  command->callback([o] { Watch(*o).run(); });
}

}  // namespace burin
