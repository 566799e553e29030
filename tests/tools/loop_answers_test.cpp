// Proves, of the loop's functions alone, what a person is asked, told and refused: a carved board is not told another
// depth later; a design that was stopped raises no question behind it, and --allow-stale joins no old G-code to new
// scratches; what refuses a stage does so before its former result is moved, and a former result of the same is taken
// back; all open questions have one answer; `burin status` names what the loop would refuse; what is known only weakly
// stops a design, and lamps that no picture uses do not. Oracle: rounds that the test itself sets out, as files and
// records; nothing is photographed.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "burin/base/error.h"
#include "burin/optimize/design_file.h"
#include "burin/scene/bench.h"
#include "burin/scene/bench_of_board.h"
#include "burin/scene/board.h"
#include "burin/scene/carve.h"
#include "burin/scene/parameter_name.h"
#include "burin/scene/scratches.h"
#include "tests/tools/loop_bench.h"
#include "tools/loop/aside.h"
#include "tools/loop/record.h"
#include "tools/loop/round_depth.h"
#include "tools/loop/round_design.h"
#include "tools/loop/round_lamps.h"
#include "tools/loop/say.h"
#include "tools/loop/state.h"
#include "tools/loop/turn.h"
#include "tools/loop/unknown.h"
#include "tools/report/carve_check.h"
#include "tools/rounds_quality.h"
#include "tools/version.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

constexpr const char* kOneScratch = "x0_mm,y0_mm,x1_mm,y1_mm\n30,30,34,33\n";
constexpr const char* kTwoScratches = "x0_mm,y0_mm,x1_mm,y1_mm\n40,40,44,43\n60,60,64,63\n";

