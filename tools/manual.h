// tools/manual.h - the program's manual pages, its reference in the documents and its completion for bash, made from
// its own options.
#pragma once

#include <CLI/App.hpp>
#include <string>

namespace burin {

/// man(7) text of `burin` itself (`command` null: its commands, what they do, its options) or of one of its commands.
std::string manual_page(const CLI::App& burin, const CLI::App* command);

/// docs/commands.md: Markdown of all commands, by groups, with their options and examples.
std::string commands_page(const CLI::App& burin);

/// A bash script that completes commands and options, and files elsewhere.
std::string bash_completion(const CLI::App& burin);

}  // namespace burin
