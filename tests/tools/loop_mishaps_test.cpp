// Proves: whatever happens to a person between a bare sheet and the third design - edits, stops at any moment, photos
// that come late or go, another machine, two loops at once, results changed by hand - is noticed and said before
// anything is done, and the end is the same, to the bit, as that of a run in which nothing went wrong.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <random>
#include <thread>

#include "tests/tools/loop_bench.h"
#include "tests/tools/program.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const std::vector<std::string> kFirstViews{"d0", "d1", "c0", "c2", "c5"};
// Where the loop says that a photo would tell the depth.
const Eigen::Vector3d kLateEye{401, -13, 263};

void wait_s(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

// `burin` at work beside the test.
class Running {
 public:
  Running(const TemporaryFolder& folder, const std::vector<std::string>& arguments) {
    std::vector<std::string> words{places::program()};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    const std::string directory = folder.path().string();
    process_ = ::fork();
    if (process_ != 0) return;
    const int nothing = ::open("/dev/null", O_RDWR);
    for (int i = 0; i < 3; ++i) ::dup2(nothing, i);
    if (::chdir(directory.c_str()) == 0) ::execv(argv[0], argv.data());
    ::_exit(99);
  }
  ~Running() {
    if (process_ > 0) stop(SIGKILL);
  }
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;

  pid_t process() const { return process_; }

  /// The exit code, or minus the signal that ended it.
  int stop(int signal) {
    ::kill(process_, signal);
    int status = 0;
    ::waitpid(process_, &status, 0);
    process_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

 private:
  pid_t process_ = -1;
};

// A person with a project and a workshop.
struct Person {
  TemporaryFolder folder;
  fs::path project = folder / "project";

  Person() {
    make_tiny_project(folder, kFirstViews, 0.5);
    add_view_to_truth(folder, "n0", kLateEye);
    folder.write("machines/spring.toml",
                 "format = \"burin/machine\"\nversion = 1\nname = \"spring\"\nbased_on = \"grbl-spring\"\n");
  }

  Outcome loop(std::vector<std::string> words = {}) const {
    words.insert(words.begin(), {"loop", "project"});
    return run_burin(folder, words);
  }
  Outcome status() const { return run_burin(folder, {"status", "project"}); }

  /// Carves what was sent and puts photos of these views into the round's folder.
  void photograph(const std::string& round, const std::vector<std::string>& views) const {
    const fs::path sent = project / round / "sent.csv", shop = folder / ("shop-" + round + views.front());
    std::vector<std::string> words{"simulate", "truth.json",  "--scratches", sent.string(),
                                   "--out",    shop.string(), "--views"};
    words.insert(words.end(), views.begin(), views.end());
    const Outcome photos = run_burin(folder, words);
    ASSERT_EQ(photos.exit_code, 0) << photos.err;
    fs::create_directories(project / round / "photos");
    fs::copy(shop / "photos", project / round / "photos");
  }

  std::string text(const std::string& file) const { return file_text(project / file); }
};

const std::vector<std::string> kOptions{"--machine", "machines/spring.toml", "--iterations", "20", "--pixels", "128"};

std::vector<std::string> with_late(std::vector<std::string> views) {
  views.push_back("n0");
  return views;
}

// Nothing goes wrong.
void turn_straight(const Person& person) {
  ASSERT_EQ(person.loop(kOptions).exit_code, 0);
  for (const char* round : {"round-01", "round-02"}) {
    person.photograph(round, with_late(kFirstViews));
    const Outcome turned = person.loop();
    ASSERT_EQ(turned.exit_code, 0) << turned.out << turned.err;
  }
}

// Designing is stopped, twice loops meet, files change: nothing is done that was not asked for.
void mishaps_before_carving(const Person& p) {
  const std::vector<std::string> endless{"loop",         "project", "--machine", "machines/spring.toml",
                                         "--iterations", "1000000", "--pixels",  "128"};
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    Running first(p.folder, endless);
    wait_s(1.5);
    const Outcome second = p.loop();
    EXPECT_EQ(second.exit_code, 1);
    EXPECT_THAT(second.err,
                HasSubstr("is being worked on by burin loop, process " + std::to_string(first.process()) + " since"));
    EXPECT_EQ(first.stop(signal), 128 + signal) << "stopped is not done";
    EXPECT_THAT(p.status().out, AllOf(HasSubstr("ended early"), Not(HasSubstr("toolpath"))));
    EXPECT_FALSE(fs::exists(p.project / "round-01" / "scratches.csv"));
  }
  {
    Running killed(p.folder, endless);
    wait_s(1);
    EXPECT_EQ(killed.stop(SIGKILL), -SIGKILL);
  }
  // Its lock is free, and the options that were said stay said.
  ASSERT_EQ(p.loop({"--iterations", "20"}).exit_code, 0);
  const std::string gcode = p.text("round-01/board.gcode"), scratches = p.text("round-01/scratches.csv");
  const Outcome idle = p.loop();
  EXPECT_THAT(idle.out, AllOf(HasSubstr("machines/spring.toml"), Not(HasSubstr("> burin"))));

  const auto asks = [&](const std::vector<std::string>& words, const std::string& about) {
    const Outcome asked = p.loop(words);
    EXPECT_EQ(asked.exit_code, 1) << asked.out;
    EXPECT_THAT(asked.err, AllOf(HasSubstr(about), HasSubstr("--force round-01/"), HasSubstr("--allow-stale")));
    EXPECT_THAT(asked.out, Not(HasSubstr("> burin")));
  };
  // The board's file: named, kept when told so, and no question any more; back as it was, none either.
  const std::string board = p.text("board.json");
  p.folder.write("project/board.json", board + "\n");
  asks({}, "board.json changed since round-01/design");
  EXPECT_EQ(p.loop({"--allow-stale"}).exit_code, 0);
  EXPECT_EQ(p.loop().exit_code, 0);
  p.folder.write("project/board.json", board);
  EXPECT_EQ(p.loop().exit_code, 0);
  // A picture; the design made anew leaves the former one for who carved it.
  const std::string boat = p.text("targets/boat.png");
  fs::copy_file(p.project / "targets" / "moon.png", p.project / "targets" / "boat.png",
                fs::copy_options::overwrite_existing);
  asks({}, "targets/boat.png changed since round-01/design");
  ASSERT_EQ(p.loop({"--force", "design"}).exit_code, 0);
  EXPECT_NE(p.text("round-01/scratches.csv"), scratches);
  p.folder.write("project/targets/boat.png", boat);
  ASSERT_EQ(p.loop({"--force", "design"}).exit_code, 0);
  EXPECT_EQ(p.text("round-01/scratches.csv"), scratches);
  bool former = false;
  for (const auto& entry : fs::recursive_directory_iterator(p.project / "round-01" / "former"))
    former = former || (entry.path().filename() == "board.gcode" && file_text(entry.path()) == gcode);
  EXPECT_TRUE(former);
  // Another machine, and back; a G-code that a person edited.
  asks({"--machine", "marlin"}, "machine was ../machines/spring.toml and is marlin");
  EXPECT_EQ(p.loop({"--machine", "machines/spring.toml"}).exit_code, 0);
  p.folder.write("project/round-01/board.gcode", gcode + "G0 X0 Y0\n");
  asks({}, "round-01/board.gcode was changed by hand");
  ASSERT_EQ(p.loop({"--force", "toolpath"}).exit_code, 0);
  EXPECT_EQ(p.text("round-01/board.gcode"), gcode);
}

// Measuring is killed again and again, until it ends.
Outcome loop_with_stops(const Person& p, int stops, std::mt19937& random) {
  std::uniform_real_distribution<double> seconds(0.3, 6);
  for (int i = 0; i < stops; ++i) {
    Running loop(p.folder, {"loop", "project"});
    wait_s(seconds(random));
    loop.stop(i % 2 == 0 ? SIGKILL : SIGTERM);
  }
  return p.loop();
}

void mishaps_with_photos(const Person& p, std::mt19937& random) {
  const std::string sent = p.text("round-01/sent.csv");
  p.photograph("round-01", kFirstViews);
  // Too few photos for the depth: no second board, until the photo that is asked for has come.
  const Outcome unknown = loop_with_stops(p, 3, random);
  EXPECT_EQ(unknown.exit_code, 1) << unknown.out;
  EXPECT_THAT(unknown.out, AllOf(HasSubstr("depth_um is not determined"), HasSubstr("next photo: camera")));
  EXPECT_THAT(unknown.err, HasSubstr("--allow-undetermined depth_um"));
  EXPECT_FALSE(fs::exists(p.project / "round-02" / "scratches.csv"));
  EXPECT_EQ(p.loop({"--allow-undetermined", "alpha"}).exit_code, 1);

  const Outcome metal = p.loop({"--force", "round-01/design"});
  EXPECT_EQ(metal.exit_code, 1);
  EXPECT_THAT(metal.err, HasSubstr("carved and photographed"));

  // The photo comes, another one goes for a while.
  p.photograph("round-01", {"n0"});
  const fs::path photo = p.project / "round-01" / "photos" / "c2_a.png";
  fs::rename(photo, p.folder / "c2_a.png");
  EXPECT_THAT(p.status().out, AllOf(HasSubstr("n0_c.png are new"), HasSubstr("c2_a.png is gone")));
  loop_with_stops(p, 0, random);
  fs::rename(p.folder / "c2_a.png", photo);
  Outcome measured = loop_with_stops(p, 1, random);
  // A second design may have been made for the bench without that photo: it is not used for the bench with it.
  if (measured.exit_code != 0) {
    EXPECT_THAT(measured.err, AllOf(HasSubstr("round-01/bench.json"), HasSubstr("changed since round-02/design")));
    measured = p.loop({"--force", "design"});
  }
  ASSERT_EQ(measured.exit_code, 0) << measured.out << measured.err;
  EXPECT_EQ(p.text("round-01/sent.csv"), sent);
}

TEST(LoopMishaps, EndAsAStraightRunDoes) {
  const Person straight, unlucky;
  turn_straight(straight);
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  mishaps_before_carving(unlucky);
  mishaps_with_photos(unlucky, random);
  if (HasFatalFailure()) return;
  unlucky.photograph("round-02", with_late(kFirstViews));
  const Outcome last = loop_with_stops(unlucky, 1, random);
  ASSERT_EQ(last.exit_code, 0) << last.out << last.err;

  for (const char* file :
       {"round-01/scratches.csv", "round-01/sent.csv", "round-01/board.gcode", "round-01/session.json",
        "round-01/bench.json", "round-02/scratches.csv", "round-02/board.gcode", "round-02/bench.json",
        "round-03/scratches.csv", "round-03/board.gcode"})
    EXPECT_EQ(unlucky.text(file), straight.text(file)) << file;

  // And every file that the third board rests on is known, and is as it was; one that is touched is found.
  const std::vector<std::string> trace{"trace", "project/round-03/board.gcode"};
  const Outcome same = run_burin(unlucky.folder, trace);
  EXPECT_EQ(same.exit_code, 0) << same.err;
  EXPECT_THAT(same.out, AllOf(HasSubstr("round-01/photos/n0_a.png"), HasSubstr("targets/boat.png")));
  std::ofstream(unlucky.project / "round-01" / "photos" / "n0_a.png", std::ios::app) << "x";
  const Outcome touched = run_burin(unlucky.folder, trace);
  EXPECT_EQ(touched.exit_code, 1);
  EXPECT_THAT(touched.out, ::testing::ContainsRegex("round-01/photos/n0_a.png  [0-9a-f]+  CHANGED"));
}

// The project's lamp is called otherwise than the workshop's, and somebody photographed from two places a few
// millimeters apart: the loop asks which one was meant, with distances, and keeps the design's names.
TEST(LoopMishaps, AsksWhichEyeItWasAndKeepsTheNamesOfTheDesign) {
  const Person p;
  nlohmann::ordered_json bench = read_json_file(p.project / "bench.json"),
                         design = read_json_file(p.project / "design.json");
  bench["lights"][0]["id"] = "ceiling";
  for (auto& view : design["views"]) view["light"] = "ceiling";
  std::ofstream(p.project / "bench.json") << bench;
  std::ofstream(p.project / "design.json") << design;
  Eigen::Matrix3d R;
  Eigen::Vector3d t;
  for (const auto& view : bench["views"])
    if (view["view"] == "d0")
      for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < 3; ++k) R(i, k) = view["T_camera_board"][i][k].get<double>();
        t(i) = view["T_camera_board"][i][3].get<double>();
      }
  add_view_to_truth(p.folder, "twin", -R.transpose() * t + Eigen::Vector3d(4, 3, -2));

  ASSERT_EQ(p.loop(kOptions).exit_code, 0);
  std::vector<std::string> views = with_late(kFirstViews);
  views.emplace_back("twin");
  p.photograph("round-01", views);
  const Outcome asked = p.loop();
  EXPECT_EQ(asked.exit_code, 1) << asked.out;
  EXPECT_THAT(asked.err, AllOf(HasSubstr("\"d0\""), HasSubstr("--view d0="), HasSubstr(" mm")));
  EXPECT_FALSE(fs::exists(p.project / "round-02" / "scratches.csv"));
  // The one that the question names first is as good as the other; what is said stays said.
  const std::size_t at = asked.err.find("--view d0=") + 7;
  const std::string answer = asked.err.substr(at, asked.err.find_first_of(" `,;)\n", at) - at);
  const Outcome told = p.loop({"--view", answer});
  ASSERT_EQ(told.exit_code, 0) << answer << told.out << told.err;
  EXPECT_EQ(p.loop().exit_code, 0);
  const nlohmann::ordered_json next = read_json_file(p.project / "round-02" / "design.json");
  EXPECT_EQ(next["views"][0]["view"], "d0");
  EXPECT_EQ(next["views"][0]["light"], "ceiling");
  EXPECT_THAT(p.text("round-02/bench-before.json"), HasSubstr("\"ceiling\""));
}

