// Writes the manual pages, docs/commands.md and the completion into a folder, when Burin is built: burin_manual FOLDER.
#include <exception>
#include <filesystem>

#include "burin/base/files/json_file.h"
#include "tools/command_line.h"
#include "tools/commands.h"
#include "tools/manual.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "burin_manual FOLDER\n");
    return 2;
  }
  try {
    const std::filesystem::path folder = argv[1];
    burin::make_output_folder(folder);
    const auto app = burin::make_app();
    burin::write_text(burin::manual_page(*app, nullptr), folder / "burin.1");
    for (const CLI::App* command : app->get_subcommands({}))
      burin::write_text(burin::manual_page(*app, command), folder / ("burin-" + command->get_name() + ".1"));
    burin::write_text(burin::commands_page(*app), folder / "commands.md");
    burin::write_text(burin::bash_completion(*app), folder / "burin.bash");
    burin::write_text(burin::fish_completion(*app), folder / "burin.fish");
    burin::write_text(burin::zsh_completion(*app), folder / "_burin");
  } catch (const std::exception& error) {
    fmt::print(stderr, "burin_manual: {}\n", error.what());
    return 1;
  }
  return 0;
}
