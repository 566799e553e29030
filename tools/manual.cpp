#include "tools/manual.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <string_view>
#include <vector>

#include "burin/optimize/machine_profile.h"
#include "tools/version.h"

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
  return fmt::format(".TH {} 1 \"\" \"burin {}\" \"User Commands\"\n", roff(name), version());
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

namespace {

// The values of an option with a fixed set of them. CLI11 keeps the set as a part of its type: "TEXT:{keep,short}".
// A machine may also be a file.
std::vector<std::string> values_of(const CLI::Option& option) {
  std::string type = option.get_type_name();
  if (option.get_lnames().front() == "machine") {
    type = "{" + built_in_machines() + "}";
    for (const char* between : {", ", " or "})
      for (std::size_t at; (at = type.find(between)) != std::string::npos;)
        type.replace(at, std::string_view(between).size(), ",");
  }
  const std::size_t from = type.find('{'), to = type.find('}', from == std::string::npos ? 0 : from);
  if (from == std::string::npos || to == std::string::npos) return {};
  std::vector<std::string> values{""};
  for (const char c : type.substr(from + 1, to - from - 1))
    if (c == ',')
      values.emplace_back();
    else
      values.back() += c;
  return values;
}

std::vector<const CLI::Option*> long_options(const CLI::App& app) {
  std::vector<const CLI::Option*> out;
  for (const CLI::Option* option : app.get_options())
    if (!option->get_lnames().empty()) out.push_back(option);
  for (const CLI::App* part : app.get_subcommands({}))  // nameless groups of options
    if (part->get_name().empty())
      for (const CLI::Option* option : long_options(*part)) out.push_back(option);
  return out;
}

bool or_file(const CLI::Option& option) { return option.get_lnames().front() == "machine"; }

// The commands with their path: "check", "check carve".
void walk(const CLI::App& app, const std::string& path,
          const std::function<void(const std::string&, const CLI::App&)>& visit) {
  for (const CLI::App* command : app.get_subcommands({})) {
    if (command->get_name().empty()) continue;
    const std::string name = path.empty() ? command->get_name() : path + " " + command->get_name();
    visit(name, *command);
    walk(*command, name, visit);
  }
}

std::string names_below(const CLI::App& app) {
  std::string names;
  for (const CLI::App* command : app.get_subcommands({}))
    if (!command->get_name().empty()) names += (names.empty() ? "" : " ") + command->get_name();
  return names;
}

std::string words_for(const CLI::App& app) {
  std::string words = names_below(app);
  for (const CLI::Option* option : long_options(app))
    for (const std::string& name : option->get_lnames()) words += (words.empty() ? "--" : " --") + name;
  return words;
}

std::string quoted_for_shell(std::string text) {
  for (std::size_t at = 0; (at = text.find('\'', at)) != std::string::npos; at += 4) text.replace(at, 1, "'\\''");
  return "'" + text + "'";
}

}  // namespace

std::string bash_completion(const CLI::App& burin) {
  std::string cases, values;
  walk(burin, "", [&](const std::string& name, const CLI::App& command) {
    cases += fmt::format("    \"{}\") words=\"{}\" ;;\n", name, words_for(command));
    for (const CLI::Option* option : long_options(command))
      if (const auto of = values_of(*option); !of.empty())
        values += fmt::format("    \"{} --{}\") COMPREPLY=($(compgen{} -W \"{}\" -- \"$current\")); return ;;\n", name,
                              option->get_lnames().front(), or_file(*option) ? " -f" : "", fmt::join(of, " "));
  });
  return fmt::format(
      "# bash completion for burin\n"
      "_burin() {{\n"
      "  local command= words= word last= current=${{COMP_WORDS[COMP_CWORD]}}\n"
      "  for word in \"${{COMP_WORDS[@]:1:COMP_CWORD-1}}\"; do\n"
      "    last=$word\n"
      "    case \"$command $word\" in{}) command=\"${{command:+$command }}$word\" ;; esac\n"
      "  done\n"
      "  case \"$command $last\" in\n"
      "{}"
      "  esac\n"
      "  case $command in\n"
      "    \"\") words=\"{} help\"; [[ \" ${{COMP_WORDS[*]:1:COMP_CWORD-1}} \" != *\" help \"* ]] || words=\"{} all\" "
      ";;\n"
      "{}"
      "  esac\n"
      "  if [[ $current == -* || -z $command || \" $words\" != \" -\"* ]]; then\n"
      "    COMPREPLY=($(compgen -W \"$words\" -- \"$current\"))\n"
      "  else\n"
      "    COMPREPLY=()\n"
      "  fi\n"
      "}}\n"
      "complete -o default -F _burin burin\n",
      [&] {
        std::string patterns;
        walk(burin, "", [&](const std::string& name, const CLI::App&) {
          const std::size_t space = name.rfind(' ');
          const std::string way = space == std::string::npos ? " " + name : name;
          patterns += (patterns.empty() ? " \"" : " | \"") + way + "\"";
        });
        return patterns;
      }(),
      values, words_for(burin), names_below(burin), cases);
}

