// Proves: a folder is watched as folders are filled: photos that grow, come under other names first, are renamed,
// replaced, deleted, empty, or beside raw files; each is judged once it is whole; what is missing, wrong or broken is
// said and ends nothing; no photo is touched, copies are made only where asked. Oracle: files that the test writes, of
// a drawn board (tests/drawn_photo.h).
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "burin/base/files/json_file.h"
#include "burin/capture/tags/board_pose.h"
#include "burin/scene/bench.h"
#include "tests/drawn_dng.h"
#include "tests/drawn_photo.h"
#include "tests/tools/program.h"
#include "tools/watch/kept_copies.h"
#include "tools/watch/photo_inbox.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::IsSupersetOf;
using ::testing::Not;
using ::testing::Pair;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAre;

struct PhotoInboxTest : testing::Test {
  TemporaryFolder folder;
  PhotoInbox inbox{folder.path()};
  std::vector<fs::path> whole() { return inbox.look().whole; }
  fs::path at(const std::string& name) const { return folder / name; }
};

TEST_F(PhotoInboxTest, TakesWhatIsThereAtOnceAndWhatComesWhenItStays) {
  folder.write("IMG_10.JPG", "abc");
  folder.write("IMG_9.JPG", "abc");
  EXPECT_THAT(whole(), ElementsAre(at("IMG_9.JPG"), at("IMG_10.JPG")));
  folder.write("IMG_11.JPG", "abc");
  EXPECT_THAT(whole(), IsEmpty());
  EXPECT_TRUE(inbox.expects());
  folder.write("IMG_11.JPG", "abcdef");
  EXPECT_THAT(whole(), IsEmpty()) << "it has grown";
  EXPECT_THAT(whole(), ElementsAre(at("IMG_11.JPG")));
  EXPECT_THAT(whole(), IsEmpty()) << "once";
  EXPECT_FALSE(inbox.expects());
}

TEST_F(PhotoInboxTest, PassesOverWhatIsInTheMakingAndWhatIsNoPhoto) {
  for (const char* name :
       {".hidden.jpg", "~a.jpg", "a.jpg.part", "b.jpg.tmp", ".c.jpg.icloud", "film.mov", "notes.txt"})
    folder.write(name, "abc");
  folder.write("c.jpg.part", "\xFF\xD8\xFF\xE1 and so on");
  fs::create_directories(at("folder.jpg"));
  EXPECT_THAT(whole(), IsEmpty());
  fs::rename(at("a.jpg.part"), at("a.jpg"));
  EXPECT_THAT(whole(), IsEmpty());
  EXPECT_THAT(whole(), ElementsAre(at("a.jpg")));
}

TEST_F(PhotoInboxTest, TakesPhotosByTheirFirstBytes) {
  folder.write("IMG_1.jfif", "\xFF\xD8\xFF\xE0 and so on");
  folder.write("IMG_2", "\xFF\xD8\xFF\xE0 and so on");
  folder.write("IMG_3.HIF", "\xFF\xD8\xFF\xE0 and so on");
  folder.write("IMG_3.THM", "\xFF\xD8\xFF\xE0 and so on");
  EXPECT_THAT(whole(), ElementsAre(at("IMG_1.jfif"), at("IMG_2"), at("IMG_3.HIF")));
}

// Looked at often, a copy that pauses between two bursts is not taken.
TEST_F(PhotoInboxTest, WaitsUntilAFileHasStayed) {
  PhotoInbox patient(folder.path(), {}, 300ms);
  folder.write("old.jpg", "abc");
  EXPECT_THAT(patient.look().whole, ElementsAre(at("old.jpg"))) << "what lies there at the first look";
  folder.write("a.jpg", "abc");
  EXPECT_THAT(patient.look().whole, IsEmpty());
  EXPECT_THAT(patient.look().whole, IsEmpty());
  EXPECT_TRUE(patient.expects());
  std::this_thread::sleep_for(400ms);
  folder.write("a.jpg", "abcdef");
  EXPECT_THAT(patient.look().whole, IsEmpty()) << "it has grown";
  EXPECT_THAT(patient.look().whole, IsEmpty());
  std::this_thread::sleep_for(400ms);
  EXPECT_THAT(patient.look().whole, ElementsAre(at("a.jpg")));
}

