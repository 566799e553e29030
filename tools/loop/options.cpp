#include "tools/loop/options.h"

#include <fmt/format.h>

#include <CLI/Error.hpp>
#include <algorithm>
#include <optional>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/files/table.h"
#include "burin/base/files/write_file.h"
#include "burin/optimize/machine_profile.h"
#include "burin/optimize/toolpath/toml_file.h"
#include "tools/commands.h"
#include "tools/loop/toml_line.h"
#include "tools/new/words.h"
#include "tools/old_names.h"
#include "tools/steps.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

const std::string kUsualMachine = "grbl";

// Adds a command's options, and returns the owner of their values.
using AddOptions = std::shared_ptr<void> (*)(CLI::App&);

template <typename Arguments, void (*add)(CLI::App&, Arguments&)>
std::shared_ptr<void> own_options(CLI::App& app) {
  auto arguments = std::make_shared<Arguments>();
  add(app, *arguments);
  return arguments;
}

constexpr AddOptions kDesign = own_options<DesignArguments, add_design_options>,
                     kToolpath = own_options<ToolpathArguments, add_toolpath_options>,
                     kCapture = own_options<CaptureArguments, add_capture_options>;

fs::path options_file(const fs::path& project) { return project / "loop.toml"; }

// Parser of one command's options, for their names and for the check of a table.
struct Parser {
  explicit Parser(AddOptions add) : values(add(app)) {}
  const CLI::Option* option(const std::string& name) const { return app.get_option_no_throw("--" + name); }
  bool is_file(const std::string& name) const { return option(name) && option(name)->get_type_name() == kFile; }
  CLI::App app;
  std::shared_ptr<void> values;
};

std::vector<std::string> words_of(const CommandOptions& options) {
  std::vector<std::string> words;
  for (const auto& [name, values] : options) {
    if (values.empty()) words.push_back("--" + name);
    // "--rate=-1": a value with a leading dash is no option.
    for (const std::string& value : values) words.push_back("--" + name + "=" + value);
  }
  return words;
}

std::string text_of(const Json& value, const JsonObject& table, const std::string& name) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_integer()) return value.dump();
  if (value.is_number()) return shortest(value.get<double>());
  table.fail_field(name, "is neither a number nor text nor a list of these",
                   "write it as the command's option takes it");
}

CommandOptions read_command(JsonObject& root, const std::string& command, AddOptions add) {
  CommandOptions options;
  if (!root.has(command)) return options;
  JsonObject table = root.object(command);
  const Parser parser(add);
  for (const std::string& name : table.keys()) {
    const Json& value = table.raw(name);
    const bool is_old = with_new_name(command, name, {}).name != name;
    const CLI::Option* option = parser.option(with_new_name(command, name, {}).name);
    if (is_old && option != nullptr) {
      if (value == false) continue;
      std::vector<std::string> values;
      if (!value.is_boolean()) values = {text_of(value, table, name)};
      const NamedValues now = with_new_name(command, name, values);
      options[now.name].insert(options[now.name].end(), now.values.begin(), now.values.end());
      continue;
    }
    if (!option)
      table.fail_field(name, "is no option of burin " + command,
                       "`burin loop --help` lists them; their dashes are left out here");
    const bool flag = option->get_items_expected_max() == 0;
    if (flag != value.is_boolean())
      table.fail_field(name, flag ? "is no true or false" : "is true or false",
                       flag ? "write true" : "write its value");
    if (flag) {
      if (value.get<bool>()) options[name] = {};
    } else if (value.is_array()) {
      for (const Json& each : value) options[name].push_back(text_of(each, table, name));
    } else {
      options[name] = {text_of(value, table, name)};
    }
  }
  table.finish();
  return options;
}

// Applies the command's own checks.
void check_command(const CommandOptions& options, const std::string& command, AddOptions add, const fs::path& file) {
  Parser parser(add);
  std::vector<std::string> words = words_of(options);
  std::reverse(words.begin(), words.end());  // CLI11 takes a stack
  try {
    parser.app.parse(words);
  } catch (const CLI::ParseError& error) {
    fail(file.string() + ": " + command, error.what(), "correct it there");
  }
}

// Returns true for a machine without a built-in's name.
bool is_file_name(const std::string& machine, const fs::path& from) {
  return machine.find_first_of("/.") != std::string::npos || fs::is_regular_file(from / machine);
}

// Returns the options of this command line, with files relative to the project.
CommandOptions said_of(const CLI::App& group, const fs::path& project) {
  CommandOptions said;
  for (const CLI::Option* option : group.get_options()) {
    if (option->count() == 0) continue;
    std::vector<std::string>& values = said[option->get_lnames().front()];
    if (option->get_items_expected_max() == 0) continue;
    values = option->results();
    if (option->get_type_name() == kFile)
      for (std::string& value : values) value = path_in_project(project, value);
  }
  return said;
}

std::string toml_text(const std::string& text) { return Json(text).dump(); }

