// tools/probe_light_command.h - `burin probe light`, one of the subcommands of `burin probe`.
#pragma once

#include <CLI/App.hpp>

namespace burin {

void add_probe_light(CLI::App& probe);

}  // namespace burin