TEST_F(PhotoInboxTest, KnowsARenamedADeletedAndAReplacedFile) {
  folder.write("a.jpg", "abc");
  folder.write("b.jpg", "abcd");
  inbox.look();
  fs::rename(at("a.jpg"), at("c.jpg"));
  InboxNews news = inbox.look();
  EXPECT_THAT(news.renamed, ElementsAre(Pair(at("a.jpg"), at("c.jpg"))));
  EXPECT_THAT(news.gone, IsEmpty());
  EXPECT_THAT(news.whole, IsEmpty());
  fs::remove(at("b.jpg"));
  EXPECT_THAT(inbox.look().gone, ElementsAre(at("b.jpg")));
  folder.write("c.jpg", "another one");
  EXPECT_THAT(whole(), IsEmpty());
  EXPECT_THAT(whole(), ElementsAre(at("c.jpg")));
}

TEST_F(PhotoInboxTest, BrokenFileIsGivenUpAndTakenWhenItGrows) {
  folder.write("a.jpg", "half");
  folder.write("empty.jpg", "");
  EXPECT_THAT(whole(), ElementsAre(at("a.jpg")));
  inbox.not_yet(at("a.jpg"));
  EXPECT_THAT(whole(), IsEmpty());
  EXPECT_TRUE(inbox.expects());
  std::this_thread::sleep_for(PhotoInbox::kGivenUp + 100ms);
  EXPECT_THAT(inbox.look().given_up, ElementsAre(at("a.jpg"), at("empty.jpg")));
  EXPECT_FALSE(inbox.expects());
  folder.write("a.jpg", "half and the rest");
  inbox.look();
  EXPECT_THAT(whole(), ElementsAre(at("a.jpg")));
}

TEST_F(PhotoInboxTest, FolderThatVanishesForgetsNothing) {
  const fs::path share = at("share"), away = at("away");
  folder.write("share/a.jpg", "abc");
  PhotoInbox there(share);
  EXPECT_THAT(there.look().whole, ElementsAre(share / "a.jpg"));
  fs::rename(share, away);
  const InboxNews news = there.look();
  EXPECT_FALSE(news.folder_there);
  EXPECT_THAT(news.why_not, HasSubstr("No such file"));
  EXPECT_THAT(news.gone, IsEmpty());
  fs::rename(away, share);
  EXPECT_TRUE(there.look().folder_there);
  EXPECT_THAT(there.look().whole, IsEmpty());
}

TEST_F(PhotoInboxTest, LooksIntoTheFoldersOfLampsOnly) {
  PhotoInbox of_lamps(folder.path(), {"red", "green"});
  EXPECT_THAT(of_lamps.look().whole, IsEmpty());
  folder.write("a.jpg", "abc");
  folder.write("Red/b.jpg", "abc");
  folder.write("blue/c.jpg", "abc");
  (void)of_lamps.look();
  EXPECT_THAT(of_lamps.look().whole, ElementsAre(at("a.jpg"), at("Red/b.jpg")));
  EXPECT_EQ(of_lamps.passed_over(), 1);
  fs::create_directories(at("green"));
  fs::rename(at("a.jpg"), at("green/a.jpg"));
  EXPECT_THAT(of_lamps.look().renamed, ElementsAre(Pair(at("a.jpg"), at("green/a.jpg"))));
  fs::remove_all(at("Red"));
  EXPECT_THAT(of_lamps.look().gone, ElementsAre(at("Red/b.jpg")));
}

// A project with a plan of two shots, and photos of both.
struct WatchCommand : testing::Test {
  TemporaryFolder folder;
  DrawnPhoto photo;
  std::vector<Eigen::Isometry3d> places{looking_at_board(photo.board, 500, 0, 0),
                                        looking_at_board(photo.board, 520, 28, 5)};

