// tools/command_line.h - the burin program without main(): one command line, carried out.
#pragma once

#include <CLI/App.hpp>
#include <memory>
#include <string>
#include <vector>

namespace burin {

/// The program's options and commands, for who parses or describes them (tools/manual.h).
std::unique_ptr<CLI::App> make_app();

/// Runs `burin ARGUMENTS...`, as main does and as the loop does for its steps. Throws burin::Error for work that could
/// not be done and CLI::ParseError (see CLI11) for a command line that is wrong, or that asked for help.
void run_command(const std::vector<std::string>& arguments);

/// The same, errors printed as one sentence on stderr. Returns the exit code: 0 done, 1 could not be done, 2 the
/// command line is wrong.
int run_program(const std::vector<std::string>& arguments);

}  // namespace burin
