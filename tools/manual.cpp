#include "tools/manual.h"

#include <fmt/format.h>

#include <string_view>

namespace burin {
namespace {

// Text as roff takes it: backslashes and hyphens that are to be pasted, and lines that begin with a control character.
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

std::string option_item(const CLI::Option& option) {
  std::string names = option.get_name(true, true), type = option.get_type_name();
  if (option.get_expected_max() == 0 || option.get_type_size() == 0) type.clear();
  return fmt::format(".TP\n.B {}{}\n{}{}\n", roff(names),
                     type.empty() || option.get_positional() ? "" : " " + roff(type), roff(option.get_description()),
                     option.get_default_str().empty() ? "" : roff(" [" + option.get_default_str() + "]"));
}

std::string options_of(const CLI::App& app) {
  std::string out;
  for (const CLI::Option* option : app.get_options()) out += option_item(*option);
  return out;
}

// The lines of an example stand as they are.
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

}  // namespace

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
             ".SH NAME\nburin \\- pictures into scratches on metal, and photographs into better scratches\n"
             ".SH SYNOPSIS\n.B burin [OPTIONS] COMMAND ...\n.SH DESCRIPTION\n{}\n.SH COMMANDS\n{}.SH OPTIONS\n{}"
             ".SH EXIT STATUS\n0 done; 1 could not be done, one sentence says why and what to do; 2 the command "
             "line is wrong.\n",
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
