// burin new - makes a project from pictures: board with tags, bench, design, and a preview in seconds. Missing values
// have defaults, or come from questions at a terminal. The work is in tools/new.
#include <unistd.h>

#include <CLI/Error.hpp>
#include <algorithm>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/files/file_error.h"
#include "burin/base/files/unfinished.h"
#include "burin/calib/verdict/camera_place.h"
#include "burin/capture/exif.h"
#include "burin/optimize/layout/tag_layout.h"
#include "burin/optimize/machine_profile.h"
#include "burin/pictures/picture.h"
#include "tools/commands.h"
#include "tools/new/ask.h"
#include "tools/new/lay_out.h"
#include "tools/new/pictures.h"
#include "tools/new/project_files.h"
#include "tools/new/words.h"
#include "tools/standard_streams.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostPictures = 9;

// From the command line; empty: not given.
struct NewArguments {
  std::string folder, board, camera, lamp, stand, machine;
  std::vector<std::string> pictures, fit, keep;
  int scratches = 0;
};

constexpr const char *kUsualFolder = "my-board", *kUsualBoard = "200x150", *kUsualCamera = "phone",
                     *kUsualLamp = "above", *kStand = "four times the board's diagonal", *kMachine = "grbl-spring";

// Returns the first pictures of the working directory, as the default answer.
std::string pictures_here() {
  std::vector<std::string> found;
  std::error_code error;
  for (fs::directory_iterator entry(".", error), end; !error && entry != end; entry.increment(error))
    if (entry->is_regular_file(error) && is_photo(entry->path()) && !is_raw(entry->path()))
      found.push_back(entry->path().filename().string());
  std::sort(found.begin(), found.end());
  constexpr std::size_t kUsual = 3;
  found.resize(std::min(found.size(), kUsual));
  std::string line;
  for (const std::string& name : found) line += (line.empty() ? "" : " ") + shell_word(name);
  return line;
}

std::vector<fs::path> as_paths(const std::vector<std::string>& names) { return {names.begin(), names.end()}; }

double stand_of(const std::string& text) {
  return text.empty() || text == kStand ? 0 : length_in_words(text, "how far away one stands");
}

// Parses the sheet's size. A bare 6x4 would be in mm, and is probably a mistake.
Eigen::Vector2d board_size(const std::string& text) {
  const Eigen::Vector2d mm = size_in_words(text, "board");
  try {
    tag_sizes(mm);
  } catch (const Error&) {
    constexpr double kHardlyMeant_mm = 60;
    const bool bare =
        std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isalpha(c) == 0 || c == 'x'; });
    if (bare && mm.maxCoeff() < kHardlyMeant_mm)
      fail("a board of " + text, fmt::format("is {:g} x {:g} mm, too small for tags around a picture", mm.x(), mm.y()),
           fmt::format("if these are other units, name them: {0}in, {0}cm", text));
    throw;
  }
  return mm;
}

// Each question validates its own value; all other values are given or default.
void ask_what_is_missing(NewArguments& o, Conversation& talk) {
  std::vector<Question> questions;
  const auto question = [&](std::string& value, const std::string& words, const char* usual,
                            const std::function<void(const std::string&)>& check) {
    if (!value.empty()) return;
    questions.push_back({words, [usual] { return std::string(usual); },
                         [&value, check](const std::string& answer) {
                           check(answer);
                           value = answer;
                         }});
  };
  talk.out << "A new board. Enter takes the answer in brackets, \"back\" returns to the question before, Ctrl-D ends "
              "without writing anything.\n";
  question(o.folder, "Folder of the project", kUsualFolder,
           [](const std::string& a) { fail_unless_new(file_in_words(a)); });
  if (o.pictures.empty())
    questions.push_back(
        {"Pictures, one for each place to stand (1 to 9 files)", pictures_here, [&](const std::string& answer) {
           const std::vector<std::string> names = files_in_words(answer);
           choose_pictures(as_paths(names), kMostPictures);
           o.pictures = names;
         }});
  question(o.board, "The sheet of metal, width x height (200x150 in mm, 20x15cm, 8x6in)", kUsualBoard,
           [](const std::string& a) { board_size(a); });
  question(o.camera, "Camera: phone, a focal length as on film (50mm), or a photo that it took", kUsualCamera,
           [](const std::string& a) { camera_in_words(file_in_words(a)); });
  question(o.stand, "How far away you stand (1.2m)", kStand, [](const std::string& a) { stand_of(a); });
  question(o.lamp, "Lamp: above, left, right or below the board, with a distance if you like (above 600mm)", kUsualLamp,
           [](const std::string& a) { lamp_in_words(a); });
  question(o.machine, "Machine: " + built_in_machines() + ", or a file", kMachine,
           [](const std::string& a) { machine_profile(file_in_words(a)); });
  ask_all(talk, questions);
  for (std::string* file : {&o.folder, &o.camera, &o.machine}) *file = file_in_words(*file);
}

