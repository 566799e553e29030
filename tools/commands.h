// tools/commands.h - the subcommands of `burin`, one function and one file each.
//
// Each command has a function `add_NAME_command(burin)` in tools/NAME_command.cpp. An example:
//
//   void add_toolpath_command(CLI::App& burin) {
//     struct Options { std::filesystem::path scratches, out; };
//     auto options = std::make_shared<Options>();                        // lives as long as the callback
//     CLI::App* command = burin.add_subcommand("toolpath", "Turn scratches into a file that a machine carves");
//     command->add_option("SCRATCHES.csv", options->scratches, "The scratches to carve")->required();
//     command->add_option("--out", options->out, "Where to write")->required();
//     command->footer(example("burin toolpath scratches.csv --out board.gcode"));
//     command->callback([options] {
//       ProgressBar bar;                                                 // tools/progress_bar.h
//       const auto path = plan(read_scratches(options->scratches), bar.progress());
//       write_text(gcode(path), options->out);
//       bar.clear();
//       Report report;                                                   // tools/facts.h: text and JSON in one
//       report.line("Wrote {}: {} scratches; send it to the machine.\n", options->out.string(),
//                   fact("scratches", path.size()));
//       print(report);
//     });
//   }
//
// Rules for all commands:
// - A command is a thin layer: options in, library calls, files out. Reusable code belongs in a library.
// - Failed work throws burin::Error from the callback. main prints the sentence and exits with 1.
// - Commands use no file validators of CLI11. A missing file is failed work (1), not a wrong command line (2), and the
//   library's own message contains the remedy.
// - Contradictory options throw CLI::ValidationError: exit code 2.
// - A command returns or prints a Report. Its text goes to stdout; --json gives its data. The last line names the
//   result and the next command, ready to paste, with all needed options (shell_word). Capitals stand for values of the
//   user. `next` holds only commands that run as they are.
// - Diagnostics that do not stop the work go through tell() and note(), and news of work that goes on through
//   print_event() (tools/output_mode.h). A command prints nothing else, and no code reads printed text.
// - Commands write complete outputs only (write_atomically), and make folders with make_output_folder.
// - `--help` ends with a working example.
#pragma once

#include <CLI/App.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "burin/base/files/printable.h"
#include "burin/base/finding.h"
#include "tools/facts.h"
#include "tools/output_mode.h"

namespace burin {

void add_new_command(CLI::App& burin);
void add_simulate_command(CLI::App& burin);
void add_print_command(CLI::App& burin);
void add_sheet_command(CLI::App& burin);
void add_plan_command(CLI::App& burin);
void add_capture_command(CLI::App& burin);
void add_watch_command(CLI::App& burin);
void add_calibrate_command(CLI::App& burin);
void add_lens_command(CLI::App& burin);
void add_refine_command(CLI::App& burin);
void add_design_command(CLI::App& burin);
void add_render_command(CLI::App& burin);
void add_toolpath_command(CLI::App& burin);
void add_probe_command(CLI::App& burin);
void add_coupon_command(CLI::App& burin);
void add_report_command(CLI::App& burin);
void add_view_command(CLI::App& burin);
void add_loop_command(CLI::App& burin);
void add_status_command(CLI::App& burin);
void add_studio_command(CLI::App& burin);
void add_trace_command(CLI::App& burin);
void add_check_command(CLI::App& burin);
void add_wall_command(CLI::App& burin);

/// Adds --f-number: the aperture of photos without one in their EXIF data. 0: not given.
void add_f_number_option(CLI::App& command, double& f_number);

/// Type name of options with a file as value. Forwarding commands rebase these paths.
inline constexpr const char* kFile = "FILE";

/// Group of options that only `--help-all` shows.
inline constexpr const char* kSeldom = "Options that are seldom needed";

/// Adds an option for a length: a number with a unit (mm, cm, m, in, ft, um), or a bare one in `unit` ("mm", "um"),
/// which is the unit of `value`. `least`: the smallest allowed value.
CLI::Option* add_length_option(CLI::App& command, const std::string& name, double& value, const std::string& words,
                               const char* unit = "mm", double least = 0);
CLI::Option* add_length_option(CLI::App& command, const std::string& name, std::optional<double>& value,
                               const std::string& words, const char* unit = "mm", double least = 0);

/// CLI11 check of an option for a time, with any default unit. Returns an empty string for a good value.
std::string wrong_duration(const std::string& text);

/// Footer of a command's `--help`: one or several working command lines, one per line.
inline std::string example(const std::string& command_lines) { return "Example:\n  " + command_lines; }

/// Quotes as $'...' (bash, zsh, POSIX 2024) a word with control characters or invalid text.
std::string shell_word_of_bytes(const std::string& word);

/// Quotes a file name or an option's value for a command line to paste, if a shell would split it.
inline std::string shell_word(const std::string& word) {
  const bool plain = !word.empty() && word.find_first_not_of(
                                          "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                          "0123456789_-+=.,:/@%") == std::string::npos;
  if (plain) return word;
  if (!is_printable(word)) return shell_word_of_bytes(word);
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

/// Returns words as a command line to paste.
inline std::string command_text(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words) line += (line.empty() ? "" : " ") + shell_word(word);
  return line;
}

}  // namespace burin
