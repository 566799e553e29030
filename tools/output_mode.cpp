#include "tools/output_mode.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <utility>

#include "burin/base/files/named_paths.h"
#include "tools/standard_streams.h"
#include "tools/version.h"

namespace burin {
namespace {

// What the process has said so far; the standard streams are the process's, too.
struct Said {
  OutputMode mode = OutputMode::words;
  std::string command;
  Json data = Json::object(), diagnostics = Json::array(), next = Json::array();
  std::string last_stage;
  std::chrono::steady_clock::time_point last_progress;
} said;

void write_whole(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t n = ::write(descriptor, text.data(), text.size());
    if (n <= 0) return;
    text.remove_prefix(static_cast<std::size_t>(n));
  }
}

std::string dumped(const Json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

bool is_json() { return said.mode == OutputMode::json || said.mode == OutputMode::json_lines; }

void print_json_line(const Json& json) {
  say_text(dumped(json, -1) + "\n");
  std::fflush(stdout);
}

void add_diagnostic(const Json& diagnostic) {
  said.diagnostics.push_back(diagnostic);
  if (said.mode != OutputMode::json_lines) return;
  Json line{{"event", "diagnostic"}};
  line.update(diagnostic);
  print_json_line(line);
}

Json diagnostic_json(const Finding& finding) {
  Json json{{"severity", in_words(finding.severity)}, {"code", name_of(finding.code)}};
  if (!finding.file.empty()) json["file"] = finding.file.string();
  if (!finding.field.empty()) json["field"] = finding.field;
  json["message"] = finding.what;
  if (!finding.remedy.empty()) json["remedy"] = finding.remedy;
  return json;
}

// "board.json: tags.list[3].size_mm" is a file and a field in it, "--lamp" a field of the command line.
Json diagnostic_json(const InputError& error) {
  Json json{{"severity", "error"}, {"code", name_of(error.code)}};
  const std::size_t colon = error.where.find(": ");
  const std::string first = error.where.substr(0, colon);
  const std::filesystem::path path(first);
  std::error_code ignored;
  if (!first.starts_with("-") &&
      (path.has_extension() || path.has_parent_path() || std::filesystem::exists(path, ignored)))
    json["file"] = first;
  else if (!first.empty())
    json["field"] = first;
  if (colon != std::string::npos) json["field"] = error.where.substr(colon + 2);
  json["message"] = error.problem;
  if (!error.remedy.empty()) json["remedy"] = error.remedy;
  return json;
}

Json result_json(int exit_code, const Json& diagnostics) {
  Json json{{"format", "burin/result"}, {"version", 2}, {"burin", version()}};
  if (!said.command.empty()) json["command"] = said.command;
  json["exit_code"] = exit_code;
  json["data"] = said.data;
  json["diagnostics"] = diagnostics;
  json["files"] = Json::array();
  for (const std::filesystem::path& file : written_files()) json["files"].push_back(file.string());
  json["next"] = said.next;
  return json;
}

std::string result_text(const Json& result) {
  if (said.mode == OutputMode::json) return dumped(result, 1) + "\n";
  Json line{{"event", "result"}};
  line.update(result);
  return dumped(line, -1) + "\n";
}

}  // namespace

std::size_t words_of_program_option(const std::string& word) {
  for (const char* flag : {"--json", "--json-lines", "--quiet", "--version", "--help-all"})
    if (word == flag) return 1;
  for (const std::string name : {"--threads", "--simd"})
    if (word == name || word.starts_with(name + "=")) return word == name ? 2 : 1;
  return 0;
}

std::size_t place_of_command(const std::vector<std::string>& arguments) {
  std::size_t at = 0;
  while (at < arguments.size() && arguments[at].starts_with("--"))
    at += std::max<std::size_t>(1, words_of_program_option(arguments[at]));
  return at;
}

OutputMode take_output_mode(std::vector<std::string>& arguments) {
  OutputMode mode = OutputMode::words;
  for (std::size_t i = 0; i < arguments.size() && arguments[i].starts_with("--");) {
    const std::string& word = arguments[i];
    if (word == "--json" || word == "--json-lines" || word == "--quiet") {
      mode = word == "--json" ? OutputMode::json : word == "--quiet" ? OutputMode::quiet : OutputMode::json_lines;
      arguments.erase(arguments.begin() + static_cast<std::ptrdiff_t>(i));
    } else {
      i += std::max<std::size_t>(1, words_of_program_option(word));
    }
  }
  return mode;
}

void begin_output(OutputMode mode, const std::vector<std::string>& arguments) {
  said = {};
  said.mode = mode;
  if (const std::size_t at = place_of_command(arguments); at < arguments.size()) said.command = arguments[at];
  const bool goes_on = said.command == "watch" || said.command == "studio";
  if (mode == OutputMode::json && goes_on) said.mode = OutputMode::json_lines;
}

Json to_json(const std::vector<Finding>& findings) {
  Json list = Json::array();
  for (const Finding& finding : findings) list.push_back(diagnostic_json(finding));
  return list;
}

bool is_for_people() { return said.mode == OutputMode::words; }

bool is_person_there() { return is_for_people() && isatty(STDIN_FILENO) == 1 && isatty(STDOUT_FILENO) == 1; }

void print(const Report& report) {
  if (is_for_people()) say_text(report.text);
  said.data.update(report.data);
  for (const std::vector<std::string>& words : report.next) said.next.push_back(words);
  if (!report.failure) return;
  std::fflush(stdout);
  throw InputError(*report.failure);
}

void print_event(const std::string& event, const Json& data, const std::string& text) {
  if (is_for_people()) {
    say_text(text);
    std::fflush(stdout);
  }
  if (!is_json()) return;
  Json line{{"event", event}};
  if (data.is_object()) line.update(data);
  if (said.mode == OutputMode::json)
    said.data["events"].push_back(line);
  else
    print_json_line(line);
}

void tell(const Finding& finding) {
  if (is_json())
    add_diagnostic(diagnostic_json(finding));
  else
    tell(std::string(in_words(finding.severity)) + ": " + sentence(finding) + "\n");
}

void note(FindingCode code, const std::string& sentence) { tell(make_note(code, sentence)); }

void tell_error(const InputError& error) {
  if (is_json())
    add_diagnostic(diagnostic_json(error));
  else
    tell(fmt::format("burin: {}\n", error.what()));
}

void tell_progress(std::string_view stage, double fraction) {
  if (said.mode != OutputMode::json_lines) return;
  const auto now = std::chrono::steady_clock::now();
  if (stage == said.last_stage && now - said.last_progress < std::chrono::milliseconds(100)) return;
  said.last_stage = stage;
  said.last_progress = now;
  print_json_line({{"event", "progress"}, {"stage", stage}, {"fraction", fraction}});
}

void end_output(int exit_code, const std::string& text) {
  if (!is_json()) {
    say_text(text);
    return;
  }
  if (!text.empty()) said.data["text"] = text;
  say_text(result_text(result_json(exit_code, said.diagnostics)));
}

void say_at_the_end(const std::string& sentence, int exit_code) {
  if (is_json()) {
    const Json stopped = diagnostic_json(InputError(ErrorCode::stopped, "", sentence, ""));
    write_whole(STDOUT_FILENO, result_text(result_json(exit_code, Json::array({stopped}))));
    return;
  }
  if (isatty(STDERR_FILENO) == 1) write_whole(STDERR_FILENO, "\r\x1b[K");  // clears a progress bar
  write_whole(STDERR_FILENO, "burin: " + sentence + "\n");
}

void say_meanwhile(const std::string& sentence) {
  if (!is_for_people()) return;
  write_whole(STDERR_FILENO, (isatty(STDERR_FILENO) == 1 ? "\r\x1b[K" : "") + ("note: " + sentence + "\n"));
}

}  // namespace burin