// --fit and --keep: one value for all pictures, or one for each.
const std::string* said_for(const std::vector<std::string>& list, std::size_t index) {
  if (list.empty()) return nullptr;
  return &list[list.size() == 1 ? 0 : index];
}

void fail_unless_one_each(const std::vector<std::string>& list, const char* option, std::size_t pictures) {
  if (list.size() > 1 && list.size() != pictures)
    throw CLI::ValidationError(option, fmt::format("takes one word for all pictures, or {}, one for each", pictures));
}

// A temporary sheet of crops for the user before the project exists; the destructor removes it.
class SheetToLookAt {
 public:
  SheetToLookAt(const std::vector<ChosenPicture>& pictures, const Eigen::Vector2d& area_mm)
      : folder_(new_folder()), unfinished_(folder_) {
    write_picture(crop_sheet(pictures, area_mm), file());
  }
  ~SheetToLookAt() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  SheetToLookAt(const SheetToLookAt&) = delete;
  SheetToLookAt& operator=(const SheetToLookAt&) = delete;
  fs::path file() const { return folder_ / "crops.png"; }

 private:
  // The name is unpredictable and its folder is private, because anyone could put links into the common folder.
  static fs::path new_folder() {
    std::string name = (fs::temp_directory_path() / "burin-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) fail_with(name, "the folder cannot be made", errno);
    return name;
  }

  fs::path folder_;
  Unfinished unfinished_;
};

void lay_pictures(const NewArguments& o, Conversation* talk, const Eigen::Vector2d& area_mm,
                  std::vector<ChosenPicture>& pictures) {
  bool other_shapes = false;
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    ChosenPicture& p = pictures[k];
    lay_as_usual(p, area_mm);
    const std::string *fit = said_for(o.fit, k), *keep = said_for(o.keep, k);
    if (keep) lay_as(p, *keep);
    if (fit && !(*fit == "cover" && keep)) lay_as(p, *fit);
    other_shapes = other_shapes || has_other_shape(p, area_mm);
  }
  const bool asks = talk != nullptr && other_shapes && o.fit.empty() && o.keep.empty();
  if (!asks) return;
  const SheetToLookAt sheet(pictures, area_mm);
  talk->out << "How the pictures would lie on the board: " << sheet.file().string() << "\n";
  for (ChosenPicture& p : pictures) {
    if (!has_other_shape(p, area_mm)) continue;
    talk->out << crop_in_words(p, area_mm) << "\n";
    ask(*talk, "  keep top, middle, bottom, left or right, or contain (all of it, dark beside it)", lay_name(p),
        [&](const std::string& answer) { lay_as(p, answer); });
  }
}

// Returns a value in the user's own units, as a prefix to the value in mm.
std::string as_said(const std::string& words) {
  for (const char* unit : {"in", "\"", "ft", "'", "cm"})
    if (words.find(unit) != std::string::npos) return words + ", that is ";
  return "";
}

