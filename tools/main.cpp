// The burin program: subcommands over the libraries. How a command is made stands in tools/commands.h.
#include "tools/command_line.h"

int main(int argc, char** argv) { return burin::run_program({argv + 1, argv + argc}); }
