#include "tools/command_line.h"

#include <fmt/format.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
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

}  // namespace

std::unique_ptr<CLI::App> make_app() {
  auto burin = std::make_unique<CLI::App>(
      "Turns pictures into scratches on a metal board, and photographs of that board into better scratches.", "burin");
  burin->set_version_flag("--version", "burin " BURIN_VERSION);
  burin->footer("`burin COMMAND --help` shows a command's options and an example.");
  burin->require_subcommand(1);
  // Read before any command's work begins; the limit lives as long as the app, and so while the command runs.
  const auto limit = std::make_shared<std::unique_ptr<ThreadLimit>>();
  burin
      ->add_option_function<int>(
          "--threads",
          [limit](int most_threads) {
            if (most_threads < 1) throw CLI::ValidationError("--threads", "no work is done by fewer than 1 thread");
            *limit = std::make_unique<ThreadLimit>(most_threads);
          },
          "Use at most so many threads (all cores unless given)")
      ->type_name("N");
  const auto choice = std::make_shared<std::unique_ptr<SimdChoice>>();
  burin
      ->add_option_function<std::string>(
          "--simd", [choice](const std::string& name) { *choice = simd_choice(name, "--simd"); },
          "Which of the processor's instructions pictures are computed with: sse2, avx2 or avx512 (the widest it has "
          "unless given, here or as BURIN_SIMD); the same ones give the same design on another machine")
      ->type_name("NAME");
  // Taken out before anything is parsed (tools/output_mode.h); here for --help.
  burin->add_flag("--quiet")->description("Say nothing but notes and errors");
  burin->add_flag("--json")->description("Say all in one JSON object when it is done");
  add_new_command(*burin);
  add_simulate_command(*burin);
  add_print_command(*burin);
  add_sheet_command(*burin);
  add_plan_command(*burin);
  add_capture_command(*burin);
  add_watch_command(*burin);
  add_calibrate_command(*burin);
  add_lens_command(*burin);
  add_refine_command(*burin);
  add_design_command(*burin);
  add_render_command(*burin);
  add_toolpath_command(*burin);
  add_probe_command(*burin);
  add_coupon_command(*burin);
  add_report_command(*burin);
  add_view_command(*burin);
  add_loop_command(*burin);
  add_status_command(*burin);
  add_trace_command(*burin);
  add_check_command(*burin);
  return burin;
}

namespace {

void parse(CLI::App& app, const std::vector<std::string>& arguments) {
  // CLI11 would say only that a command is missing.
  const std::size_t at = place_of_command(arguments);
  if (at < arguments.size() && !arguments[at].starts_with('-')) {
    std::string names;
    bool known = false;
    for (const CLI::App* command : app.get_subcommands({})) {
      known = known || command->get_name() == arguments[at];
      names += (names.empty() ? "" : ", ") + command->get_name();
    }
    if (!known)
      throw CLI::ExtrasError(fmt::format("there is no command '{}'; there are: {}", arguments[at], names),
                             CLI::ExitCodes::ExtrasError);
  }
  // CLI11 takes the arguments as a stack, the first on top.
  app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
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

// The sentence about an exception that ends the command; empty where standard output's is still to come.
std::string exception_sentence(const std::exception_ptr& thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
    return "ended by itself; this is a fault in Burin, please report it with the command you gave";
  } catch (const Error& error) {
    return error.what();
  } catch (const std::filesystem::filesystem_error& error) {
    // What nobody looked at before: a folder that may not be read, links in a circle, a name that is too long.
    return fmt::format("{}: cannot be used: {}; {}",
                       error.path1().empty() ? "a file or folder" : printable(error.path1().string()),
                       error_text(error.code().value()), error_remedy(error.code().value()));
  } catch (const std::system_error& error) {
    // Standard output's is told when all is over; this is what fmt::print throws for it.
    if (std::ferror(stdout) != 0) return {};
    if (error.code().value() == EAGAIN) return too_few_threads();
    return fmt::format("{}; {}", error.what(), error_remedy(error.code().value()));
  } catch (const std::bad_alloc&) {
    return fmt::format("memory ran out; {}", kMoreMemory);
  } catch (const std::exception& error) {
    const std::string_view what = error.what();
    if (what.find("Failed to allocate") != std::string_view::npos)  // OpenCV's own words
      return fmt::format("memory ran out; {}", kMoreMemory);
    if (what.find("pthread_create") != std::string_view::npos) return too_few_threads();  // TBB's own words
    return fmt::format("{}; this is a fault in Burin, please report it with the command you gave", printable(what));
  } catch (...) {
    return "an unknown exception; this is a fault in Burin, please report it with the command you gave";
  }
}

int run_in_words(const std::vector<std::string>& arguments) {
  const auto app = make_app();
  std::unique_ptr<SimdChoice> by_environment;
  try {
    if (const char* const name = std::getenv("BURIN_SIMD"); name != nullptr && *name != 0)
      by_environment = simd_choice(name, "BURIN_SIMD");
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

// The program's own options before the command, wherever they stand; those of which the command has one of that name,
// behind it.
std::vector<std::string> program_options_first(const std::vector<std::string>& arguments) {
  const auto app = make_app();
  const std::size_t at = place_of_command(arguments);
  const CLI::App* command = app.get();
  std::ptrdiff_t names = 0;  // "check carve" are two
  for (std::size_t i = at; i < arguments.size(); ++i, ++names) {
    const auto among = command->get_subcommands([&](const CLI::App* one) { return one->get_name() == arguments[i]; });
    if (among.empty()) break;
    command = among.front();
  }
  if (command == app.get()) return arguments;
  std::vector<std::string> first, rest, own;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& word = arguments[i];
    if (i >= at && word == "--") {  // what follows is no option
      rest.insert(rest.end(), arguments.begin() + static_cast<std::ptrdiff_t>(i), arguments.end());
      break;
    }
    const std::size_t words = words_of_program_option(word);
    const bool is_own = words > 0 && command->get_option_no_throw(word.substr(0, word.find('='))) != nullptr;
    std::vector<std::string>& into = is_own ? own : i < at || words > 0 ? first : rest;
    into.push_back(word);
    if (words == 2 && i + 1 < arguments.size()) into.push_back(arguments[++i]);
  }
  rest.insert(rest.begin() + names, own.begin(), own.end());
  first.insert(first.end(), rest.begin(), rest.end());
  return first;
}

}  // namespace

int run_program(const std::vector<std::string>& arguments) {
  fill_closed_streams();
  std::vector<std::string> command = program_options_first(arguments);
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