std::string fish_completion(const CLI::App& burin) {
  std::string out = "# fish completion for burin\n";
  for (const CLI::App* command : burin.get_subcommands({}))
    out += fmt::format("complete -c burin -n __fish_use_subcommand -a {} -d {}\n", command->get_name(),
                       quoted_for_shell(command->get_description()));
  out += fmt::format(
      "complete -c burin -n __fish_use_subcommand -a help -d 'Print the options of a command, and an example'\n"
      "complete -c burin -f -n '__fish_seen_subcommand_from help' -a 'all {}'\n",
      names_below(burin));
  const auto add = [&](const CLI::App& app, const std::string& condition) {
    for (const CLI::Option* option : long_options(app)) {
      const auto values = values_of(*option);
      out += fmt::format(
          "complete -c burin{} -l {}{}{} -d {}\n", condition, option->get_lnames().front(),
          option->get_items_expected_max() == 0 ? "" : " -r",
          values.empty() ? "" : fmt::format("{} -a '{}'", or_file(*option) ? "" : " -f", fmt::join(values, " ")),
          quoted_for_shell(option->get_description()));
    }
  };
  add(burin, "");
  walk(burin, "", [&](const std::string& name, const CLI::App& command) {
    std::string condition = " -n '";
    std::size_t from = 0;
    for (std::size_t space; (space = name.find(' ', from)) != std::string::npos; from = space + 1)
      condition += "__fish_seen_subcommand_from " + name.substr(from, space - from) + "; and ";
    condition += "__fish_seen_subcommand_from " + name.substr(from) + "'";
    for (const CLI::App* below : command.get_subcommands({}))
      if (!below->get_name().empty())
        out += fmt::format("complete -c burin{} -a {} -d {}\n", condition, below->get_name(),
                           quoted_for_shell(below->get_description()));
    add(command, condition);
  });
  return out;
}

// An action of zsh's _arguments, which splits at bare colons.
std::string words_or_files(const std::string& words) {
  return fmt::format(R"({{_alternative "words\:word\:{}" "files\:file\:_files"}})", words);
}

std::string zsh_completion(const CLI::App& burin) {
  // Brackets and colons end a description there.
  const auto plain = [](std::string text) {
    for (char& c : text)
      if (c == '[' || c == ']' || c == ':') c = c == '[' ? '(' : c == ']' ? ')' : ',';
    return text;
  };
  const auto arguments = [&](const CLI::App& app) {
    std::string out;
    for (const CLI::Option* option : long_options(app)) {
      std::string spec = fmt::format("--{}[{}]", option->get_lnames().front(), plain(option->get_description()));
      if (option->get_items_expected_max() != 0) {
        const auto values = values_of(*option);
        const std::string words = fmt::format("({})", fmt::join(values, " "));
        spec += values.empty()     ? ":value:_files"
                : or_file(*option) ? ":value:" + words_or_files(words)
                                   : ":value:" + words;
      }
      out += " \\\n      " + quoted_for_shell((option->get_items_expected_max() == 0 ? "" : "*") + spec);
    }
    return out;
  };
  std::string cases, commands;
  for (const CLI::App* command : burin.get_subcommands({}))
    commands += " " + quoted_for_shell(command->get_name() + ":" + plain(command->get_description()));
  commands += " 'help:Print the options of a command, and an example'";
  walk(burin, "", [&](const std::string& name, const CLI::App& command) {
    const std::string below = names_below(command);
    cases += fmt::format("    {}) _arguments{}{} '*:file:_files' ;;\n", quoted_for_shell(name), arguments(command),
                         below.empty() ? ""
                                       : fmt::format(" \\\n      '2:command:{}'",
                                                     words_or_files("(" + below + ")")));  // 1: the command above
  });
  return fmt::format(
      "#compdef burin\n"
      "_burin() {{\n"
      "  local command= word last=\n"
      "  local -a commands\n"
      "  commands=({})\n"
      "  for word in ${{words[2,CURRENT-1]}}; do\n"
      "    [[ $word == -* ]] && continue\n"
      "    case \"$command $word\" in{}) command=\"${{command:+$command }}$word\" ;; esac\n"
      "  done\n"
      "  case $command in\n"
      "    help) compadd all {} ;;\n"
      "    '') _describe command commands; _arguments{} ;;\n"
      "{}"
      "  esac\n"
      "}}\n"
      "_burin \"$@\"\n",
      commands,
      [&] {
        std::string patterns = " \" help\"";
        walk(burin, "", [&](const std::string& name, const CLI::App&) {
          const std::size_t space = name.rfind(' ');
          patterns += (patterns.empty() ? " \"" : "|\"") + (space == std::string::npos ? " " + name : name) + "\"";
        });
        return patterns;
      }(),
      names_below(burin), arguments(burin), cases);
}

}  // namespace burin
