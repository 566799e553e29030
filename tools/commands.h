// tools/commands.h - the subcommands of `burin`, one function and one file each.
//
// How a command is made. `add_NAME_command(burin)` lives in tools/NAME_command.cpp and does three things:
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
//       print_text("Wrote {}: 40000 scratches, about 6 h 20 min; send it to the machine.\n", options->out.string());
//     });
//   }
//
// Rules that all commands keep:
// - A thin layer: options in, library calls, files out. What another program could use belongs in a library.
// - Work that cannot be done throws burin::Error from the callback; main prints the sentence and exits with 1.
//   Do not use CLI11's file validators: a missing file is work that cannot be done (1), not a wrong command line (2),
//   and the library's own message says what to do about it. Contradictory options throw CLI::ValidationError: exit 2.
// - Results go to stdout and end in one line that says what was made and what to do next: a command that can be pasted,
//   with all options that it needs (shell_word), capitals where only the person knows. Findings that do not stop
//   the work ("note: ...") go to stderr through note(). Nothing else is printed.
// - Outputs are written only when they are complete (write_atomically), folders made with make_output_folder.
// - `--help` ends with an example that works on the files it names.
#pragma once

#include <fmt/format.h>

#include <CLI/App.hpp>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "burin/base/files/printable.h"
#include "burin/base/finding.h"
#include "tools/standard_streams.h"

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
void add_trace_command(CLI::App& burin);
void add_check_command(CLI::App& burin);

/// The options of `burin design`, `burin toolpath` and `burin capture` that say how, not which files: `command` may be
/// another one that hands them on. What they are read into lives as long as what is returned.
std::shared_ptr<void> add_design_options(CLI::App& command);
std::shared_ptr<void> add_capture_options(CLI::App& command);
std::shared_ptr<void> add_toolpath_options(CLI::App& command);

/// --f-number of commands that read photos: the aperture of those whose EXIF has none. 0: not said.
void add_f_number_option(CLI::App& command, double& f_number);

/// The type_name of options that name files among these: what hands them on moves paths with them.
inline constexpr const char* kFile = "FILE";

/// CLI11's kind of check of an option that takes a time, whatever unit a bare number has: empty for a good value.
std::string wrong_duration(const std::string& text);

/// The footer of a command's `--help`: a working command line (or several, one a line).
inline std::string example(const std::string& command_lines) { return "Example:\n  " + command_lines; }

/// $'...' of bash, zsh and POSIX 2024 for a word with characters that a terminal would obey or that are no text.
std::string shell_word_of_bytes(const std::string& word);

/// A file or an option's value as it stands in a command line that can be pasted: quoted where a shell would split it.
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

/// `burin ARGUMENTS...` as a person can paste it.
inline std::string command_text(const std::vector<std::string>& arguments) {
  std::string line = "burin";
  for (const std::string& word : arguments) line += " " + shell_word(word);
  return line;
}

/// As fmt::print to stdout, but a terminal obeys nothing that stands in the name of a file or a folder.
template <typename... T>
void print_text(fmt::format_string<T...> format, T&&... values) {
  say_text(fmt::format(format, std::forward<T>(values)...));
}

/// Tells the person about something that does not stop the work: a photo left out, a value assumed. To stderr.
inline void note(const std::string& sentence) { tell("note: " + sentence + "\n"); }
inline void note(const Finding& finding) { note(sentence(finding)); }

}  // namespace burin