// A photo by its first bytes, which nobody decodes here.
const std::string kPhoto = std::string("\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16) + "no picture";

Verdict told_by_photos(Degree degree) { return {Source::measured, degree, 7.0, Unit::percent}; }

class LoopAnswering : public ::testing::Test {
 protected:
  void SetUp() override {
    make_tiny_project(folder_, {}, 0.5);
    loop_ = {{project()}, read_loop_options(project())};
  }

  fs::path project() const { return folder_ / "project"; }
  std::string text(const std::string& file) const { return file_text(project() / file); }
  void write(const std::string& file, const std::string& text) const { folder_.write("project/" + file, text); }

  /// The record says that a stage was made from what is there now, and left what is there.
  void record(const StageOfRound& at, MadeRecord::Status status = MadeRecord::Status::done) const {
    ContentHashes hashes;
    const StageBasis basis = basis_of(loop_, at);
    MadeRecord made;
    made.stage = name_of(at.stage);
    made.status = status;
    made.burin = version();
    made.options = basis.options;
    made.inputs = hashes_of(loop_.project, basis.files, hashes);
    made.outputs = hashes_of(loop_.project, outputs_of(loop_, at), hashes);
    write_record(made, record_file(loop_.project, at));
  }

  /// A round that is designed and ready to be carved.
  void design_round(int number) const {
    const std::string round = loop_.project.round(number).filename().string() + "/";
    DesignSpec spec = read_design(project() / "design.json");
    if (number > 1) {
      const Board board = read_board(spec.board);
      fs::create_directories(project() / round);
      write_bench(read_bench(loop_.project.bench_before(number)), board.tool_width_um,
                  project() / round / "bench-before.json");
      spec.bench = project() / round / "bench-before.json";
    }
    for (const char* file : {"design/scratches.csv", "scratches.csv", "sent.csv"}) write(round + file, kOneScratch);
    for (const char* file : {"board.gcode", "board.svg", "carve-check.html"}) write(round + file, "old");
    write_design(spec, project() / round / "design.json");
    Board board = read_board(project() / "board.json");
    board.scratches = project() / round / "sent.csv";
    write_board(board, project() / round / "board.json");
    for (const StageKind stage : {StageKind::design, StageKind::toolpath, StageKind::board, StageKind::check})
      record({number, stage});
  }

  /// What photos of the first round would measure: the bench as it is believed, all of it determined.
  Bench measured_bench() const {
    const Board board = read_board(project() / "board.json");
    Bench bench = read_bench(project() / "bench.json");
    fill_material(bench, board);
    bench.told = {board.material.alpha, board.material.depth_um, board.tool_width_um};
    bench.material_sigma.alpha = 0.001;
    bench.material_sigma.depth_um = 0.2;
    for (const std::string& name :
         {std::string(parameter::kAlpha), std::string(parameter::kDepth), parameter::light_position("lamp")})
      bench.verdict[name] = told_by_photos(Degree::determined);
    return bench;
  }

  /// The first round photographed and measured: this is what it told.
  void measure_round_1(const Bench& bench) const {
    const double width_um = read_board(project() / "board.json").tool_width_um;
    write("round-01/photos/a.png", kPhoto);
    for (const char* file : {"calibration/bench.json", "refinement/bench.json", "bench.json"}) {
      fs::create_directories((project() / "round-01" / file).parent_path());
      write_bench(bench, width_um, project() / "round-01" / file);
    }
    write("round-01/report.html", "old");
    for (const StageKind stage : {StageKind::capture, StageKind::calibrate, StageKind::refine, StageKind::report})
      record({1, stage});
  }

  void edit_board(const std::function<void(nlohmann::ordered_json&)>& edit) const {
    nlohmann::ordered_json board = read_json_file(project() / "board.json");
    edit(board);
    std::ofstream(project() / "board.json") << board;
  }
  void believe_depth(double um) const {
    edit_board([&](nlohmann::ordered_json& board) { board["material"]["depth_um"] = um; });
  }
  void move_a_tag() const {
    edit_board([&](nlohmann::ordered_json& board) { board["tags"]["list"][0]["center_mm"][0] = 10.25; });
  }

  /// What `burin loop` says when it stops; empty where it does not.
  std::string stopped(const LoopAnswers& answers = {}) const {
    try {
      turn_loop(loop_, answers);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
  static LoopAnswers again(std::vector<std::string> stages) { return {std::move(stages), false, {}, 1}; }
  static LoopAnswers keep() { return {{}, true, {}, 1}; }

  std::vector<StageState> states() const {
    ContentHashes hashes;
    return states_of(loop_, hashes);
  }
  StageState state(const StageOfRound& at) const {
    ContentHashes hashes;
    return state_of(loop_, at, hashes);
  }
  std::string next() const { return next_of(loop_, states()); }
  std::vector<std::string> asked() const {
    std::vector<std::string> names;
    const std::vector<StageState> all = states();
    for (const StageState& one : all)
      if (needs_answer_now(one, all)) names.push_back(name_of(loop_.project, one.at));
    return names;
  }

  TemporaryFolder folder_;
  LoopProject loop_;
};

TEST_F(LoopAnswering, CarvedBoardIsNotToldAnotherDepth) {
  design_round(1);
  write("round-01/photos/a.png", kPhoto);
  const std::string carved = text("round-01/board.json"), believed = text("board.json");
  believe_depth(13);
  const auto names_both = AllOf(HasSubstr("material.depth_um is 13"), HasSubstr("round-01/board.json"),
                                HasSubstr("has 11"), HasSubstr("write material.depth_um 11"));
  EXPECT_THAT(stopped(), AllOf(names_both, Not(HasSubstr("--force"))));
  EXPECT_THAT(next(), AllOf(names_both, Not(HasSubstr("--force"))));
  EXPECT_THAT(stopped(again({"round-01/board"})), names_both);
  EXPECT_EQ(text("round-01/board.json"), carved);
  // Nor where making it anew was cut off, and only former/ still tells; nor its tool or roughness.
  fs::create_directories(project() / "round-01" / "former" / "01-board");
  fs::rename(project() / "round-01" / "board.json", project() / "round-01" / "former" / "01-board" / "board.json");
  record({1, StageKind::board}, MadeRecord::Status::begun);
  EXPECT_THAT(stopped(), AllOf(HasSubstr("material.depth_um is 13"), HasSubstr("former/01-board/board.json")));
  write("round-01/board.json", carved);
  write("board.json", believed);
  record({1, StageKind::board});
  edit_board([](nlohmann::ordered_json& board) {
    board["tool"]["width_um"] = 300;
    board["material"]["alpha"] = 0.05;
  });
  EXPECT_THAT(stopped(again({"round-01/board"})),
              AllOf(HasSubstr("tool.width_um is 300"), HasSubstr("material.alpha is 0.05")));

  // A corrected tag is taken over (and then the photo, which is none, is refused).
  write("board.json", believed);
  move_a_tag();
  EXPECT_THAT(stopped(), HasSubstr("--force round-01/board"));
  stopped(again({"round-01/board"}));
  EXPECT_DOUBLE_EQ(read_board(project() / "round-01" / "board.json").tags.list.at(0).center_mm.x(), 10.25);
}

TEST_F(LoopAnswering, MeasuredBoardIsNotToldAnotherDepth) {
  design_round(1);
  measure_round_1(measured_bench());
  design_round(2);
  const std::string bench = text("round-01/bench.json"), scratches = text("round-02/scratches.csv");
  believe_depth(13);
  for (const LoopAnswers& answers : {LoopAnswers{}, keep(), again({"round-01/board", "round-02/design"})})
    EXPECT_THAT(stopped(answers), AllOf(HasSubstr("material.depth_um is 13"), HasSubstr("11")));
  EXPECT_EQ(text("round-01/bench.json"), bench);
  EXPECT_EQ(text("round-02/scratches.csv"), scratches);
  // Nothing was written down as kept before it was refused.
  EXPECT_THAT(file_text(record_file(loop_.project, {1, StageKind::board})), Not(HasSubstr("kept")));
}

TEST_F(LoopAnswering, StoppedDesignRaisesNoQuestionBehindIt) {
  design_round(1);
  write("round-01/design/scratches.csv", kTwoScratches);
  fs::remove(project() / "round-01" / "scratches.csv");
  record({1, StageKind::design}, MadeRecord::Status::interrupted);
  EXPECT_THAT(asked(), IsEmpty());
  EXPECT_THAT(next(), AllOf(HasSubstr("round-01/design: `burin loop"), HasSubstr("--allow-stale")));
  // Kept: the tool path is made anew, of these scratches.
  const std::string after = stopped(keep());
  EXPECT_EQ(text("round-01/scratches.csv"), kTwoScratches);
  EXPECT_EQ(read_scratches(project() / "round-01" / "sent.csv").size(), 2U) << after;
  EXPECT_NE(text("round-01/board.gcode"), "old");
  bool former = false;
  for (const auto& entry : fs::recursive_directory_iterator(project() / "round-01" / "former"))
    former = former || (entry.path().filename() == "board.gcode" && file_text(entry.path()) == "old");
  EXPECT_TRUE(former);
}

TEST_F(LoopAnswering, FailedToolPathRaisesNoQuestionBehindIt) {
  design_round(1);
  for (const char* file : {"sent.csv", "board.gcode", "board.svg"}) fs::remove(project() / "round-01" / file);
  record({1, StageKind::toolpath}, MadeRecord::Status::begun);
  EXPECT_THAT(asked(), IsEmpty());
  EXPECT_THAT(next(), HasSubstr("round-01/toolpath: `burin loop"));
}

TEST_F(LoopAnswering, AllQuestionsHaveOneAnswer) {
  design_round(1);
  measure_round_1(measured_bench());
  design_round(2);
  move_a_tag();
  EXPECT_THAT(asked(), ElementsAre("round-01/board", "round-02/design", "round-02/toolpath", "round-02/board"));
  const auto one_command = AllOf(HasSubstr("--force round-01/board --force round-02/design` makes"),
                                 HasSubstr("--allow-stale` goes on"), Not(HasSubstr("--force round-02/toolpath")));
  EXPECT_THAT(stopped(), one_command);
  EXPECT_THAT(next(), one_command);
}

// What cannot be made anew is kept, what cannot be kept is made anew, in one command.
TEST_F(LoopAnswering, OneAnswerKeepsWhatIsInTheMetal) {
  design_round(1);
  measure_round_1(measured_bench());
  design_round(2);
  write("round-01/board.gcode", "edited");
  fs::remove(project() / "round-02" / "scratches.csv");
  EXPECT_THAT(stopped(),
              AllOf(HasSubstr("--force round-02/design --allow-stale`"), Not(HasSubstr("--force round-01"))));
}

TEST_F(LoopAnswering, RefusedBeforeTheFormerResultIsMoved) {
  design_round(1);
  Bench bench = measured_bench();
  measure_round_1(bench);
  design_round(2);
  // The photos of one designed place are gone.
  bench.views.at(0).T_camera_board.translation() += Eigen::Vector3d(200, 100, 0);
  measure_round_1(bench);
  EXPECT_THAT(stopped(again({"round-02/design"})), HasSubstr("--view d0="));
  EXPECT_EQ(text("round-02/scratches.csv"), kOneScratch);
  EXPECT_FALSE(fs::exists(project() / "round-02" / "former"));
  // Nor is `burin status` silent about it.
  fs::remove_all(project() / "round-02");
  EXPECT_THAT(next(), HasSubstr("--view d0="));

  // Two numbers for one depth.
  fs::remove_all(project() / "round-01");
  design_round(1);
  believe_depth(14);
  const auto both = AllOf(HasSubstr("material.depth_um is 11"), HasSubstr("says 14"));
  for (const LoopAnswers& answers : {again({"round-01/design"}), again({"round-01/toolpath"}), keep(), LoopAnswers{}})
    EXPECT_THAT(stopped(answers), both);
  EXPECT_THAT(next(), both);
  EXPECT_EQ(text("round-01/scratches.csv"), kOneScratch);
  EXPECT_FALSE(fs::exists(project() / "round-01" / "former"));
}

TEST_F(LoopAnswering, FormerResultOfTheSameIsTakenBack) {
  design_round(1);
  const StageOfRound at{1, StageKind::design};
  const fs::path former = project() / "round-01" / "former" / "01-design";
  MadeRecord begun = *read_record(record_file(loop_.project, at));
  begun.status = MadeRecord::Status::begun;
  begun.outputs.clear();
  ContentHashes hashes;
  ASSERT_EQ(begin_stage(loop_, at, begun, hashes), former);
  ASSERT_FALSE(fs::exists(project() / "round-01" / "scratches.csv"));
  // Not for other options, not of another version, and not where a file is another by now.
  MadeRecord other = begun;
  other.options["count"] = "7";
  EXPECT_EQ(restore_former(loop_, at, other, hashes), fs::path());
  other = begun;
  other.burin = "0.1";
  EXPECT_EQ(restore_former(loop_, at, other, hashes), fs::path());
  other = begun;
  other.inputs["board.json"] = "of other contents";
  EXPECT_EQ(restore_former(loop_, at, other, hashes), fs::path());
  folder_.write("project/round-01/former/01-design/scratches.csv", kTwoScratches);
  EXPECT_EQ(restore_former(loop_, at, begun, hashes), fs::path());
  folder_.write("project/round-01/former/01-design/scratches.csv", kOneScratch);
  // The loop itself: without a question, and without a design.
  stopped();
  EXPECT_EQ(text("round-01/scratches.csv"), kOneScratch);
  EXPECT_TRUE(state(at).up_to_date());
  EXPECT_FALSE(fs::exists(former));
  EXPECT_EQ(text("round-01/board.gcode"), "old") << "what rests on it stays as well";
}

TEST_F(LoopAnswering, RefusedChecksLeaveNoPages) {
  design_round(1);
  const StageOfRound at{1, StageKind::check};
  record(at, MadeRecord::Status::begun);
  EXPECT_THAT(next(), HasSubstr("correct the errors in " + (project() / "round-01" / "carve-check.html").string()));
  const MadeRecord begun = *read_record(record_file(loop_.project, at));
  ContentHashes hashes;
  EXPECT_EQ(begin_stage(loop_, at, begun, hashes), fs::path());
  EXPECT_FALSE(fs::exists(project() / "round-01" / "carve-check.html"));
  EXPECT_FALSE(fs::exists(project() / "round-01" / "former"));
}

TEST_F(LoopAnswering, WhatIsKnownWeaklyStopsADesignWhereItRestsOnIt) {
  Bench bench;
  bench.verdict[parameter::kDepth] = told_by_photos(Degree::weakly);
  bench.verdict[parameter::light_position("lamp")] = told_by_photos(Degree::weakly);
  bench.verdict[parameter::light_position("lamp-2")] = told_by_photos(Degree::not_determined);
  bench.verdict[parameter::kAlpha] = told_by_photos(Degree::weakly);
  bench.verdict[parameter::kMachine] = told_by_photos(Degree::not_determined);
  bench.verdict[parameter::kVignette] = told_by_photos(Degree::not_determined);
  const auto names = [](const std::vector<UnknownParameter>& unknown) {
    std::vector<std::string> out;
    for (const UnknownParameter& u : unknown) out.push_back(u.name);
    return out;
  };
  const std::vector<UnknownParameter> unknown = unknown_in(bench, {"lamp"});
  EXPECT_THAT(names(unknown), ElementsAre("depth_um", "light.lamp.position_mm", "machine.affine"));
  EXPECT_EQ(in_short(unknown),
            "machine.affine is not determined; depth_um, light.lamp.position_mm are determined only weakly");
  EXPECT_THAT(in_words(unknown), HasSubstr("depth_um is determined only weakly: one sigma is 7 %"));
  const std::vector<Finding> weak = weakly_known_in(bench, "bench.json");
  ASSERT_THAT(weak, SizeIs(1));
  EXPECT_EQ(weak[0].severity, Finding::Severity::warning);
  EXPECT_THAT(sentence(weak[0]), AllOf(HasSubstr("alpha is determined only weakly"), HasSubstr("one sigma is 7 %")));
  bench.verdict[parameter::kDepth] = given_verdict();
  bench.verdict[parameter::kMachine] = told_by_photos(Degree::determined);
  EXPECT_THAT(names(unknown_in(bench, {})), IsEmpty());
}

TEST_F(LoopAnswering, NextIsThePhotoThatIsMissing) {
  design_round(1);
  Bench bench = measured_bench();
  Verdict& depth = bench.verdict[parameter::kDepth] = told_by_photos(Degree::weakly);
  depth.next_photo = NextPhoto{NextPhoto::Kind::at_place, "camera 620 mm above the lower left corner", {}, {}};
  // A lamp that was put elsewhere for one photo: no picture is lit by it.
  bench.lights.push_back(bench.lights.front());
  bench.lights.back().id = "lamp-2";
  bench.lights.back().position_mm.x() += 500;
  bench.verdict[parameter::light_position("lamp-2")] = told_by_photos(Degree::not_determined);
  measure_round_1(bench);
  const auto stops = AllOf(HasSubstr("depth_um is determined only weakly"), HasSubstr("--allow-undetermined depth_um"),
                           Not(HasSubstr("lamp-2")));
  EXPECT_THAT(stopped(), stops);
  EXPECT_THAT(next(), AllOf(stops, HasSubstr("620 mm above the lower left corner")));
  EXPECT_THAT(told_by_round(loop_, 1, {"depth_um"}).open, IsEmpty());
  loop_.options.accept_unknown = {"depth_um"};
  EXPECT_THAT(next(), HasSubstr("the design of the next board: `burin loop"));
  EXPECT_THAT(told_by_round(loop_, 1).accepted, SizeIs(1));
}

TEST_F(LoopAnswering, WhereNoOnePhotoTellsThePlanIsNamed) {
  design_round(1);
  Bench bench = measured_bench();
  bench.verdict[parameter::kDepth] = told_by_photos(Degree::weakly);
  measure_round_1(bench);
  EXPECT_THAT(stopped(), AllOf(HasSubstr("the photos that `burin plan "), Not(HasSubstr("named above"))));
}

// Of 11 um that the machine was told it made 8.1: the next board is told what makes 11, as far as its table reaches.
TEST_F(LoopAnswering, NextBoardIsToldTheDepthThatMakesTheWantedOne) {
  loop_.options.machine = "grbl-spring";
  loop_.options.design = {{"iterations", {"1"}}, {"pixels", {"48"}}, {"count", {"60"}}};
  design_round(1);
  Bench bench = measured_bench();
  bench.material.depth_um = 8.1;
  measure_round_1(bench);
  const std::optional<RoundDepth> depth = depth_of_round(loop_.project, loop_.options, 2);
  ASSERT_TRUE(depth);
  EXPECT_NEAR(depth->depth_um, 11, 1e-9);
  EXPECT_NEAR(depth->command_um, 11 * 11 / 8.1, 1e-9);
  EXPECT_THAT(in_words(*depth), AllOf(HasSubstr("makes 8.1 +- 0.2 um of 11 um"), HasSubstr("told 14.9 um")));
  EXPECT_FALSE(depth_of_round(loop_.project, loop_.options, 1));
  stopped();  // no photo is there for its report
  const Scratches designed = read_scratches(project() / "round-02" / "scratches.csv"),
                  sent = read_scratches(project() / "round-02" / "sent.csv");
  ASSERT_GT(designed.depth_um.size(), 0U);
  EXPECT_NEAR(designed.depth_um[0], 11, 1e-6);
  ASSERT_EQ(sent.depth_um.size(), sent.size());
  for (const double um : sent.depth_um) EXPECT_NEAR(um, 11 * 11 / 8.1, 0.02) << "as far as the G-code's decimals go";
  // And it becomes what was wanted, by what was measured.
  const Board board = read_board(project() / "board.json");
  const Carved carved = carve(Sent(sent), bench, board);
  EXPECT_NEAR(carved.scratches.depth_um[0], 11, 0.02);
  EXPECT_THAT(text("round-02/carve-check.html"), AllOf(HasSubstr("11.0 µm deep"), HasSubstr("commanded: 14.9 µm")));

  bench.material.depth_um = 3;
  measure_round_1(bench);
  const std::optional<RoundDepth> most = depth_of_round(loop_.project, loop_.options, 2);  // its table ends at 26 um
  ASSERT_TRUE(most);
  EXPECT_NEAR(most->depth_um, 26 * 3 / 11.0, 0.01);
  EXPECT_LE(most->command_um, 26);
  EXPECT_THAT(in_words(*most), HasSubstr("table ends there"));
  // As it was told, within what the photos know: nothing is made up.
  bench.material.depth_um = 10.8;
  measure_round_1(bench);
  EXPECT_FALSE(depth_of_round(loop_.project, loop_.options, 2));
}

TEST_F(LoopAnswering, BoardThatIsAsGoodAsItGetsIsHung) {
  design_round(1);
  measure_round_1(measured_bench());
  design_round(2);
  const auto rounds = [&](double shown_db, double next_db) {
    write("rounds.json",
          rounds_text({{{"d0", 27.2, shown_db}, {"d1", 27.0, shown_db}}, {{"d0", next_db}, {"d1", next_db}}},
                      "rounds.json"));
  };
  EXPECT_THAT(next(), HasSubstr("carve ")) << "nobody knows";
  rounds(26.9, 27.3);
  EXPECT_THAT(next(), AllOf(HasSubstr("hang the board of round 1"), HasSubstr("gain 0.4 dB"), HasSubstr("--another")));
  rounds(26.9, 27.5);
  EXPECT_THAT(next(), HasSubstr("carve ")) << "0.6 dB are seen";
  rounds(25.9, 26.0);
  EXPECT_THAT(next(), HasSubstr("carve ")) << "it shows less than was promised: something else is to be found";
  // Of another day: a board was photographed since.
  rounds(26.9, 27.3);
  write("round-02/photos/a.png", kPhoto);
  EXPECT_THAT(next(), Not(HasSubstr("hang")));
}

TEST_F(LoopAnswering, PicturesThatNobodyRecognizesAreSaidBeforeTheFirstBoard) {
  design_round(1);
  const auto report = [&](double like) {
    write("round-01/design/design-report.json",
          R"({"format": "burin/design-report", "version": 1, "views": [
              {"view": "d0", "psnr_db": 20, "target_correlation": [1, 0.1], "ghost": [)" +
              std::to_string(like) + R"(, 0.1]},
              {"view": "d1", "psnr_db": 20, "target_correlation": [0.1, 1], "ghost": [0.1, 0.9]}]})");
    for (const StageKind stage : {StageKind::design, StageKind::toolpath, StageKind::board, StageKind::check})
      record({1, stage});
  };
  report(0.3);
  EXPECT_THAT(unreadable_views(project() / "round-01" / "design"), ElementsAre("d0"));
  EXPECT_THAT(next(), AllOf(HasSubstr("do not carve it yet: few would recognize d0"), HasSubstr("; or carve ")));
  report(0.8);
  EXPECT_THAT(next(), Not(HasSubstr("do not carve it yet")));
}

TEST_F(LoopAnswering, NamesAreThoseThatThereAreAndCanBeTakenBack) {
  design_round(1);
  measure_round_1(measured_bench());
  const auto refused = [&](const std::vector<std::string>& views,
                           const std::vector<std::string>& lamps) -> std::string {
    try {
      remember_names(loop_.project, views, lamps);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(refused({}, {"lamp=foo"}), AllOf(HasSubstr("\"foo\""), HasSubstr("choose among lamp")));
  EXPECT_THAT(refused({"dd0=d0"}, {}), AllOf(HasSubstr("\"dd0\""), HasSubstr("d0, d1")));
  EXPECT_THAT(refused({"d0="}, {}), HasSubstr("none was said"));
  EXPECT_FALSE(fs::exists(project() / "round-01" / "names.json"));
  EXPECT_EQ(refused({"d0=d1"}, {}), "");
  EXPECT_THAT(text("round-01/names.json"), HasSubstr("\"d0\": \"d1\""));
  EXPECT_EQ(refused({"d0="}, {}), "");
  EXPECT_FALSE(fs::exists(project() / "round-01" / "names.json")) << "as if nothing had been said";
}

// The lamp is listed in the project's bench.json, also once an earlier round has measured a bench without it.
TEST_F(LoopAnswering, PhotosUnderALampThatWasAddedAreSeen) {
  design_round(1);
  measure_round_1(measured_bench());
  design_round(2);
  const fs::path photo = folder_.write("project/round-02/photos/lamp-2/x.png", kPhoto);
  EXPECT_EQ(bench_of_photos(loop_.project, 2), project() / "round-01" / "bench.json");
  EXPECT_THAT(photos_of(loop_.project, 2), IsEmpty());
  nlohmann::ordered_json bench = read_json_file(project() / "bench.json");
  bench["lights"].push_back({{"id", "lamp-2"}, {"position_mm", {434, 60, 444}}});
  std::ofstream(project() / "bench.json") << bench;
  EXPECT_EQ(bench_of_photos(loop_.project, 2), project() / "bench.json");
  EXPECT_THAT(photos_of(loop_.project, 2), ElementsAre(photo));
  EXPECT_TRUE(basis_of(loop_, {2, StageKind::capture}).files.contains(project() / "bench.json"));
  EXPECT_THAT(lamp_arguments(loop_.project, 2), ElementsAre("--lamp", "lamp")) << "those in no folder";
}

TEST_F(LoopAnswering, TimeLimitIsNamedWhereADesignEndsEarly) {
  EXPECT_EQ(time_limit_in_words(loop_), "");
  design_round(1);
  fs::remove(project() / "round-01" / "scratches.csv");
  loop_.options.design["time"] = {"1s"};
  record({1, StageKind::design}, MadeRecord::Status::interrupted);
  EXPECT_THAT(next(), AllOf(HasSubstr("again for 1s at most"), HasSubstr("loop.toml"), HasSubstr("--time 2h")));
}

TEST_F(LoopAnswering, DesignForAnotherBenchIsRefused) {
  require_own_files(loop_.project);
  fs::copy_file(project() / "bench.json", project() / "other.json");
  for (const char* key : {"bench", "board"}) {
    const nlohmann::ordered_json before = read_json_file(project() / "design.json");
    nlohmann::ordered_json design = before;
    design[key] = "other.json";
    std::ofstream(project() / "design.json") << design;
    EXPECT_THAT([&] { require_own_files(loop_.project); },
                ::testing::ThrowsMessage<Error>(AllOf(HasSubstr("design.json"), HasSubstr("other.json"),
                                                      HasSubstr(std::string("write \"") + key + ".json\""))));
    std::ofstream(project() / "design.json") << before;
  }
}

}  // namespace
}  // namespace burin