  WatchCommand() {
    fs::create_directories(folder / "my board");
    fs::create_directories(folder / "in");
    write_board(photo.board, folder / "my board/board.json");
    Bench bench;
    bench.lens = plain_lens(photo.focal_px, photo.width, photo.height);
    Light light;
    light.position_mm = {100, 700, 900};
    bench.lights = {light};
    write_bench(bench, photo.board.tool_width_um, folder / "my board/bench.json");
    Json plan{{"format", "burin/plan"}, {"version", 1}};
    for (const Eigen::Isometry3d& T : places)
      plan["shots"].push_back({{"view", "p" + std::to_string(plan["shots"].size() + 1)},
                               {"camera", "camera there"},
                               {"center_mm", to_json(Eigen::Vector3d(T.inverse().translation()))},
                               {"T_camera_board", to_json(T.matrix())},
                               {"light", {{"id", "lamp"}, {"position_mm", to_json(light.position_mm)}}},
                               {"exposure_stops", {0, -3}}});
    write_json(plan, folder / "my board/plan.json");
  }

  // Paper and glints from one place: NAME-1.jpg, NAME-2.jpg.
  void take(std::size_t place, const std::string& name) {
    photo.T_camera_board = places[place];
    photo.glint = 3;
    Image linear = drawn(photo);
    photo.exposure_s = 1.0 / 60;
    photo.taken_at = fmt_time(place, 0);
    ASSERT_TRUE(write_drawn(linear, photo, folder / (name + "-1.jpg")));
    for (float& v : linear.data) v /= 8;
    photo.exposure_s = 1.0 / 480;
    photo.taken_at = fmt_time(place, 4);
    ASSERT_TRUE(write_drawn(linear, photo, folder / (name + "-2.jpg")));
  }
  static std::string fmt_time(std::size_t minute, int second) {
    return "2024:05:01 12:0" + std::to_string(minute) + ":0" + std::to_string(second);
  }
  static std::vector<Json> lines(const std::string& text) {
    std::vector<Json> out;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) out.push_back(Json::parse(line));
    return out;
  }
};

TEST_F(WatchCommand, JudgesPhotosThatArriveSlowly) {
  take(0, "a");
  take(1, "b");
  // One grows in two halves, one comes under another name first, one is renamed later, one is never more than begun.
  const Outcome run = run_shell(
      folder, "cd " + quoted(folder.path().string()) + "; timeout 90 " + quoted(places::program()) +
                  " watch 'my board' --photos in --json-lines >log & pid=$!;"
                  "said() { for i in $(seq 300); do grep -q \"$1\" log && return; sleep 0.1; done; }; said began;"
                  "head -c 20000 a-1.jpg >in/a-1.jpg; sleep 1.2; tail -c +20001 a-1.jpg >>in/a-1.jpg; said a-1.jpg;"
                  "cp a-2.jpg in/.a-2.jpg.part; mv in/.a-2.jpg.part in/a-2.jpg; head -c 9000 b-1.jpg >in/c.jpg;"
                  "said a-2.jpg; mv in/a-2.jpg in/renamed.jpg; said renamed.jpg; cp b-1.jpg b-2.jpg in; wait $pid");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  std::map<std::string, Json> of;
  std::vector<std::string> events;
  for (const Json& line : lines(file_text(folder / "log"))) {
    if (line["event"] != "photo")
      events.push_back(line["event"]);
    else
      of[fs::path(line["photo"].get<std::string>()).filename()] = line;
  }
  ASSERT_EQ(of.size(), 4U) << file_text(folder / "log");
  EXPECT_EQ(of["a-1.jpg"]["shot"], "p1");
  EXPECT_EQ(of["b-1.jpg"]["shot"], "p2");
  EXPECT_EQ(of["a-1.jpg"]["tags"].size(), 6U);
  EXPECT_THAT(of["a-1.jpg"]["now"].get<std::string>(), HasSubstr("the same place at 1/500 s"));
  EXPECT_EQ(of["b-2.jpg"]["state"], "2 of 2 shots");
  EXPECT_THAT(events, UnorderedElementsAre("began", "renamed", "unreadable", "finished", "result"));
  EXPECT_TRUE(file_text(folder / "in/a-1.jpg") == file_text(folder / "a-1.jpg")) << "a photo was touched";
}

