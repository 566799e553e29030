// The burin program: subcommands over the libraries. How a command is made stands in tools/commands.h.
#include <fmt/core.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdio>
#include <exception>

#include "render/error.h"
#include "tools/commands.h"

namespace {

enum ExitCode { kDone = 0, kNotDone = 1, kWrongCommandLine = 2 };

void add_commands([[maybe_unused]] CLI::App& burin) {
  using namespace burin;
#ifdef BURIN_COMMAND_simulate
  add_simulate_command(burin);
#endif
#ifdef BURIN_COMMAND_capture
  add_capture_command(burin);
#endif
#ifdef BURIN_COMMAND_calibrate
  add_calibrate_command(burin);
#endif
#ifdef BURIN_COMMAND_refine
  add_refine_command(burin);
#endif
#ifdef BURIN_COMMAND_design
  add_design_command(burin);
#endif
#ifdef BURIN_COMMAND_render
  add_render_command(burin);
#endif
#ifdef BURIN_COMMAND_toolpath
  add_toolpath_command(burin);
#endif
#ifdef BURIN_COMMAND_report
  add_report_command(burin);
#endif
#ifdef BURIN_COMMAND_loop
  add_loop_command(burin);
#endif
#ifdef BURIN_COMMAND_check
  add_check_command(burin);
#endif
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App burin("Turns pictures into scratches on a metal board, and photographs of that board into better scratches.",
                 "burin");
  burin.set_version_flag("--version", "burin " BURIN_VERSION);
  burin.footer("`burin COMMAND --help` shows a command's options and an example.");
  burin.require_subcommand(1);
  try {
    add_commands(burin);
    burin.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return burin.exit(error) == 0 ? kDone : kWrongCommandLine;
  } catch (const burin::Error& error) {
    fmt::print(stderr, "burin: {}\n", error.what());
    return kNotDone;
  } catch (const std::exception& error) {
    fmt::print(stderr, "burin: {}; this is a fault in Burin, please report it with the command you gave\n",
               error.what());
    return kNotDone;
  }
  return kDone;
}
