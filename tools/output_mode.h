// tools/output_mode.h - `burin --quiet COMMAND` and `burin --json COMMAND`: output for scripts and pipelines.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace burin {

/// Form of a command's messages. Its files and its exit code do not depend on it.
enum class OutputMode {
  words,  ///< for people
  quiet,  ///< notes, warnings and errors only, on stderr at the end; no progress bar
  json    ///< one JSON object on stdout at the end, nothing else
};

/// Removes --quiet and --json from the options before COMMAND. The last one wins.
OutputMode take_output_mode(std::vector<std::string>& arguments);

/// Number of words of the program's own option that starts at `word`: 0 if it is no such option.
std::size_t words_of_program_option(const std::string& word);

/// Index of COMMAND among the arguments, behind the program's own options.
std::size_t place_of_command(const std::vector<std::string>& arguments);

/// Prints the reason for an early end to the real standard streams, for any redirection by `mode`. The sentence goes to
/// stderr, or the JSON object to stdout. For a process that ends immediately afterwards.
void say_at_the_end(OutputMode mode, const std::vector<std::string>& arguments, const std::string& sentence,
                    int exit_code);

/// Replaces the JSON object of a successful `burin --json` by another line of JSON.
void set_json_result(std::string json);

/// Writes a note to the real standard error while the command's own thread continues.
void say_meanwhile(const std::string& sentence);

/// Runs `work`, which returns an exit code, in the given mode. `arguments` are the command's, without the mode. The
/// JSON object:
///   { "burin": "0.1.0", "command": "capture", "exit_code": 0, "said": [lines], "notes": [..], "warnings": [..],
///     "errors": [..], "files": [written files], "next": "burin calibrate ..." }
/// "next" exists if the command names a next command. Throws Error if the output cannot be captured.
int run_in_mode(OutputMode mode, const std::vector<std::string>& arguments, const std::function<int()>& work);

}  // namespace burin
