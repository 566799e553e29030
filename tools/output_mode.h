// tools/output_mode.h - `burin --quiet COMMAND` and `burin --json COMMAND`: what a command says, for scripts and
// pipelines.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace burin {

/// What becomes of a command's words. Its files and its exit code are the same.
enum class OutputMode {
  words,  ///< as a person reads them
  quiet,  ///< notes and errors only, on stderr when it has ended, and no progress bar
  json    ///< one JSON object on stdout when it has ended, nothing else
};

/// Takes --quiet and --json out of the options before COMMAND (the last one rules).
OutputMode take_output_mode(std::vector<std::string>& arguments);

/// How many words one of the program's own options takes that `word` begins: 0 if it begins none.
std::size_t words_of_program_option(const std::string& word);

/// Where COMMAND stands among the arguments: behind the program's own options.
std::size_t place_of_command(const std::vector<std::string>& arguments);

/// Says why the command ends before its time, on the real standard streams, wherever `mode` has put them: the sentence
/// to stderr, or the JSON object to stdout. For a process that ends then.
void say_at_the_end(OutputMode mode, const std::vector<std::string>& arguments, const std::string& sentence,
                    int exit_code);

/// What `burin --json` prints in place of that object if the command ends well: one line of JSON of its own.
void set_json_result(std::string json);

/// Writes a note to the real standard error, beside whatever the command's own thread is doing.
void say_meanwhile(const std::string& sentence);

/// Does `work`, whose result is an exit code, in that mode; `arguments` are the command's, without the mode. JSON:
///   { "burin": "0.1.0", "command": "capture", "exit_code": 0, "said": [lines], "notes": [..], "errors": [..],
///     "files": [what it wrote], "next": "burin calibrate ..." }
/// where "next" is there if the command named one. Throws Error where its words cannot be caught.
int run_in_mode(OutputMode mode, const std::vector<std::string>& arguments, const std::function<int()>& work);

}  // namespace burin