std::string toml_value(const std::vector<std::string>& values) {
  if (values.empty()) return "true";
  std::string out;
  for (const std::string& value : values) {
    const std::optional<double> number = number_in(value);
    const bool plain = number && shortest(*number) == value;  // converts back to the same text
    out += (out.empty() ? "" : ", ") + (plain ? value : toml_text(value));
  }
  return values.size() == 1 ? out : "[" + out + "]";
}

std::vector<std::string> arguments_of(const CommandOptions& options, AddOptions add, const fs::path& project) {
  const Parser parser(add);
  CommandOptions usable = options;
  for (auto& [name, values] : usable)
    if (parser.is_file(name))
      for (std::string& value : values) value = resolve_path(options_file(project), value).string();
  return words_of(usable);
}

std::vector<fs::path> files_of(const LoopOptions& options, const CommandOptions& command, AddOptions add,
                               const fs::path& project) {
  std::vector<fs::path> files;
  if (is_file_name(options.machine, project)) files.push_back(machine_argument(options, project));
  const Parser parser(add);
  for (const auto& [name, values] : command)
    if (parser.is_file(name))
      for (const std::string& value : values) files.push_back(resolve_path(options_file(project), value));
  return files;
}

std::string joined_texts(const std::vector<std::string>& values) {
  std::string out;
  for (const std::string& value : values) out += (out.empty() ? "" : " ") + value;
  return out;
}

LoopOptions read_options_file(const fs::path& file) {
  LoopOptions options;
  const TomlFile toml = read_toml(file, "burin/loop", 1);
  with_line(file, toml, [&] {
    JsonObject root(toml.content, file.string());
    root.has("format");
    root.has("version");
    options.machine = root.text("machine", "");
    options.design = read_command(root, "design", kDesign);
    options.toolpath = read_command(root, "toolpath", kToolpath);
    options.capture = read_command(root, "capture", kCapture);
    MachineProfile reach;
    read_travel(root, reach);
    options.travel = reach.travel;
    options.travel_is_unknown = reach.travel_is_unknown;
    if (root.has("accept_unknown"))
      for (const Json& name : root.raw("accept_unknown"))
        options.accept_unknown.push_back(text_of(name, root, "accept_unknown"));
    root.finish();
  });
  check_command(options.design, "design", kDesign, file);
  check_command(options.toolpath, "toolpath", kToolpath, file);
  check_command(options.capture, "capture", kCapture, file);
  return options;
}

// Reads a file under its temporary name; errors have its final name.
LoopOptions read_options_part(const fs::path& part, const fs::path& file) {
  try {
    return read_options_file(part);
  } catch (const Error& error) {
    std::string words = error.what();
    if (const std::size_t at = words.find(part.string()); at != std::string::npos)
      words.replace(at, part.string().size(), file.string());
    throw Error(words);
  }
}

}  // namespace

LoopOptions read_loop_options(const fs::path& project) {
  const fs::path file = options_file(project);
  return fs::exists(file) ? read_options_file(file) : LoopOptions();
}

void add_loop_options(CLI::App& command, LoopCommandLine& said) {
  command.add_option("--machine", said.machine,
                     "Carve on this machine: " + built_in_machines() +
                         ", or a burin/machine file (JSON or TOML), kept in loop.toml [default: grbl]");
  said.design = command.add_option_group("design", "Options of burin design, kept in PROJECT_DIR/loop.toml");
  said.design_values = kDesign(*said.design);
  said.toolpath = command.add_option_group("toolpath", "Options of burin toolpath, kept in PROJECT_DIR/loop.toml");
  said.toolpath_values = kToolpath(*said.toolpath);
  said.capture = command.add_option_group("capture", "Options of burin capture, kept in PROJECT_DIR/loop.toml");
  said.capture_values = kCapture(*said.capture);
  command.add_option("--travel", said.travel,
                     "Set the machine's reach from the board's lower left corner, mm: 300x180, or unknown; kept in "
                     "loop.toml [default: ask once at a terminal]");
}

namespace {

// Converts "300x180" to a value for loop.toml, from work zero.
std::string toml_travel(const std::string& words) {
  if (words == "unknown") return toml_text(words);
  const Eigen::Vector2d far_mm = size_in_words(words, "the machine's reach");
  return fmt::format("[[0, 0], [{}, {}]]", shortest(far_mm.x()), shortest(far_mm.y()));
}

}  // namespace

