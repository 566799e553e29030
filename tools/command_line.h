// tools/command_line.h - the burin program without main(): parses and runs one command line.
#pragma once

#include <CLI/App.hpp>
#include <memory>
#include <string>
#include <vector>

namespace burin {

/// Makes the parser with all options and commands. The manual pages use it too (tools/manual.h).
std::unique_ptr<CLI::App> make_app();

/// Runs `burin ARGUMENTS...` in a program of another's, such as a test. Throws the command's error, or CLI::ParseError.
void run_command(const std::vector<std::string>& arguments);

/// Runs `burin ARGUMENTS...` and prints errors as one sentence to stderr. Returns the exit code: 0 done, 1 failed, 2
/// wrong command line.
int run_program(const std::vector<std::string>& arguments);

}  // namespace burin
