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
#include <string_view>
#include <system_error>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/files/file_error.h"
#include "burin/base/files/files_together.h"
#include "burin/base/files/named_paths.h"
#include "burin/base/files/printable.h"
#include "burin/base/simd_choice.h"
#include "burin/base/threads.h"
#include "burin/optimize/duration.h"
#include "tools/commands.h"
#include "tools/output_mode.h"
#include "tools/standard_streams.h"
#include "tools/stop_signal.h"

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
  burin->set_version_flag("--version", "burin " BURIN_VERSION);
  burin->footer(
      "Run `burin help COMMAND` for options and an example. Start with `burin new`.\n"
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
      ->type_name("NAME");
  // take_output_mode() removes these before parsing (tools/output_mode.h). Here they only appear in --help.
  burin->add_flag("--quiet")->description("Print only notes, warnings and errors");
  burin->add_flag("--json")->description("Print one JSON object at the end instead of text");
  const auto group = [&](const char* name, std::initializer_list<void (*)(CLI::App&)> commands) {
    const std::size_t before = burin->get_subcommands({}).size();
    for (const auto add_command : commands) add_command(*burin);
    const auto all = burin->get_subcommands({});
    for (std::size_t i = before; i < all.size(); ++i) all[i]->group(name);
  };
  group("Start a project and follow it", {add_new_command, add_loop_command, add_status_command, add_trace_command});
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

void parse(CLI::App& app, const std::vector<std::string>& arguments) {
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

std::string wrong_duration(const std::string& text) {
  try {
    duration_from_text(text);
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

void run_command(const std::vector<std::string>& arguments) { parse(*make_app(), arguments); }

namespace {

int said_stopped(bool kept) {
  take_last_word();
  tell("burin: " + stop_sentence(kept) + "\n");
  return stop_exit_code();
}

std::string too_few_threads() {
  return fmt::format("threads: the system gives too few; {}, or use fewer: burin --threads 1", error_remedy(EAGAIN));
}

// Returns the sentence for an exception that ends the command. Returns an empty one if the check of standard output
// will report the error.
std::string exception_sentence(const std::exception_ptr& thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
    return "ended by itself; this is a fault in Burin, please report it with the command you gave";
  } catch (const Error& error) {
    return error.what();
  } catch (const std::filesystem::filesystem_error& error) {
    // Errors without an earlier check: a folder without read permission, circular links, an overlong name.
    return fmt::format("{}: cannot be used: {}; {}",
                       error.path1().empty() ? "a file or folder" : printable(error.path1().string()),
                       error_text(error.code().value()), error_remedy(error.code().value()));
  } catch (const std::system_error& error) {
    // fmt::print throws this for standard output, whose error is reported at the end.
    if (std::ferror(stdout) != 0) return {};
    if (error.code().value() == EAGAIN) return too_few_threads();
    return fmt::format("{}; {}", error.what(), error_remedy(error.code().value()));
  } catch (const std::bad_alloc&) {
    return fmt::format("memory ran out; {}", kMoreMemory);
  } catch (const std::exception& error) {
    const std::string_view what = error.what();
    if (what.find("Failed to allocate") != std::string_view::npos)  // message of OpenCV
      return fmt::format("memory ran out; {}", kMoreMemory);
    if (what.find("pthread_create") != std::string_view::npos) return too_few_threads();  // message of TBB
    return fmt::format("{}; this is a fault in Burin, please report it with the command you gave", printable(what));
  } catch (...) {
    return "an unknown exception; this is a fault in Burin, please report it with the command you gave";
  }
}

int run_in_words(const std::vector<std::string>& arguments) {
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
    return app->exit(error) == 0 ? kDone : kWrongCommandLine;
  } catch (...) {
    take_last_word();
    const int exit_code = StopOnSignal::asked() ? stop_exit_code() : kNotDone;
    const std::string words = exception_sentence(std::current_exception());
    if (!words.empty()) tell("burin: " + words + "\n");
    return exit_code;
  }
  return kDone;
}

}  // namespace

namespace {

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

/// `burin` and `burin help` as `burin --help`, `burin help design` as `burin design --help`.
std::vector<std::string> with_help_as_option(const std::vector<std::string>& arguments) {
  if (arguments.empty()) return {"--help"};
  if (arguments[0] != "help") return arguments;
  std::vector<std::string> out(arguments.begin() + 1, arguments.end());
  out.emplace_back("--help");
  return out;
}

}  // namespace

int run_program(const std::vector<std::string>& arguments) {
  fill_closed_streams();
  std::vector<std::string> command = program_options_first(with_help_as_option(arguments));
  const OutputMode mode = take_output_mode(command);
  int exit_code = kDone;
  const NamedPaths named(command);
  try {
    StopWords words;
    words.last = [mode, command](const std::string& sentence, int code) {
      say_at_the_end(mode, command, sentence, code);
    };
    if (mode == OutputMode::words) words.heard = [](const std::string& sentence) { say_meanwhile(sentence); };
    words.uncaught = exception_sentence;
    end_on_signals(command_text(arguments), std::move(words));
    report_settled_changes([](const std::string& sentence) { note(sentence); });
    const ResultToOutput result(command);
    exit_code = run_in_mode(mode, command, [&] { return run_in_words(command); });
  } catch (const std::exception&) {
    const std::string words = exception_sentence(std::current_exception());
    if (!words.empty()) tell("burin: " + words + "\n");
    exit_code = kNotDone;
  }
  return exit_code_with_output_checked(exit_code);
}

}  // namespace burin
