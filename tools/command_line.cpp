#include "tools/command_line.h"

#include <fmt/format.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <memory>
#include <new>
#include <optional>
#include <string_view>
#include <system_error>

#include "burin/optimize/duration.h"
#include "burin/render/error.h"
#include "burin/render/files/file_error.h"
#include "burin/render/files/named_paths.h"
#include "burin/render/files/printable.h"
#include "burin/render/simd_choice.h"
#include "burin/render/threads.h"
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
          "Use at most so many threads (all cores unless given); stands before COMMAND")
      ->type_name("N");
  const auto choice = std::make_shared<std::unique_ptr<SimdChoice>>();
  burin
      ->add_option_function<std::string>(
          "--simd", [choice](const std::string& name) { *choice = simd_choice(name, "--simd"); },
          "Which of the processor's instructions pictures are computed with: sse2, avx2 or avx512 (the widest it has "
          "unless given, here or as BURIN_SIMD); the same ones give the same design on another machine; stands before "
          "COMMAND")
      ->type_name("NAME");
  // Taken out before anything is parsed (tools/output_mode.h); here for --help.
  burin->add_flag("--quiet")->description("Say nothing but notes and errors; stands before COMMAND");
  burin->add_flag("--json")->description("Say all in one JSON object when it is done; stands before COMMAND");
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

// A command that kept what it had when it was asked to stop has said so.
int said_stopped() {
  take_last_word();
  fmt::print(stderr, "burin: {}\n", stop_sentence());
  return stop_exit_code();
}

int run_in_words(const std::vector<std::string>& arguments) {
  const auto app = make_app();
  std::unique_ptr<SimdChoice> by_environment;
  try {
    if (const char* const name = std::getenv("BURIN_SIMD"); name != nullptr && *name != 0)
      by_environment = simd_choice(name, "BURIN_SIMD");
    parse(*app, arguments);
    stop_if_asked();
  } catch (const Stopped&) {
    return said_stopped();
  } catch (const CLI::ParseError& error) {
    take_last_word();
    return app->exit(error) == 0 ? kDone : kWrongCommandLine;
  } catch (const Error& error) {
    take_last_word();
    const int exit_code = StopOnSignal::asked() ? stop_exit_code() : kNotDone;
    fmt::print(stderr, "burin: {}\n", error.what());
    return exit_code;
  } catch (const std::filesystem::filesystem_error& error) {
    take_last_word();
    // What nobody looked at before: a folder that may not be read, links in a circle, a name that is too long.
    fmt::print(stderr, "burin: {}: cannot be used: {}; {}\n",
               error.path1().empty() ? "a file or folder" : printable(error.path1().string()),
               error_text(error.code().value()), error_remedy(error.code().value()));
    return kNotDone;
  } catch (const std::system_error& error) {
    take_last_word();
    // Standard output's is told when all is over; this is what fmt::print throws for it.
    if (std::ferror(stdout) == 0)
      fmt::print(stderr, "burin: {}; {}\n", error.what(), error_remedy(error.code().value()));
    return kNotDone;
  } catch (const std::bad_alloc&) {
    take_last_word();
    fmt::print(stderr, "burin: memory ran out; {}\n", kMoreMemory);
    return kNotDone;
  } catch (const std::exception& error) {
    take_last_word();
    if (std::string_view(error.what()).find("Failed to allocate") != std::string_view::npos) {  // OpenCV's own words
      fmt::print(stderr, "burin: memory ran out; {}\n", kMoreMemory);
      return kNotDone;
    }
    fmt::print(stderr, "burin: {}; this is a fault in Burin, please report it with the command you gave\n",
               printable(error.what()));
    return kNotDone;
  }
  return kDone;
}

}  // namespace

int run_program(const std::vector<std::string>& arguments) {
  fill_closed_streams();
  std::vector<std::string> command = arguments;
  const OutputMode mode = take_output_mode(command);
  end_on_signals(command_text(arguments), [mode, command](const std::string& sentence, int exit_code) {
    say_at_the_end(mode, command, sentence, exit_code);
  });
  int exit_code = kDone;
  const NamedPaths named(command);
  try {
    const ResultToOutput result(command);
    exit_code = run_in_mode(mode, command, [&] { return run_in_words(command); });
  } catch (const Error& error) {
    fmt::print(stderr, "burin: {}\n", error.what());
    exit_code = kNotDone;
  } catch (const std::system_error&) {  // of standard output: told below
    exit_code = kNotDone;
  }
  return exit_code_with_output_checked(exit_code);
}

}  // namespace burin
