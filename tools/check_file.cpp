#include "tools/check_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "burin/base/files/file_names.h"
#include "burin/base/limits.h"
#include "burin/capture/session.h"
#include "burin/optimize/design_file.h"
#include "burin/optimize/machine_profile.h"
#include "burin/optimize/toolpath/height_map.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/coupon.h"
#include "burin/scene/scratches.h"
#include "burin/simulate/bench_truth.h"
#include "tools/hold_out_file.h"
#include "tools/loop/options.h"
#include "tools/loop/record.h"
#include "tools/picture_quality.h"
#include "tools/round_names.h"
#include "tools/rounds_quality.h"
#include "tools/wall/wall_file.h"
#include "tools/watch/wanted_shots.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

// A JSON text that was parsed before: only its places are unknown.
struct Walker {
  std::string_view text;
  std::size_t at = 0;

  void skip_space() {
    while (at < text.size() && std::string_view(" \t\r\n").find(text[at]) != std::string_view::npos) ++at;
  }
  char here() {
    skip_space();
    return at < text.size() ? text[at] : '\0';
  }
  std::string string() {
    std::string out;
    for (++at; at < text.size() && text[at] != '"'; ++at) {
      if (text[at] == '\\') ++at;
      out += text[std::min(at, text.size() - 1)];
    }
    ++at;
    return out;
  }
  void skip_value() {
    if (here() == '"') {
      string();
      return;
    }
    std::size_t depth = 0;
    while (at < text.size()) {
      const char c = here();
      if (c == '"') {
        string();
        continue;
      }
      if (c == '{' || c == '[') ++depth;
      if (c == '}' || c == ']') {
        if (depth == 0) return;
        if (--depth == 0) {
          ++at;
          return;
        }
      }
      if (c == ',' && depth == 0) return;
      ++at;
    }
  }
  // Goes from an object or list to one of its values. False: it has none of that name or number.
  bool enter(const std::string& step) {
    const char kind = here();
    if (kind != '{' && kind != '[') return false;
    const std::size_t begin = at++;
    for (std::size_t index = 0; here() != '}' && here() != ']' && at < text.size(); ++index) {
      std::string name = std::to_string(index);
      if (kind == '{') {
        name = string();
        if (here() == ':') ++at;
        skip_space();
      }
      if (name == step) return true;
      skip_value();
      if (here() == ',') ++at;
    }
    at = begin;
    return false;
  }
};

// "tags.list[3].size_mm" as tags, list, 3, size_mm.
std::vector<std::string> steps_of(std::string_view field) {
  std::vector<std::string> steps{""};
  for (const char c : field) {
    if (c == '.' || c == '[')
      steps.emplace_back();
    else if (c != ']')
      steps.back() += c;
  }
  return steps;
}

// Reads a file with the reader of its format.
void read_as(const std::string& format, const fs::path& file) {
  using Reader = void (*)(const fs::path&);
  static const std::pair<const char*, Reader> kReaders[] = {
      {"burin/bench", [](const fs::path& f) { read_bench(f); }},
      {"burin/board", [](const fs::path& f) { read_board(f); }},
      {"burin/coupon", [](const fs::path& f) { read_coupon(f); }},
      {"burin/design", [](const fs::path& f) { read_design(f); }},
      {"burin/design-report",
       [](const fs::path& f) {
         const Json json = read_json(f, "burin/design-report", 1);
         JsonObject report(json, f.string());
         quality_of_design(report, f);
         for (JsonObject& iteration : report.objects("history")) iteration.number("loss");
       }},
      {"burin/heights", [](const fs::path& f) { read_heights(f); }},
      {"burin/hold-out", [](const fs::path& f) { read_hold_out(f.parent_path()); }},
      {"burin/loop", [](const fs::path& f) { read_loop_options(f.parent_path()); }},
      {"burin/machine",
       [](const fs::path& f) { machine_profile(f.has_parent_path() ? f.string() : "./" + f.string()); }},
      {"burin/made", [](const fs::path& f) { read_record(f); }},
      {"burin/names", [](const fs::path& f) { read_names(f); }},
      {"burin/plan", [](const fs::path& f) { planned_shots(f, Board()); }},
      {"burin/rig-truth", [](const fs::path& f) { read_bench_truth(f); }},
      {"burin/rounds", [](const fs::path& f) { read_rounds(f); }},
      {"burin/session", [](const fs::path& f) { read_session(f); }},
      {"burin/wall", [](const fs::path& f) { read_wall(f.parent_path()); }},
  };
  std::string known;
  for (const auto& [name, read] : kReaders) {
    if (format == name) {
      read(file);
      return;
    }
    known += (known.empty() ? "" : ", ") + std::string(name);
  }
  fail_as(ErrorCode::bad_key, file.string() + ": format", "is \"" + format + "\"", "known are " + known);
}

std::string format_of(const fs::path& file, const std::string& text) {
  if (lower_extension(file) == ".toml") {
    for (const char* format : {"burin/loop", "burin/machine"})
      if (text.find('"' + std::string(format) + '"') != std::string::npos) return format;
    return "";
  }
  Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) return "burin/board";  // its reader says where the text is no JSON
  return json.is_object() && json.contains("format") && json["format"].is_string() ? json["format"].get<std::string>()
                                                                                   : "";
}

}  // namespace

TextPlace place_of_field(std::string_view json, std::string_view field) {
  Walker walker{json};
  walker.skip_space();
  for (const std::string& step : steps_of(field))
    if (!walker.enter(step)) break;
  TextPlace place;
  for (const char c : json.substr(0, walker.at)) {
    ++place.column;
    if (c == '\n') ++place.line, place.column = 1;
  }
  return place;
}

Report check_file(const fs::path& file) {
  Report report;
  const std::string extension = lower_extension(file);
  if (extension == ".csv") {
    report.line("{}: good: {} scratches\n", fact("file", file.string()),
                fact("scratches", read_scratches(file).size()));
    return report;
  }
  const std::string text = read_text(file);
  const std::string format = format_of(file, text);
  try {
    read_as(format, file);
  } catch (const InputError& error) {
    const std::string whole = file.string() + ": ";
    if (extension == ".toml" || !error.where.starts_with(whole)) throw;  // TOML's errors have their line
    const std::string field = error.where.substr(whole.size());
    const TextPlace place = place_of_field(text, field);
    report.data = {{"line", place.line}, {"column", place.column}};
    report.failure.emplace(error.code, fmt::format("{}:{}:{}: {}", file.string(), place.line, place.column, field),
                           error.problem, error.remedy);
    return report;
  }
  report.line("{}: good: {}\n", fact("file", file.string()), fact("format", format));
  return report;
}

}  // namespace burin
