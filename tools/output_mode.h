// tools/output_mode.h - the one way of a command's words to the outside: text for people, or JSON for programs
// (docs/json.md).
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "burin/base/finding.h"
#include "burin/base/input_error.h"
#include "tools/facts.h"

namespace burin {

/// Form of a command's messages. Its files and its exit code do not depend on it.
enum class OutputMode {
  words,      ///< for people
  quiet,      ///< notes, warnings and errors only; no progress bar
  json,       ///< one JSON object on stdout at the end, nothing else
  json_lines  ///< one JSON object per line on stdout: events, progress, diagnostics, and the object of `json` last
};

/// Removes --quiet, --json and --json-lines from the options before COMMAND. The last one wins.
OutputMode take_output_mode(std::vector<std::string>& arguments);

/// Number of words of the program's own option that starts at `word`: 0 if it is no such option.
std::size_t words_of_program_option(const std::string& word);

/// Index of COMMAND among the arguments, behind the program's own options.
std::size_t place_of_command(const std::vector<std::string>& arguments);

/// Begins the output of one command line, without the mode's option.
void begin_output(OutputMode mode, const std::vector<std::string>& arguments);

/// Returns true if stdout is for people.
bool is_for_people();

/// Returns true if a person can be asked: a terminal on both sides, and words.
bool is_person_there();

/// Prints a command's result: its text, or its data at the end. Throws the report's failure.
void print(const Report& report);

/// Reports something of a command that goes on: prints `text`, or { "event": ..., data }.
void print_event(const std::string& event, const Json& data, const std::string& text);

/// Diagnostics as in the JSON object.
Json to_json(const std::vector<Finding>& findings);

/// Reports a diagnostic: to stderr under its severity, or to the JSON object.
void tell(const Finding& finding);

/// Reports a fact that needs no action: an assumed value, an unchanged file.
void note(FindingCode code, const std::string& sentence);

/// Reports the error that ends the command.
void tell_error(const InputError& error);

/// Reports progress as a line of JSON, at most ten times a second. No other mode shows it.
void tell_progress(std::string_view stage, double fraction);

/// Ends the output with the JSON object, if the mode has one. --help and --version give it `text`.
void end_output(int exit_code, const std::string& text = "");

/// Prints the reason for an early end at once, from any thread of a process that ends immediately afterwards.
void say_at_the_end(const std::string& sentence, int exit_code);

/// Writes a note to standard error while the command's own thread continues. Nothing without words.
void say_meanwhile(const std::string& sentence);

}  // namespace burin
