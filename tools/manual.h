// tools/manual.h - the program's manual pages, its reference in the documents and its completion for shells, made from
// its own options.
#pragma once

#include <CLI/App.hpp>
#include <string>

namespace burin {

/// Returns the man(7) text of one command. If `command` is null, returns the page of `burin` itself: its commands,
/// their purposes, its options.
std::string manual_page(const CLI::App& burin, const CLI::App* command);

/// docs/commands.md: Markdown of all commands, by groups, with their options and examples.
std::string commands_page(const CLI::App& burin);

/// Scripts for bash, fish and zsh that complete commands, options and their fixed values, and files elsewhere.
std::string bash_completion(const CLI::App& burin);
std::string fish_completion(const CLI::App& burin);
std::string zsh_completion(const CLI::App& burin);

}  // namespace burin