void report_project(const NewArguments& o, const NewProject& project, const Eigen::Vector2d& area_mm, Report& report) {
  const LaidOutBench& bench = project.bench;
  const Board& board = bench.board;
  const double tag = board.tags.list.front().size_mm;
  Facts facts = report.in("board");
  facts.set("size", {board.size_mm.x(), board.size_mm.y()}, "mm");
  facts.set("picture_size", {area_mm.x(), area_mm.y()}, "mm");
  facts.set("depth", board.material.depth_um, "um");
  facts.set("tags", board.tags.list.size());
  facts.set("tag_size", tag, "mm");
  facts.set("family", board.tags.family);
  report.line(
      "Board: {}{:g} x {:g} mm, pictures on {:g} x {:g} mm; {} tags {} of {:g} mm (paper {:.4g} mm), grooves {:g} um "
      "deep\n",
      as_said(o.board), board.size_mm.x(), board.size_mm.y(), area_mm.x(), area_mm.y(), board.tags.list.size(),
      board.tags.family, tag, 1.8 * tag, board.material.depth_um);
  report.line("Camera: {}; from these places a tag is at least {:.0f} pixels wide\n",
              fact("camera", project.camera.in_words), fact("tag_width", bench.tag_px, "px"));
  report.all().set("lamp_position", to_json(bench.lamp_mm), "mm");
  report.all().set("eye_distance", bench.stand_mm, "mm");
  report.line("Lamp: {}{}\n", as_said(o.lamp), place_in_words(bench.lamp_mm, board));
  if (!o.stand.empty()) report.line("Eyes: {}{:g} mm away\n", as_said(o.stand), bench.stand_mm);
  for (std::size_t k = 0; k < project.pictures.size(); ++k) {
    Facts view = report.add("views");
    view.set("eye_position", to_json(bench.eyes_mm[k]), "mm");
    view.set("picture", project.pictures[k].file.string());
    view.line("Eye for {}: {}\n", fact("view", project.pictures[k].view),
              place_in_words(camera_place_at(bench.eyes_mm[k], board, 0), board));
  }
  bool other_shapes = false;
  for (const ChosenPicture& p : project.pictures) {
    report.line("Picture {}\n", crop_in_words(p, area_mm));
    other_shapes = other_shapes || has_other_shape(p, area_mm);
  }
  const std::string folder = project.folder.string();
  if (other_shapes)
    report.line(
        "         {} shows what is kept; --keep top, middle, bottom, left or right says what stays, --fit contain "
        "shows all (for each picture one word); or \"keep\" and \"fit\" in design.json\n",
        shell_word((project.folder / "crops.png").string()));
  std::string usual;
  const auto was_usual = [&](const std::string& said, const char* option, const char* value) {
    if (said.empty()) usual += fmt::format("{}{} {}", usual.empty() ? "" : ", ", option, value);
  };
  was_usual(o.board, "--board", kUsualBoard);
  was_usual(o.camera, "--camera", kUsualCamera);
  was_usual(o.stand, "--stand", fmt::format("{:g}mm", bench.stand_mm).c_str());
  was_usual(o.lamp, "--lamp", kUsualLamp);
  was_usual(o.machine, "--machine", kMachine);
  if (!usual.empty()) report.line("Not said, so taken: {}\n", fact("defaults", usual));
}

// Number of grooves per picture that this size can use, limited to one day's carving.
int usual_scratches(std::size_t pictures) {
  constexpr int kEach = 4000, kMost = 24000;
  return std::min(kMost, kEach * static_cast<int>(pictures));
}