LoopOptions remember_options(const LoopCommandLine& said, const fs::path& project) {
  const fs::path file = options_file(project);
  LoopOptions before = read_loop_options(project);
  LoopOptions wanted = before;
  if (!said.machine.empty())
    wanted.machine = is_file_name(said.machine, ".") ? path_in_project(project, said.machine) : said.machine;
  // The prefix distinguishes a file next to loop.toml from a built-in name.
  if (wanted.machine != before.machine && is_file_name(said.machine, ".") && !is_file_name(wanted.machine, project))
    wanted.machine = "./" + wanted.machine;
  for (const auto& [name, values] : said_of(*said.design, project)) wanted.design[name] = values;
  for (const auto& [name, values] : said_of(*said.toolpath, project)) wanted.toolpath[name] = values;
  for (const auto& [name, values] : said_of(*said.capture, project)) wanted.capture[name] = values;
  const std::string travel = said.travel.empty() ? "" : toml_travel(said.travel);
  const auto is_kept = [&wanted](const LoopOptions& kept) {
    return kept.machine == wanted.machine && kept.design == wanted.design && kept.toolpath == wanted.toolpath &&
           kept.capture == wanted.capture;
  };
  if (is_kept(before) && travel.empty()) return before;

  const bool there = fs::exists(file);
  std::string text = there ? read_text(file) : "format = \"burin/loop\"\nversion = 1\n";
  if (wanted.machine != before.machine) text = with_toml_value(text, "", "machine", toml_text(wanted.machine));
  if (!travel.empty()) text = with_toml_value(text, "", "travel_mm", travel);
  for (const auto& [table, now, old] : {std::tuple{"design", &wanted.design, &before.design},
                                        std::tuple{"toolpath", &wanted.toolpath, &before.toolpath},
                                        std::tuple{"capture", &wanted.capture, &before.capture}})
    for (const auto& [name, values] : *now)
      if (const auto found = old->find(name); found == old->end() || found->second != values)
        text = with_toml_value(text, table, name, toml_value(values));
  LoopOptions now;
  write_file(text, file, Durability::on_disk, [&](const fs::path& part) {
    now = read_options_part(part, file);
    if (!is_kept(now) || (!travel.empty() && !now.travel && !now.travel_is_unknown))
      fail(file.string(), "is written in a way that the options given here cannot be added to",
           "write them there: machine = \"...\", [design], [toolpath], [capture], one option a line");
  });
  return now;
}

MachineProfile machine_of(const LoopOptions& options, const fs::path& project) {
  MachineProfile machine = machine_profile(machine_argument(options, project));
  if (!machine.travel && !machine.travel_is_unknown) {
    machine.travel = options.travel;
    machine.travel_is_unknown = options.travel_is_unknown;
  }
  return machine;
}

std::string machine_argument(const LoopOptions& options, const fs::path& project) {
  if (options.machine.empty()) return kUsualMachine;
  if (!is_file_name(options.machine, project)) return options.machine;
  return resolve_path(options_file(project), options.machine).string();
}

std::vector<std::string> design_arguments(const LoopOptions& options, const fs::path& project) {
  return arguments_of(options.design, kDesign, project);
}

std::vector<std::string> toolpath_arguments(const LoopOptions& options, const fs::path& project) {
  return arguments_of(options.toolpath, kToolpath, project);
}

std::vector<std::string> capture_arguments(const LoopOptions& options, const fs::path& project) {
  return arguments_of(options.capture, kCapture, project);
}

namespace {

// Sets the given options of a command's arguments.
template <typename Arguments>
void give(std::vector<std::string> words, void (*add)(CLI::App&, Arguments&), Arguments& arguments) {
  CLI::App app;
  add(app, arguments);
  std::reverse(words.begin(), words.end());  // CLI11 takes a stack
  app.parse(words);
}

}  // namespace

void give_options(const LoopOptions& options, const fs::path& project, DesignArguments& arguments) {
  give(design_arguments(options, project), add_design_options, arguments);
}

void give_options(const LoopOptions& options, const fs::path& project, ToolpathArguments& arguments) {
  give(toolpath_arguments(options, project), add_toolpath_options, arguments);
}

void give_options(const LoopOptions& options, const fs::path& project, CaptureArguments& arguments) {
  give(capture_arguments(options, project), add_capture_options, arguments);
}

std::vector<fs::path> design_option_files(const LoopOptions& options, const fs::path& project) {
  return files_of(options, options.design, kDesign, project);
}

std::vector<fs::path> toolpath_option_files(const LoopOptions& options, const fs::path& project) {
  return files_of(options, options.toolpath, kToolpath, project);
}

OptionTexts texts_of(const CommandOptions& command) {
  OptionTexts texts;
  for (const auto& [name, values] : command) texts[name] = values.empty() ? "yes" : joined_texts(values);
  return texts;
}

OptionTexts option_texts(const LoopOptions& options, const CommandOptions& command) {
  OptionTexts texts = texts_of(command);
  texts["machine"] = options.machine.empty() ? kUsualMachine : options.machine;
  return texts;
}

std::string in_words(const LoopOptions& options) {
  std::string words = "for " + (options.machine.empty() ? kUsualMachine : options.machine);
  for (const auto& [command, of] : {std::pair{"design", &options.design}, std::pair{"toolpath", &options.toolpath},
                                    std::pair{"capture", &options.capture}}) {
    std::string list;
    for (const auto& [name, values] : *of)
      list += (list.empty() ? "" : ", ") + name + (values.empty() ? "" : " " + joined_texts(values));
    if (!list.empty()) words += fmt::format("; {}: {}", command, list);
  }
  if (!options.accept_unknown.empty()) words += "; goes on without knowing " + joined_texts(options.accept_unknown);
  return words;
}

}  // namespace burin