TEST_F(WatchCommand, OnceSaysWhatIsMissing) {
  take(0, "in/a");
  const Outcome run = run_burin(folder, {"watch", "my board", "--photos", "in", "--once"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out,
              AllOf(HasSubstr("a-1.jpg: shot \"p1\", in its place: 6 of 6 tags"),
                    HasSubstr("missing     shot \"p2\": camera there"), HasSubstr("1 of 2 shots"),
                    HasSubstr("next: burin capture in --board 'my board/board.json' --bench 'my board/bench.json' "
                              "--out DIR")));
}

// Which files are one shot is decided as `burin capture` does: by bytes, EXIF and pixels, whatever came first.
TEST_F(WatchCommand, OnePhotoAShotByContentAndExif) {
  take(0, "in/a");
  const auto write_raw = [&](const std::string& file, double exposure_s) {
    Dng dng;
    dng.width = photo.width, dng.height = photo.height;
    dng.exposure_s[0] = 1000, dng.exposure_s[1] = static_cast<std::uint32_t>(std::lround(1000 / exposure_s));
    dng.iso = 100, dng.make = "Altair", dng.model = photo.model;
    for (const float v : drawn(photo).data)
      dng.pixels.push_back(static_cast<std::uint16_t>(
          dng.black + std::lround(std::min(1.0, v * 60 * exposure_s) * (dng.white - dng.black))));
    folder.write(file, dng_file(dng));
  };
  write_raw("in/a-1 (raw).DNG", 1.0 / 60);  // another stem, the same picture
  write_raw("in/a-2.DNG", 1.0 / 30);        // the stem of another exposure
  fs::copy_file(folder / "in/a-1.jpg", folder / "in/z copy.jpg");
  const Outcome run = run_burin(folder, {"watch", "my board", "--photos", "in", "--once", "--json-lines"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  std::map<std::string, std::string> said;
  std::vector<std::string> judged;
  for (const Json& line : lines(run.out)) {
    if (line.contains("tags")) judged.push_back(fs::path(line["photo"].get<std::string>()).filename());
    if (line.value("event", "") == "passed over")
      said[fs::path(line["photo"].get<std::string>()).filename()] = line["words"];
  }
  EXPECT_THAT(said, SizeIs(2)) << run.out;
  EXPECT_THAT(said["a-1.jpg"], HasSubstr("was passed over for a-1 (raw).DNG"));
  EXPECT_THAT(said["z copy.jpg"], HasSubstr("z copy.jpg")) << run.out;
  EXPECT_THAT(judged, IsSupersetOf({"a-1 (raw).DNG", "a-2.DNG", "a-2.jpg"}));
}

// A lens without contacts: its aperture is said, to `watch` or once to the project.
TEST_F(WatchCommand, TheApertureMayBeSaid) {
  take(0, "in/a");
  photo.f_number = 0;
  photo.exposure_s = 1.0 / 480;
  photo.taken_at = fmt_time(0, 4);
  Image linear = drawn(photo);
  for (float& v : linear.data) v /= 8;
  ASSERT_TRUE(write_drawn(linear, photo, folder / "in/a-2.jpg"));
  const std::vector<std::string> watch{"watch", "my board", "--photos", "in", "--once"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), watch.begin(), watch.end());
    return run_burin(folder, more);
  };
  EXPECT_THAT(with({}).out, AllOf(HasSubstr("its EXIF holds no aperture"), HasSubstr("--f-number 8")));
  EXPECT_THAT(with({"--f-number", "8"}).out, Not(HasSubstr("no aperture")));
  folder.write("my board/loop.toml", "format = \"burin/loop\"\nversion = 1\n[capture]\nf-number = 8\n");
  fs::copy_file(places::source() + "/samples/small-bench/design.json", folder / "my board/design.json");
  const Outcome kept = with({});
  EXPECT_THAT(kept.out, Not(HasSubstr("no aperture"))) << kept.err;
  EXPECT_THAT(kept.err, HasSubstr("from the project my board: f-number 8"));
}

TEST_F(WatchCommand, CtrlCEndsWithASummary) {
  take(0, "in/a");
  const Outcome run = run_shell(folder, "cd " + quoted(folder.path().string()) + "; " + quoted(places::program()) +
                                            " watch 'my board' --photos in >log & pid=$!; "
                                            "for i in $(seq 100); do grep -q 1.of.2 log && break; sleep 0.2; done; "
                                            "kill -TERM $pid; sleep 0.02; kill -TERM $pid; wait $pid; cat log");
  EXPECT_THAT(run.out, HasSubstr("Not all is there yet: 1 of 2 shots"));
}

TEST_F(WatchCommand, RoundsPhotosAndCopies) {
  take(0, "in/a");
  fs::create_directories(folder / "my board/round-01");
  fs::rename(folder / "my board/plan.json", folder / "my board/round-01/plan.json");
  folder.write("my board/round-01/photos/a-2.jpg", "of another day");
  Outcome run = run_burin(folder, {"watch", "my board", "--photos", "in", "--copy", "--once"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(file_text(folder / "my board/round-01/photos/a-1.jpg") == file_text(folder / "in/a-1.jpg"));
  EXPECT_EQ(file_text(folder / "my board/round-01/photos/a-2.jpg"), "of another day");
  EXPECT_TRUE(file_text(folder / "my board/round-01/photos/a-2-2.jpg") == file_text(folder / "in/a-2.jpg"));
  EXPECT_THAT(run.out, AllOf(HasSubstr("copied as a-2-2.jpg: my board/round-01/photos/a-2.jpg is there already"),
                             HasSubstr("next: burin loop 'my board'")));
  run = run_burin(folder, {"watch", "my board", "--photos", "in", "--copy", "--once"});
  EXPECT_THAT(run.out, Not(HasSubstr("copied")));
  EXPECT_FALSE(fs::exists(folder / "my board/round-01/photos/a-2-3.jpg"));
  // The round's own folder, made where it is missing.
  fs::remove_all(folder / "my board/round-01/photos");
  run = run_burin(folder, {"watch", "my board", "--once"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("my board/round-01/photos: holds no photo"));
  folder.write("my board/round-01/bench.json", "{}");
  EXPECT_THAT(run_burin(folder, {"watch", "my board", "--once"}).err, HasSubstr("its photos are measured already"));
}

// A copy is never left as a half: neither where a photo changes after it was copied, nor where the watching ended
// before.
TEST_F(WatchCommand, NoCopyStaysAHalf) {
  take(0, "a");
  const std::string whole = file_text(folder / "a-1.jpg"), photos = "my board/round-01/photos/";
  fs::create_directories(folder / "my board/round-01");
  fs::rename(folder / "my board/plan.json", folder / "my board/round-01/plan.json");
  const auto watch_once = [&] {
    return run_burin(folder, {"watch", "my board", "--photos", "in", "--copy", "--once"});
  };
  // Of the whole size, and zero behind its middle; and cut off.
  std::string half = whole;
  std::fill(half.begin() + static_cast<std::ptrdiff_t>(half.size() / 2), half.end(), '\0');
  for (const std::string& begun : {half, whole.substr(0, whole.size() / 2), std::string()}) {
    folder.write("in/a-1.jpg", whole);
    folder.write(photos + "a-1.jpg", begun);
    const Outcome run = watch_once();
    EXPECT_TRUE(file_text(folder / (photos + "a-1.jpg")) == whole) << begun.size();
    EXPECT_THAT(run.out, HasSubstr("a-1.jpg was a copy of it before all of it was there"));
  }
  // What cannot be copied is no success.
  fs::remove_all(folder / "my board/round-01/photos");
  folder.write("my board/round-01/photos", "in the way");
  const Outcome refused = watch_once();
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.out, HasSubstr("a-1.jpg: is not copied yet"));
  EXPECT_THAT(refused.err, HasSubstr("--copy: 1 photo not copied"));
  fs::remove(folder / "my board/round-01/photos");
  // The photo changes while it is watched, its size does not: a byte behind the JPEG's end, which nobody decodes.
  folder.write("in/a-1.jpg", whole + "x");
  fs::remove(folder / (photos + "a-1.jpg"));
  const Outcome run = run_shell(
      folder, "cd " + quoted(folder.path().string()) + "; timeout 90 " + quoted(places::program()) +
                  " watch 'my board' --photos in --copy >log & pid=$!; copy=" + quoted(photos + "a-1.jpg") +
                  "; for i in $(seq 300); do [ -e \"$copy\" ] && break; sleep 0.1; done; "
                  "printf y | dd of=in/a-1.jpg bs=1 seek=" +
                  std::to_string(whole.size()) +
                  " conv=notrunc 2>/dev/null; for i in $(seq 300); do cmp -s in/a-1.jpg \"$copy\" && break; sleep 0.1; "
                  "done; kill $pid; wait $pid; cat log");
  EXPECT_TRUE(file_text(folder / (photos + "a-1.jpg")) == whole + "y");
  EXPECT_THAT(run.out, HasSubstr("copied again"));
}

struct KeptCopiesTest : testing::Test {
  TemporaryFolder folder;
  std::vector<std::string> said;
  KeptCopies copies{0ms,
                    [this](const std::string& event, const fs::path&, const std::string&) { said.push_back(event); }};
  fs::path at(const std::string& name) const { return folder / name; }
  std::string copy(const std::string& name) const { return fs::exists(at(name)) ? file_text(at(name)) : "none"; }
  void look(int times) {
    for (int i = 0; i < times; ++i) copies.look();
  }
};

TEST_F(KeptCopiesTest, CopiesOnlyWhatHasStayedBetweenTwoLooks) {
  folder.write("in/a.jpg", "begun");
  copies.want(at("in/a.jpg"), at("kept"));
  look(1);
  EXPECT_EQ(copy("kept/a.jpg"), "none");
  folder.write("in/a.jpg", "BEGUN");  // of the same size, and perhaps of the same time
  look(1);
  EXPECT_EQ(copy("kept/a.jpg"), "none");
  EXPECT_EQ(copies.waiting(), 1);
  look(1);
  EXPECT_EQ(copy("kept/a.jpg"), "BEGUN");
  EXPECT_EQ(copies.waiting(), 0);
  EXPECT_TRUE(said.empty());
}

TEST_F(KeptCopiesTest, WhatChangesUnderTheSameSizeAndTimeIsToBeJudgedAnew) {
  folder.write("in/a.jpg", "half of");
  const auto time = fs::last_write_time(at("in/a.jpg"));
  copies.want(at("in/a.jpg"), at("kept"));
  look(3);
  EXPECT_EQ(copy("kept/a.jpg"), "half of");
  folder.write("in/a.jpg", "all of ");
  fs::last_write_time(at("in/a.jpg"), time);
  EXPECT_THAT(copies.look(), ElementsAre(at("in/a.jpg")));
  copies.want(at("in/a.jpg"), at("kept"));
  look(2);
  EXPECT_EQ(copy("kept/a.jpg"), "all of ");
}

TEST_F(KeptCopiesTest, AnotherPhotoOfTheSameNameKeepsItsOwn) {
  folder.write("kept/IMG_1.jpg", "another");
  folder.write("in/IMG_1.jpg", "this one");
  copies.want(at("in/IMG_1.jpg"), at("kept"));
  look(2);
  EXPECT_EQ(copy("kept/IMG_1.jpg") + "|" + copy("kept/IMG_1-2.jpg"), "another|this one");
  // A person changed the copy: it is theirs.
  folder.write("kept/IMG_1-2.jpg", "edited");
  folder.write("in/IMG_1.jpg", "this one, changed");
  copies.want(at("in/IMG_1.jpg"), at("kept"));
  look(2);
  EXPECT_EQ(copy("kept/IMG_1-2.jpg") + "|" + copy("kept/IMG_1-3.jpg"), "edited|this one, changed");
}

TEST_F(KeptCopiesTest, AHalfReplacesNoWholeCopyAndVanishedPhotosAreReported) {
  const std::string whole(10'000, 'x');
  folder.write("kept/a.jpg", whole);
  folder.write("in/a.jpg", whole.substr(0, 5000));
  folder.write("in/b.jpg", "b");
  copies.want(at("in/a.jpg"), at("kept"));
  copies.want(at("in/b.jpg"), at("kept"));
  look(1);
  fs::remove(at("in/b.jpg"));
  look(1);
  EXPECT_EQ(copy("kept/a.jpg"), whole);
  EXPECT_THAT(said, UnorderedElementsAre("not copied", "not copied"));
  EXPECT_EQ(copies.waiting(), 0);
}

TEST_F(KeptCopiesTest, WhatCannotBeCopiedIsTriedAgain) {
  folder.write("in/a.jpg", "a");
  folder.write("kept", "a file where the folder should be");
  copies.want(at("in/a.jpg"), at("kept"));
  look(4);
  EXPECT_THAT(said, ElementsAre("not copied")) << "once";
  EXPECT_EQ(copies.waiting(), 1);
  EXPECT_EQ(copies.refused(), 1);
  fs::remove(at("kept"));
  look(1);
  EXPECT_EQ(copy("kept/a.jpg"), "a");
}

// One place under two lamps: each photo counts for the lamp whose folder it lies in, and is copied into it.
TEST_F(WatchCommand, FoldersNameTheLamps) {
  const fs::path project = folder / "my board";
  Json bench = Json::parse(file_text(project / "bench.json")), plan = Json::parse(file_text(project / "plan.json"));
  Json left = bench["lights"][0];
  left["id"] = "left";
  left["position_mm"] = {-500, 100, 700};
  bench["lights"].push_back(left);
  plan["shots"][1] = plan["shots"][0];
  plan["shots"][1]["light"] = {{"id", "left"}, {"position_mm", left["position_mm"]}};
  write_json(bench, project / "bench.json");
  fs::create_directories(project / "round-01");
  write_json(plan, project / "round-01" / "plan.json");
  take(0, "in/a");
  fs::create_directories(folder / "in/left");
  fs::copy_file(folder / "in/a-1.jpg", folder / "in/left/b-1.jpg");
  Outcome run = run_burin(folder, {"watch", "my board", "--photos", "in", "--copy", "--once"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("put photos into in/lamp and in/left, or name it with --lamp NAME"),
                             HasSubstr("a-1.jpg: shot \"p1\""), HasSubstr("the lamp is unknown"),
                             HasSubstr("b-1.jpg (lamp \"left\"): shot \"p1\"")));
  EXPECT_TRUE(fs::exists(project / "round-01/photos/left/b-1.jpg"));
  EXPECT_FALSE(fs::exists(project / "round-01/photos/a-1.jpg"));
  run = run_burin(folder, {"watch", "my board", "--photos", "in", "--copy", "--once", "--lamp", "lamp"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("1 of 2 shots, 1 begun"), Not(HasSubstr("the lamp is unknown"))));
  EXPECT_TRUE(fs::exists(project / "round-01/photos/lamp/a-1.jpg"));
  EXPECT_THAT(run_burin(folder, {"watch", "my board", "--photos", "in", "--lamp", "lefd"}).err,
              HasSubstr("--lamp lefd: no photos are wanted under a lamp of that name; choose one of: lamp, left"));
  EXPECT_THAT(run_burin(folder, {"watch", "my board", "--tether"}).err,
              HasSubstr("burin watch 'my board' --tether --lamp lamp; then the next one"));
}

TEST_F(WatchCommand, SaysWhatCannotBeWatched) {
  const auto error = [&](const std::vector<std::string>& words) {
    const Outcome run = run_burin(folder, words);
    EXPECT_EQ(run.exit_code, 1) << run.out;
    return run.err;
  };
  EXPECT_THAT(error({"watch", "nowhere"}), HasSubstr("nowhere: there is no such folder"));
  EXPECT_THAT(error({"watch", "in"}), HasSubstr("there is no board to look for"));
  EXPECT_THAT(error({"watch", "my board"}), HasSubstr("has no board to be photographed yet"));
  EXPECT_THAT(error({"watch", "my board", "--photos", "gone"}), HasSubstr("gone: there is no such folder"));
  EXPECT_THAT(error({"watch", "my board", "--photos", "in", "--once"}), HasSubstr("in: holds no photo"));
  EXPECT_THAT(error({"watch", "my board", "--photos", "in", "--copy"}), HasSubstr("burin loop 'my board'"));
  folder.write("plan.json", "{}");
  EXPECT_THAT(error({"watch", "my board", "--photos", "in", "--plan", "plan.json"}), HasSubstr("plan.json"));
  folder.write("in/a.jpg", "");
  folder.write("in/b.jpg", "no picture");
  const Outcome run = run_burin(folder, {"watch", "my board", "--photos", "in", "--once"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.out, AllOf(HasSubstr("error: in/b.jpg: is no picture of a kind that Burin reads"),
                             HasSubstr("error: in/a.jpg: is empty (0 bytes)")));
}

}  // namespace
}  // namespace burin