Report run(NewArguments o) {
  const bool incomplete = o.folder.empty() || o.pictures.empty();
  const bool person = is_person_there();
  if (incomplete && !person)
    throw CLI::ValidationError(
        o.folder.empty() ? "DIR" : "--pictures",
        "is missing, and there is no terminal for questions: burin new DIR --pictures a.jpg b.jpg c.jpg");
  Conversation talk{std::cin, std::cout};
  if (incomplete) ask_what_is_missing(o, talk);

  NewProject project;
  project.folder = o.folder;
  fail_unless_new(project.folder);
  fail_unless_one_each(o.fit, "--fit", o.pictures.size());
  fail_unless_one_each(o.keep, "--keep", o.pictures.size());
  const auto said_or = [](const std::string& said, const char* usual) { return said.empty() ? usual : said; };
  BenchWishes wanted;
  wanted.board_mm = board_size(said_or(o.board, kUsualBoard));
  wanted.camera = camera_in_words(said_or(o.camera, kUsualCamera));
  wanted.lamp = lamp_in_words(said_or(o.lamp, kUsualLamp));
  wanted.stand_mm = stand_of(o.stand);
  project.machine = said_or(o.machine, kMachine);
  const MachineProfile machine = machine_profile(project.machine);
  const auto began = std::chrono::steady_clock::now();
  project.pictures = choose_pictures(as_paths(o.pictures), kMostPictures);
  project.spent_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  wanted.views = static_cast<int>(project.pictures.size());
  project.camera = wanted.camera;
  project.bench = lay_out(wanted);
  const Board& board = project.bench.board;
  plunge_mm(machine, board.material.depth_um / 1000);  // throws if the depth is outside the machine's table
  project.scratches = o.scratches > 0 ? o.scratches : usual_scratches(project.pictures.size());
  const Eigen::Vector2d area_mm = board.carve_max_mm - board.carve_min_mm;
  lay_pictures(o, person ? &talk : nullptr, area_mm, project.pictures);
  Report report;
  report_project(o, project, area_mm, report);
  if (is_for_people()) say_text(report.text);  // before the preview
  report.text.clear();
  for (const Finding& finding : project.bench.findings) tell(finding);
  for (const auto& [later, earlier] : same_pictures(project.pictures))
    tell(make_warning(FindingCode::picture,
                      fmt::format("{} and {} are the same picture, which would be shown to two places",
                                  project.pictures[earlier].file.string(), project.pictures[later].file.string()),
                      "name it once, if that is not meant"));
  const std::string preview = write_project(project);
  const std::string folder = shell_word(project.folder.string());
  report.line("Preview: {}: {}\n", shell_word((project.folder / "preview.png").string()), fact("preview", preview));
  report.line(
      "         burin view {} shows it in the hand, burin print {} prints the tags, burin sheet {} draws where to "
      "stand\n",
      folder, folder, folder);
  report.next = {{"burin", "loop", project.folder.string()}};
  report.line("Wrote {}, a board of {}; next: {}\n", project.folder.string(),
              counted(project.pictures.size(), "picture"), command_text(report.next.front()));
  return report;
}

}  // namespace

void add_new_command(CLI::App& burin) {
  auto o = std::make_shared<NewArguments>();
  CLI::App* c = burin.add_subcommand(
      "new", "Create a project from pictures, with a preview; without options, ask at the terminal");
  c->add_option("DIR", o->folder, "Create this project folder, which must not exist yet");
  c->add_option("--pictures", o->pictures, "Show these one to nine pictures, one viewpoint each")
      ->type_name("PICTURE ...")
      ->expected(1, -1);
  c->add_option("--board", o->board,
                "Set the sheet's width x height, mm or with a unit: 200x150, 20x15cm, 8x6in [default: 200x150]");
  c->add_option("--camera", o->camera,
                "Use this camera: phone, a 35 mm equivalent focal length (50mm), a photo from it, or a .cameramodel "
                "[default: phone]")
      ->type_name("CAMERA");
  c->add_option("--lamp", o->lamp,
                "Place the lamp above, left, right or below, 40 degrees off (\"above 600mm\"), or at X,Y,Z from the "
                "lower left corner, mm [default: above]")
      ->type_name("LAMP");
  c->add_option("--stand", o->stand,
                "Set the distance from eye to board: 1.2m, 48in [default: about four times the board's diagonal]");
  c->add_option("--machine", o->machine, "Use this built-in machine or burin/machine file [default: grbl-spring]")
      ->type_name("MACHINE");
  c->add_option(
       "--fit", o->fit,
       "Fit pictures by filling the board (cover) or whole (contain): one word, or one per picture [default: auto]")
      ->type_name("WORD ...")
      ->expected(1, -1)
      ->check(CLI::IsMember({"cover", "contain"}));
  c->add_option("--keep", o->keep, "Keep this part of cropped pictures: one word, or one per picture [default: auto]")
      ->type_name("WORD ...")
      ->expected(1, -1)
      ->check(CLI::IsMember({"top", "middle", "bottom", "left", "right"}));
  c->add_option("--count", o->scratches, "Start the design with this number of scratches [default: 4000 per picture]")
      ->check(CLI::Range(1, 2000000));
  c->footer(
      example("burin new my-board --board 200x150 --pictures a.jpg b.jpg c.jpg\n"
              "  burin new my-board --pictures a.jpg b.jpg --camera photo.jpg --stand 1.2m --lamp \"above 900mm\"\n"
              "  burin new"));
  c->callback([o] { print(run(*o)); });
}

}  // namespace burin