TEST(LoopMishaps, ProjectOfBeforeThereWereRecordsIsAskedAbout) {
  const Person p;
  ASSERT_EQ(p.loop(kOptions).exit_code, 0);
  const std::string gcode = p.text("round-01/board.gcode");
  fs::remove_all(p.project / "round-01" / "made");
  const Outcome asked = p.loop();
  EXPECT_EQ(asked.exit_code, 1);
  EXPECT_THAT(asked.err, HasSubstr("no record has its inputs"));
  ASSERT_EQ(p.loop({"--allow-stale"}).exit_code, 0);
  EXPECT_EQ(p.loop().exit_code, 0);
  EXPECT_EQ(p.text("round-01/board.gcode"), gcode);
  EXPECT_THAT(p.status().out, HasSubstr("from what is not known"));
}

TEST(LoopMishaps, OptionsAreTheCommandsOwn) {
  const Person p;
  const std::string before = p.text("loop.toml");
  // What the command would refuse is refused before it is kept; a person's own lines stay.
  EXPECT_EQ(p.loop({"--iterations", "many"}).exit_code, 2);
  EXPECT_EQ(p.loop({"--carve-time", "soon"}).exit_code, 2);
  EXPECT_EQ(p.loop({"--machine", "toaster"}).exit_code, 1);
  EXPECT_EQ(p.text("loop.toml"), before);
  p.folder.write("project/loop.toml",
                 "format = \"burin/loop\"  # mine\nversion = 1\n\n[design]\npixels = 128\niterations = 5 # few\n");
  // A limit of time ends a design early: not done, unless it is kept.
  const Outcome ended = p.loop({"--count", "300", "--frame", "--time", "1s", "--iterations", "1000000"});
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_THAT(ended.err, HasSubstr("`burin loop project --allow-stale` takes it as good as it got"));
  ASSERT_EQ(p.loop({"--allow-stale"}).exit_code, 0);
  EXPECT_THAT(p.status().out, HasSubstr("ended early and kept"));
  EXPECT_THAT(p.text("loop.toml"),
              AllOf(HasSubstr("# mine"), HasSubstr("count = 300"), HasSubstr("[toolpath]\nframe = true")));
  for (const auto& [line, wrong] : {std::pair{"sharpness = 3", "project/loop.toml:7: design.sharpness: is no option"},
                                    std::pair{"start = \"nowhere\"", "project/loop.toml: design"}}) {
    p.folder.write("project/loop.toml",
                   std::string("format = \"burin/loop\"\nversion = 1\n\n[design]\npixels = 128\n\n") + line + "\n");
    const Outcome run = p.loop();
    EXPECT_EQ(run.exit_code, 1);
    EXPECT_THAT(run.err, HasSubstr(wrong));
  }
}

}  // namespace
}  // namespace burin
