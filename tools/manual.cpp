#include "tools/manual.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace burin {
namespace {

// Escapes text for roff: backslashes, hyphens in text to paste, and leading control characters of lines.
std::string roff(std::string_view text) {
  std::string out;
  bool line_begins = true;
  for (const char c : text) {
    if (line_begins && (c == '.' || c == '\'')) out += "\\&";
    line_begins = c == '\n';
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
  }
  return out;
}

// "--out FILE"; flags and positionals have no type.
std::string names_of(const CLI::Option& option) {
  const bool has_type = option.get_expected_max() != 0 && option.get_type_size() != 0 && !option.get_positional();
  const std::string type = has_type ? option.get_type_name() : "";
  return option.get_name(true, true) + (type.empty() ? "" : " " + type);
}

std::string option_item(const CLI::Option& option) {
  return fmt::format(".TP\n.B {}\n{}{}\n", roff(names_of(option)), roff(option.get_description()),
                     option.get_default_str().empty() ? "" : roff(" [" + option.get_default_str() + "]"));
}

std::string options_of(const CLI::App& app) {
  std::string out;
  for (const CLI::Option* option : app.get_options()) out += option_item(*option);
  return out;
}

// Keeps the lines of an example unchanged.
std::string examples_of(const std::string& footer) {
  const std::string_view head = "Example:\n";
  const std::string lines = footer.starts_with(head) ? footer.substr(head.size()) : footer;
  return ".SH EXAMPLE\n.nf\n" + roff(lines) + "\n.fi\n";
}

std::string positionals_of(const CLI::App& command) {
  std::string out;
  for (const CLI::Option* option : command.get_options())
    if (option->get_positional()) out += " " + option->get_name(true);
  return out;
}

std::string title(const std::string& name) {
  return fmt::format(".TH {} 1 \"\" \"burin {}\" \"User Commands\"\n", roff(name), BURIN_VERSION);
}

// ---- Markdown ----

std::string option_line(const CLI::Option& option) {
  const std::string fallback = option.get_default_str();
  return fmt::format("- `{}`: {}{}{}\n", names_of(option), option.get_description(),
                     option.get_required() ? " (required)" : "",
                     fallback.empty() ? "" : fmt::format(" [default: {}]", fallback));
}

std::string option_lines(const CLI::App& app) {
  std::string out;
  for (const CLI::Option* option : app.get_options())
    if (!option->check_lname("help")) out += option_line(*option);
  return out;
}

std::string command_section(const CLI::App& command, const std::string& name, const std::string& hashes) {
  std::string out = fmt::format("\n{} {}\n\n{}.\n", hashes, name, command.get_description());
  const auto parts = command.get_subcommands({});  // commands, and nameless groups of options
  const bool is_command =
      std::none_of(parts.begin(), parts.end(), [](const auto* p) { return !p->get_name().empty(); });
  if (is_command) out += fmt::format("\n```\n{}{} [OPTIONS]\n```\n\n", name, positionals_of(command));
  out += option_lines(command);
  for (const CLI::App* part : parts)
    if (part->get_name().empty()) out += fmt::format("\n{}:\n\n{}", part->get_description(), option_lines(*part));
  const std::string_view head = "Example:\n  ";
  if (std::string footer = command.get_footer(); footer.starts_with(head)) {
    footer.erase(0, head.size());
    for (std::size_t at; (at = footer.find("\n  ")) != std::string::npos;) footer.erase(at + 1, 2);
    out += fmt::format("\nExample:\n\n```\n{}\n```\n", footer);
  }
  for (const CLI::App* part : parts)
    if (!part->get_name().empty()) out += command_section(*part, name + " " + part->get_name(), hashes + "#");
  return out;
}

}  // namespace

std::string commands_page(const CLI::App& burin) {
  std::string out =
      "# Commands\n\nThis reference lists every command and option for those who use the command line.\n"
      "The program writes this page (`burin_manual`): edit the options' descriptions in `tools/`, not this file.\n"
      "\nEvery command accepts these options, before or after its name:\n\n";
  out += option_lines(burin);
  std::string group;
  for (const CLI::App* command : burin.get_subcommands({})) {
    if (command->get_group() != group) out += fmt::format("\n## {}\n", group = command->get_group());
    out += command_section(*command, "burin " + command->get_name(), "###");
  }
  return out;
}

std::string manual_page(const CLI::App& burin, const CLI::App* command) {
  if (command != nullptr)
    return title("burin-" + command->get_name()) +
           fmt::format(
               ".SH NAME\nburin\\-{} \\- {}\n.SH SYNOPSIS\n.B burin {}{} [OPTIONS]\n.SH OPTIONS\n{}{}"
               ".SH SEE ALSO\n.BR burin (1)\n",
               roff(command->get_name()), roff(command->get_description()), roff(command->get_name()),
               roff(positionals_of(*command)), options_of(*command), examples_of(command->get_footer()));
  std::string commands;
  for (const CLI::App* c : burin.get_subcommands({}))
    commands += fmt::format(".TP\n.BR burin\\-{} (1)\n{}\n", roff(c->get_name()), roff(c->get_description()));
  return title("burin") +
         fmt::format(
             ".SH NAME\nburin \\- design, calibrate and improve boards of scratches that show pictures\n"
             ".SH SYNOPSIS\n.B burin [OPTIONS] COMMAND ...\n.SH DESCRIPTION\n{}\n.SH COMMANDS\n{}.SH OPTIONS\n{}"
             ".SH EXIT STATUS\n0 done; 1 failed, with the reason and a fix; 2 wrong command line.\n",
             roff(burin.get_description()), commands, options_of(burin));
}

std::string bash_completion(const CLI::App& burin) {
  const auto long_names = [](const CLI::App& app) {
    std::string words;
    for (const CLI::Option* option : app.get_options())
      for (const std::string& name : option->get_lnames()) words += (words.empty() ? "--" : " --") + name;
    return words;
  };
  std::string commands, cases;
  for (const CLI::App* command : burin.get_subcommands({})) {
    commands += (commands.empty() ? "" : " ") + command->get_name();
    cases += fmt::format("    {}) words=\"{}\" ;;\n", command->get_name(), long_names(*command));
  }
  return fmt::format(
      "# bash completion for burin {}\n"
      "_burin() {{\n"
      "  local command= words= word\n"
      "  for word in \"${{COMP_WORDS[@]:1:COMP_CWORD-1}}\"; do\n"
      "    case \" {} \" in *\" $word \"*) command=$word; break ;; esac\n"
      "  done\n"
      "  case $command in\n"
      "    \"\") words=\"{} {}\" ;;\n"
      "{}"
      "  esac\n"
      "  local current=${{COMP_WORDS[COMP_CWORD]}}\n"
      "  if [[ -z $command || $current == -* ]]; then\n"
      "    COMPREPLY=($(compgen -W \"$words\" -- \"$current\"))\n"
      "  else\n"
      "    COMPREPLY=()\n"
      "  fi\n"
      "}}\n"
      "complete -o default -F _burin burin\n",
      BURIN_VERSION, commands, commands, long_names(burin), cases);
}

}  // namespace burin
