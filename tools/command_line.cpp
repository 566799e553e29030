#include "tools/command_line.h"

#include <fmt/format.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <new>
#include <optional>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/files/file_error.h"
#include "burin/base/files/files_together.h"
#include "burin/base/files/named_paths.h"
#include "burin/base/files/printable.h"
#include "burin/base/files/table.h"
#include "burin/base/simd_choice.h"
#include "burin/base/threads.h"
#include "burin/optimize/duration.h"
#include "tools/commands.h"
#include "tools/new/words.h"
#include "tools/old_names.h"
#include "tools/output_mode.h"
#include "tools/standard_streams.h"
#include "tools/stop_signal.h"
#include "tools/version.h"

namespace burin {
namespace {

constexpr const char* kMoreMemory =
    "close other programs, lift a limit on memory (ulimit -v), or give less: fewer views, smaller photos "
    "(docs/limits.md has what each costs)";

enum ExitCode { kDone = 0, kNotDone = 1, kWrongCommandLine = 2 };

std::unique_ptr<SimdChoice> simd_choice(const std::string& name, const char* where) {
  const std::optional<SimdWidth> width = simd_named(name);
  if (!width) throw CLI::ValidationError(where, "write sse2, avx2 or avx512, not \"" + name + "\"");
  return std::make_unique<SimdChoice>(*width);
}

std::unique_ptr<ThreadLimit> thread_limit(const std::string& count, const char* where) {
  int most_threads = 0;
  const auto [end, error] = std::from_chars(count.data(), count.data() + count.size(), most_threads);
  if (error != std::errc() || end != count.data() + count.size() || most_threads < 1)
    throw CLI::ValidationError(where, "\"" + count + "\" is not a number of threads; give 1 or more");
  return std::make_unique<ThreadLimit>(most_threads);
}

}  // namespace

std::unique_ptr<CLI::App> make_app() {
  auto burin = std::make_unique<CLI::App>(
      "Design boards of scratches that show pictures, calibrate them from photos, and improve the next design",
      "burin");
  burin->set_version_flag("--version", "burin " + version());
  burin->footer(
      "Run `burin help COMMAND` for options and an example, `burin help all COMMAND` for all options.\n"
      "Start with `burin new`.\n"
      "BURIN_THREADS and BURIN_SIMD set the defaults of --threads and --simd.");
  burin->require_subcommand(1);
  // The limit must exist before a command's work begins, and lives as long as the app.
  const auto limit = std::make_shared<std::unique_ptr<ThreadLimit>>();
  burin
      ->add_option_function<std::string>(
          "--threads", [limit](const std::string& count) { *limit = thread_limit(count, "--threads"); },
          "Use at most this number of threads [default: all cores]")
      ->type_name("N");
  const auto choice = std::make_shared<std::unique_ptr<SimdChoice>>();
  burin
      ->add_option_function<std::string>(
          "--simd", [choice](const std::string& name) { *choice = simd_choice(name, "--simd"); },
          "Use these vector instructions: sse2, avx2 or avx512; equal ones reproduce a design [default: the widest]")
      ->type_name("NAME:{sse2,avx2,avx512}");
  // take_output_mode() removes these before parsing (tools/output_mode.h). Here they only appear in --help.
  burin->add_flag("--quiet")->description("Print only notes, warnings and errors");
  burin->add_flag("--json")->description("Print one JSON object at the end instead of text");
  burin->add_flag("--help-all")->description("Print this help with the seldom needed options of the command");
  burin->add_flag("--json-lines")->description("Print one JSON object per line: progress, events, and the result last");
  const auto group = [&](const char* name, std::initializer_list<void (*)(CLI::App&)> commands) {
    const std::size_t before = burin->get_subcommands({}).size();
    for (const auto add_command : commands) add_command(*burin);
    const auto all = burin->get_subcommands({});
    for (std::size_t i = before; i < all.size(); ++i) all[i]->group(name);
  };
  group("Start a project and follow it", {add_new_command, add_loop_command, add_studio_command, add_status_command,
                                          add_trace_command, add_wall_command});
  group("Design", {add_design_command, add_render_command, add_view_command});
  group("Carve", {add_check_command, add_coupon_command, add_toolpath_command, add_probe_command});
  group("Photograph", {add_plan_command, add_print_command, add_sheet_command, add_watch_command, add_capture_command});
  group("Calibrate", {add_lens_command, add_calibrate_command, add_refine_command, add_report_command});
  group("Simulate", {add_simulate_command});
  return burin;
}

namespace {

/// The fewest letters that are put in, left out, exchanged or swapped with the next to make one word of the other.
std::size_t letters_apart(const std::string& a, const std::string& b) {
  std::vector<std::vector<std::size_t>> cost(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i)
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        cost[i][j] = i + j;
        continue;
      }
      const bool same = a[i - 1] == b[j - 1];
      cost[i][j] = std::min({cost[i - 1][j] + 1, cost[i][j - 1] + 1, cost[i - 1][j - 1] + (same ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        cost[i][j] = std::min(cost[i][j], cost[i - 2][j - 2] + 1);
    }
  return cost[a.size()][b.size()];
}

/// "; did you mean 'design'?", if one of the names is near enough to be meant, or begins so.
std::string did_you_mean(const std::string& word, const std::vector<std::string>& names) {
  const std::string* nearest = nullptr;
  std::size_t least = 1 + std::max<std::size_t>(1, word.size() / 3);
  for (const std::string& name : names) {
    const std::size_t apart = word.size() > 3 && name.starts_with(word) ? 1 : letters_apart(word, name);
    if (apart >= least) continue;
    least = apart;
    nearest = &name;
  }
  return nearest == nullptr ? "" : fmt::format("; did you mean '{}'?", *nearest);
}

[[noreturn]] void fail_unknown_command(const CLI::App& app, const std::string& word) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  const std::string guess = did_you_mean(word, names);
  throw CLI::ExtrasError(fmt::format("there is no command '{}'{}", word,
                                     guess.empty() ? fmt::format("; there are: {}", fmt::join(names, ", ")) : guess),
                         CLI::ExitCodes::ExtrasError);
}

[[noreturn]] void fail_unexpected(const CLI::App& app, const CLI::App& command, const std::string& word) {
  std::string name = command.get_name(), guess;
  for (const CLI::App* of = command.get_parent(); of != nullptr; of = of->get_parent())
    name = of->get_name() + " " + name;
  if (word.starts_with("--")) {
    std::vector<std::string> names;
    for (const CLI::App* from : {&command, &app})
      for (const CLI::Option* known : from->get_options())
        for (const std::string& one : known->get_lnames()) names.push_back("--" + one);
    guess = did_you_mean(word, names);
  }
  throw CLI::ExtrasError(fmt::format("{} does not take '{}'{}", name, word, guess), CLI::ExitCodes::ExtrasError);
}

/// The command that words from `at` on name, and `at` behind them: "check carve" are two. The app itself if they name
/// none.
const CLI::App& named_command(const CLI::App& app, const std::vector<std::string>& arguments, std::size_t& at) {
  const CLI::App* command = &app;
  for (; at < arguments.size(); ++at) {
    const auto among = command->get_subcommands([&](const CLI::App* one) { return one->get_name() == arguments[at]; });
    if (among.empty()) break;
    command = among.front();
  }
  return *command;
}

/// CLI11 looks for options that are missing before it names one that is misspelled.
void check_option_names(const CLI::App& app, const CLI::App& command, const std::vector<std::string>& arguments) {
  for (const std::string& word : arguments) {
    if (word == "--") return;
    const std::string name = word.substr(0, word.find('='));
    if (name.starts_with("--") && command.get_option_no_throw(name) == nullptr &&
        app.get_option_no_throw(name) == nullptr)
      fail_unexpected(app, command, name);
  }
}

// Leaves seldom needed options out of the help.
void hide_seldom_options(CLI::App& app) {
  for (CLI::Option* option : app.get_options())
    if (option->get_group() == kSeldom) option->group("");
  for (CLI::App* part : app.get_subcommands({})) hide_seldom_options(*part);
}

// --help-all is --help with all options.
std::vector<std::string> with_help_all(CLI::App& app, std::vector<std::string> arguments) {
  const auto all = std::find(arguments.begin(), arguments.end(), "--help-all");
  if (all == arguments.end())
    hide_seldom_options(app);
  else
    *all = "--help";
  return arguments;
}

void parse(CLI::App& app, const std::vector<std::string>& given) {
  const std::vector<std::string> arguments = with_help_all(app, given);
  // CLI11 would only report a missing command.
  const std::size_t first = place_of_command(arguments);
  std::size_t behind = first;
  const CLI::App& command = named_command(app, arguments, behind);
  if (first < arguments.size() && !arguments[first].starts_with('-') && &command == &app)
    fail_unknown_command(app, arguments[first]);
  check_option_names(app, command, arguments);
  try {
    // CLI11 takes the arguments as a stack, the first on top.
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
  } catch (const CLI::ExtrasError&) {
    const std::vector<std::string> words = app.remaining(true);
    fail_unexpected(app, command, words.empty() ? "" : words.front());
  }
}

}  // namespace

std::string shell_word_of_bytes(const std::string& word) {
  std::string quoted = "$'";
  for (const char c : word) {
    if (c == '\'' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return printable(quoted) + "'";
}

namespace {

// CLI11 takes a length as the number of units.
CLI::Option* read_as_length(CLI::Option* option, const char* unit, double least) {
  const double unit_mm = std::string_view(unit) == "um" ? 1e-3 : 1;
  return option->type_name("LENGTH")->transform(CLI::Validator(
      [=](std::string& text) {
        try {
          const std::optional<double> bare = number_in(text);
          const double length = bare ? *bare : length_in_words(text, "a length") / unit_mm;
          if (!(length >= least)) return fmt::format("{} is less than {} {}", text, least, unit);
          text = shortest(length);
          return std::string();
        } catch (const Error& error) {
          return std::string(error.what());
        }
      },
      ""));
}

}  // namespace

CLI::Option* add_length_option(CLI::App& command, const std::string& name, double& value, const std::string& words,
                               const char* unit, double least) {
  return read_as_length(command.add_option(name, value, words), unit, least);
}

CLI::Option* add_length_option(CLI::App& command, const std::string& name, std::optional<double>& value,
                               const std::string& words, const char* unit, double least) {
  return read_as_length(command.add_option(name, value, words), unit, least);
}

std::string wrong_duration(const std::string& text) {
  try {
    duration_from_text(text);
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

namespace {

int said_stopped(bool kept) {
  take_last_word();
  tell_error({ErrorCode::stopped, "", stop_sentence(kept), ""});
  return stop_exit_code();
}

InputError too_few_threads() {
  return {ErrorCode::no_threads, "threads", "the system gives too few",
          error_remedy(EAGAIN) + ", or use fewer: burin --threads 1"};
}

constexpr const char* kReport = "this is a fault in Burin, please report it with the command you gave";

InputError memory_ran_out() { return {ErrorCode::no_memory, "", "memory ran out", kMoreMemory}; }

// Returns the error for an exception that ends the command; none if the check of standard output will report it.
std::optional<InputError> error_of(const std::exception_ptr& thrown) {
  using enum ErrorCode;
  try {
    if (thrown) std::rethrow_exception(thrown);
    return InputError(fault, "", "ended by itself", kReport);
  } catch (const InputError& error) {
    return error;
  } catch (const Error& error) {
    return InputError(bad_input, "", error.what(), "");
  } catch (const std::filesystem::filesystem_error& error) {
    // Errors without an earlier check: a folder without read permission, circular links, an overlong name.
    return InputError(unreadable_file, error.path1().empty() ? "a file or folder" : error.path1().string(),
                      "cannot be used: " + error_text(error.code().value()), error_remedy(error.code().value()));
  } catch (const std::system_error& error) {
    // fmt::print throws this for standard output, whose error is reported at the end.
    if (std::ferror(stdout) != 0) return std::nullopt;
    if (error.code().value() == EAGAIN) return too_few_threads();
    return InputError(bad_input, "", error.what(), error_remedy(error.code().value()));
  } catch (const std::bad_alloc&) {
    return memory_ran_out();
  } catch (const std::exception& error) {
    const std::string_view what = error.what();
    if (what.find("Failed to allocate") != std::string_view::npos)  // message of OpenCV
      return memory_ran_out();
    if (what.find("pthread_create") != std::string_view::npos) return too_few_threads();  // message of TBB
    return InputError(fault, "", error.what(), kReport);
  } catch (...) {
    return InputError(fault, "", "an unknown exception", kReport);
  }
}

// Runs the command line, and reports how it ends. Returns the exit code. `text`: of --help and --version.
int run_and_report(const std::vector<std::string>& arguments, std::string& text) {
  const auto app = make_app();
  std::unique_ptr<SimdChoice> by_environment;
  std::unique_ptr<ThreadLimit> limit_by_environment;
  try {
    if (const char* const name = std::getenv("BURIN_SIMD"); name != nullptr && *name != 0)
      by_environment = simd_choice(name, "BURIN_SIMD");
    if (const char* const count = std::getenv("BURIN_THREADS"); count != nullptr && *count != 0)
      limit_by_environment = thread_limit(count, "BURIN_THREADS");
    parse(*app, arguments);
    if (StopOnSignal::asked()) return said_stopped(true);
  } catch (const Stopped&) {
    return said_stopped(false);
  } catch (const CLI::ParseError& error) {
    take_last_word();
    std::ostringstream out, err;
    const bool good = app->exit(error, out, err) == 0;
    text = out.str();
    if (!good) tell_error({ErrorCode::command_line, "", error.what(), ""});
    return good ? kDone : kWrongCommandLine;
  } catch (...) {
    take_last_word();
    const int exit_code = StopOnSignal::asked() ? stop_exit_code() : kNotDone;
    if (const auto error = error_of(std::current_exception())) tell_error(*error);
    return exit_code;
  }
  return kDone;
}

// Moves the program's own options before the command. Options that the command has too stay behind it.
std::vector<std::string> program_options_first(const std::vector<std::string>& arguments) {
  const auto app = make_app();
  const std::size_t at = place_of_command(arguments);
  std::size_t behind = at;
  const CLI::App& command = named_command(*app, arguments, behind);
  if (&command == app.get()) return arguments;
  std::vector<std::string> first, rest, own;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& word = arguments[i];
    if (i >= at && word == "--") {  // no options after this
      rest.insert(rest.end(), arguments.begin() + static_cast<std::ptrdiff_t>(i), arguments.end());
      break;
    }
    const std::size_t words = words_of_program_option(word);
    const bool is_own = words > 0 && command.get_option_no_throw(word.substr(0, word.find('='))) != nullptr;
    std::vector<std::string>& into = is_own ? own : i < at || words > 0 ? first : rest;
    into.push_back(word);
    if (words == 2 && i + 1 < arguments.size()) into.push_back(arguments[++i]);
  }
  rest.insert(rest.begin() + static_cast<std::ptrdiff_t>(behind - at), own.begin(), own.end());
  first.insert(first.end(), rest.begin(), rest.end());
  return first;
}

}  // namespace

namespace {

/// `burin` and `burin help` as `burin --help`, `burin help design` as `burin design --help`, `burin help all design` as
/// `burin design --help-all`.
std::vector<std::string> with_help_as_option(const std::vector<std::string>& arguments) {
  if (arguments.empty()) return {"--help"};
  if (arguments[0] != "help") return arguments;
  const bool all = arguments.size() > 1 && arguments[1] == "all";
  std::vector<std::string> out(arguments.begin() + (all ? 2 : 1), arguments.end());
  out.emplace_back(all ? "--help-all" : "--help");
  return out;
}

}  // namespace

void run_command(const std::vector<std::string>& arguments) { parse(*make_app(), arguments); }

int run_program(const std::vector<std::string>& arguments) {
  fill_closed_streams();
  std::vector<std::string> command = program_options_first(with_help_as_option(arguments));
  begin_output(take_output_mode(command), command);
  int exit_code = kDone;
  {
    std::size_t behind = place_of_command(command);
    const std::string name = behind < command.size() ? command[behind] : "";
    replace_old_names(name, behind, command);
  }
  const NamedPaths named(command);
  try {
    StopWords words;
    words.last = say_at_the_end;
    words.heard = say_meanwhile;
    words.uncaught = [](const std::exception_ptr& thrown) {
      const auto error = error_of(thrown);
      return error ? std::string(error->what()) : std::string();
    };
    std::vector<std::string> line{"burin"};
    line.insert(line.end(), arguments.begin(), arguments.end());
    end_on_signals(command_text(line), std::move(words));
    report_settled_changes([](const std::string& sentence) { note(FindingCode::settings, sentence); });
    const ResultToOutput result(command);
    std::string text;
    exit_code = run_and_report(command, text);
    take_last_word();
    end_output(exit_code, text);
  } catch (const std::exception&) {
    if (const auto error = error_of(std::current_exception())) tell_error(*error);
    exit_code = kNotDone;
  }
  return exit_code_with_output_checked(exit_code);
}

}  // namespace burin
