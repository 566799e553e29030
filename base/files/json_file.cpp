#include "burin/base/files/json_file.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <limits>
#include <system_error>

#include "burin/base/error.h"
#include "burin/base/files/file_error.h"
#include "burin/base/files/files_together.h"
#include "burin/base/files/input_file.h"
#include "burin/base/files/named_paths.h"
#include "burin/base/files/printable.h"
#include "burin/base/input_error.h"
#include "burin/base/limits.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

/// Description of a value for people: "is 3", "is "abc"", "is an object".
std::string described(const Json& value) {
  if (value.is_object()) return "is an object";
  if (value.is_array()) return "is an array of " + std::to_string(value.size());
  std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
  if (text.size() > 60) text = text.substr(0, 57) + "...";
  return "is " + text;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

/// Edit distance of two words: added, dropped or changed letters (Levenshtein).
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0 : 1)});
      diagonal = above;
    }
  }
  return row.back();
}

/// The known key that was probably meant: nearly the same letters, or one word within the other.
std::string near_match(const std::string& key, const std::vector<std::string>& known) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(2, key.size() / 3) + 1;
  for (const std::string& candidate : known) {
    std::size_t distance = edit_distance(key, candidate);
    if (key.size() >= 3 && candidate.size() >= 3 &&
        (candidate.find(key) != std::string::npos || key.find(candidate) != std::string::npos))
      distance = std::min<std::size_t>(distance, 2);
    if (distance < best_distance) best_distance = distance, best = candidate;
  }
  return best;
}

/// Shortens "[json.exception.parse_error.101] parse error at line 3, column 7: syntax error ..." to its useful end.
std::string without_prefix(const std::string& message) {
  const std::size_t end = message.find("] ");
  return end == std::string::npos ? message : message.substr(end + 2);
}

/// Line breaks and tabs pass, because only callers know a text's purpose (JsonObject::text rejects them).
std::string without_breaks(std::string text) {
  std::erase_if(text, [](char c) { return c == '\n' || c == '\r' || c == '\t'; });
  return text;
}

/// Checks beyond the grammar. Duplicate keys are errors, because parsers silently keep one of them. So are control
/// characters for terminals (printable.h). Nesting has a limit.
struct ContentCheck {
  std::vector<std::set<std::string>> open_objects;
  std::string duplicate, unprintable;
  int deepest = 0;

  bool operator()(int depth, Json::parse_event_t event, Json& parsed) {
    deepest = std::max(deepest, depth);
    if (depth > limit::kNesting) return false;  // dropped: no code would see its content
    if (event == Json::parse_event_t::object_start) open_objects.emplace_back();
    if (event == Json::parse_event_t::object_end && !open_objects.empty()) open_objects.pop_back();
    if ((event == Json::parse_event_t::key || event == Json::parse_event_t::value) && parsed.is_string() &&
        unprintable.empty() && !is_printable(without_breaks(parsed.get_ref<const std::string&>())))
      unprintable = parsed.get<std::string>();
    if (event == Json::parse_event_t::key && !open_objects.empty()) {
      const std::string key = parsed.get<std::string>();
      if (!open_objects.back().insert(key).second && duplicate.empty()) duplicate = key;
    }
    return true;
  }
};

FieldObserver field_observer;

void observe(const std::string& where, const std::string& key, const std::string& kind) {
  if (field_observer) field_observer(where, key, kind);
}

}  // namespace

void observe_fields(FieldObserver observer) { field_observer = std::move(observer); }

JsonObject::JsonObject(const Json& json, std::string where) : json_(&json), where_(std::move(where)) {
  if (!json.is_object()) fail_as(ErrorCode::bad_json, where_, described(json), "write an object in braces { } here");
  if (where_.find(": ") == std::string::npos) asked_ = {"format", "version"};  // a whole file: read_json checked them
  observe(where_, "", "begin");
}

void JsonObject::fail_field(const std::string& key, const std::string& what, const std::string& remedy) const {
  // "board.json" + "tags" is "board.json: tags"; deeper fields are joined by dots.
  fail_as(ErrorCode::bad_key, where_ + (where_.find(": ") == std::string::npos ? ": " : ".") + key, what, remedy);
}

bool JsonObject::has(const std::string& key) const {
  observe(where_, key, "may be missing");
  asked_.insert(key);
  return json_->contains(key);
}

const Json& JsonObject::raw(const std::string& key) { return wanted(key, "any"); }

const Json& JsonObject::wanted(const std::string& key, const std::string& kind) {
  observe(where_, key, kind);
  asked_.insert(key);
  if (!json_->contains(key)) {
    // A misspelt key appears as a missing one: the message names the unknown keys.
    std::vector<std::string> strangers;
    for (const std::string& stranger : all_keys())
      if (!asked_.contains(stranger)) strangers.push_back(stranger);
    const std::string meant = near_match(key, strangers);
    fail_field(key, "is missing",
               meant.empty() ? "add it" : "add it; was \"" + meant + "\" meant to be \"" + key + "\"?");
  }
  return (*json_)[key];
}

double JsonObject::number(const std::string& key) { return number_in(wanted(key, "number"), key); }

double JsonObject::number_in(const Json& value, const std::string& key) const {
  if (!value.is_number()) fail_field(key, described(value), "write a number");
  // Lengths, times and brightnesses of a setup are far smaller, and its square is still a single-precision number.
  constexpr double kLargest = 1e18;
  const double v = value.get<double>();
  if (!std::isfinite(v)) fail_field(key, "is not finite", "write a number");
  if (std::abs(v) > kLargest) fail_field(key, "is beyond anything that can be measured", "write a number up to 1e18");
  return v;
}

double JsonObject::number(const std::string& key, double fallback) { return has(key) ? number(key) : fallback; }

double JsonObject::positive(const std::string& key) {
  const double v = number_in(wanted(key, "positive"), key);
  if (!(v > 0)) fail_field(key, described((*json_)[key]), "write a number greater than 0");
  return v;
}

double JsonObject::positive(const std::string& key, double fallback) { return has(key) ? positive(key) : fallback; }

int JsonObject::integer(const std::string& key) {
  const double v = number_in(wanted(key, "integer"), key);
  if (v != std::floor(v) || std::abs(v) > std::numeric_limits<int>::max())
    fail_field(key, described((*json_)[key]), "write a whole number of at most 9 digits");
  return static_cast<int>(v);
}

int JsonObject::integer(const std::string& key, int fallback) { return has(key) ? integer(key) : fallback; }

bool JsonObject::boolean(const std::string& key) {
  const Json& value = wanted(key, "boolean");
  if (!value.is_boolean()) fail_field(key, described(value), "write true or false");
  return value.get<bool>();
}

bool JsonObject::boolean(const std::string& key, bool fallback) { return has(key) ? boolean(key) : fallback; }

std::string JsonObject::text(const std::string& key) {
  const Json& value = wanted(key, "text");
  if (!value.is_string()) fail_field(key, described(value), "write text in double quotes");
  if (!is_printable(value.get_ref<const std::string&>()))
    fail_field(key, "holds a control character", "write text on one line: no line breaks, no tabs, no escapes");
  return value.get<std::string>();
}

std::string JsonObject::text(const std::string& key, const std::string& fallback) {
  return has(key) ? text(key) : fallback;
}

std::vector<double> JsonObject::numbers(const std::string& key, int count) {
  const Json& value = wanted(key, "numbers " + std::to_string(count));
  const std::string expected =
      count < 0 ? "write an array of numbers" : "write an array of " + std::to_string(count) + " numbers";
  if (!value.is_array() || (count >= 0 && value.size() != static_cast<std::size_t>(count)))
    fail_field(key, described(value), expected);
  std::vector<double> v;
  v.reserve(value.size());
  for (std::size_t i = 0; i < value.size(); ++i) {
    v.push_back(number_in(value[i], key + "[" + std::to_string(i) + "]"));
  }
  return v;
}

Eigen::Vector2d JsonObject::vec2(const std::string& key) {
  const std::vector<double> v = numbers(key, 2);
  return {v[0], v[1]};
}

Eigen::Vector3d JsonObject::vec3(const std::string& key) {
  const std::vector<double> v = numbers(key, 3);
  return {v[0], v[1], v[2]};
}

Eigen::Vector3d JsonObject::vec3(const std::string& key, const Eigen::Vector3d& fallback) {
  return has(key) ? vec3(key) : fallback;
}

Eigen::MatrixXd JsonObject::matrix(const std::string& key, int rows, int cols) {
  const Json& value = wanted(key, "matrix " + std::to_string(rows) + " " + std::to_string(cols));
  const std::string expected =
      "write " + std::to_string(rows) + " rows of " + std::to_string(cols) + " numbers, each row an array";
  if (!value.is_array() || value.size() != static_cast<std::size_t>(rows)) fail_field(key, described(value), expected);
  Eigen::MatrixXd m(rows, cols);
  for (int r = 0; r < rows; ++r) {
    const Json& row = value[r];
    const std::string row_key = key + "[" + std::to_string(r) + "]";
    if (!row.is_array() || row.size() != static_cast<std::size_t>(cols)) fail_field(row_key, described(row), expected);
    for (int c = 0; c < cols; ++c) {
      m(r, c) = number_in(row[c], row_key + "[" + std::to_string(c) + "]");
    }
  }
  return m;
}

JsonObject JsonObject::object(const std::string& key) {
  const Json& value = wanted(key, "object");
  return {value, where_ + (where_.find(": ") == std::string::npos ? ": " : ".") + key};
}

std::vector<JsonObject> JsonObject::objects(const std::string& key) {
  const Json& value = wanted(key, "objects");
  if (!value.is_array()) fail_field(key, described(value), "write an array of objects");
  const std::string place = where_ + (where_.find(": ") == std::string::npos ? ": " : ".") + key;
  std::vector<JsonObject> list;
  list.reserve(value.size());
  for (std::size_t i = 0; i < value.size(); ++i) list.emplace_back(value[i], place + "[" + std::to_string(i) + "]");
  return list;
}

std::vector<std::string> JsonObject::keys() const {
  observe(where_, "", "map");
  return all_keys();
}

std::vector<std::string> JsonObject::all_keys() const {
  std::vector<std::string> list;
  for (const auto& item : json_->items()) list.push_back(item.key());
  return list;
}

void JsonObject::finish() const {
  observe(where_, "", "finish");
  const std::vector<std::string> known(asked_.begin(), asked_.end());
  for (const std::string& key : all_keys()) {
    if (asked_.contains(key)) continue;
    const std::string meant = near_match(key, known);
    fail_field(key, "unknown key",
               (meant.empty() ? "remove it" : "did you mean \"" + meant + "\"?") +
                   (known.empty() ? "" : " (known here: " + joined(known) + ")"));
  }
}

std::string read_text(const std::filesystem::path& file) {
  return read_bytes(file, limit::kGcodeBytes, "a file of text");
}

int check_format(JsonObject object, const std::string& format, int version, int oldest) {
  const std::string found = object.text("format");
  if (found != format)
    object.fail_field("format", "is \"" + found + "\"", "a file with \"" + format + "\" is needed here");
  const int found_version = object.integer("version");
  const bool several = oldest > 0 && oldest < version;
  if (found_version > version || found_version < (several ? oldest : version))
    object.fail_field("version", "is " + std::to_string(found_version),
                      several ? "this Burin reads versions " + std::to_string(oldest) + " to " + std::to_string(version)
                              : "this Burin reads version " + std::to_string(version));
  return found_version;
}

Json read_json(const std::filesystem::path& file, const std::string& format, int version, int oldest) {
  const std::string text = read_bytes(file, limit::kJsonBytes, "a JSON file");
  Json json;
  ContentCheck check;
  try {
    json = Json::parse(text, std::ref(check));
  } catch (const Json::exception& e) {
    fail_as(ErrorCode::bad_json, file.string(), "is not JSON: " + without_prefix(e.what()),
            "correct it there (JSON has no comments, no trailing commas, no NaN, and text in double quotes)");
  }
  if (check.deepest > limit::kNesting)
    fail_as(ErrorCode::bad_json, file.string(),
            "has brackets within brackets, deeper than " + std::to_string(limit::kNesting),
            "check that it is the right file");
  if (!check.unprintable.empty())
    fail_as(ErrorCode::bad_json, file.string(),
            "holds a control character, in \"" + check.unprintable.substr(0, 60) + "\"",
            "write text that can be read: no escapes, no line breaks, no zero bytes");
  if (!check.duplicate.empty())
    fail_as(ErrorCode::bad_key, file.string() + ": " + check.duplicate, "the key appears twice in one object",
            "keep one of them");

  check_format(JsonObject(json, file.string()), format, version, oldest);
  return json;
}

std::string json_text(const Json& json, const std::filesystem::path& file) {
  // One number per line would make matrices unreadable: short arrays without objects go on one line.
  const std::function<std::string(const Json&, int)> pretty = [&](const Json& value, int indent) -> std::string {
    const auto has_object = [](const Json& v) {
      return std::any_of(v.begin(), v.end(), [](const Json& e) {
        return e.is_object() ||
               (e.is_array() && std::any_of(e.begin(), e.end(), [](const Json& x) { return x.is_structured(); }));
      });
    };
    const std::string inner(static_cast<std::size_t>(indent) + 2, ' '), outer(static_cast<std::size_t>(indent), ' ');
    if (value.is_object() && !value.empty()) {
      std::string text = "{\n";
      std::size_t left = value.size();
      for (const auto& item : value.items())
        text += inner + Json(item.key()).dump() + ": " + pretty(item.value(), indent + 2) + (--left ? ",\n" : "\n");
      return text + outer + "}";
    }
    if (value.is_array() && !value.empty()) {
      const bool lines = has_object(value);
      std::string text = lines ? "[\n" : "[";
      for (std::size_t i = 0; i < value.size(); ++i)
        text += (lines ? inner : "") + pretty(value[i], indent + 2) +
                (i + 1 < value.size() ? (lines ? "," : ", ") : "") + (lines ? "\n" : "");
      return text + (lines ? outer : "") + "]";
    }
    if (value.is_number_float() && !std::isfinite(value.get<double>()))
      fail(file.string(), "a value to be written is not a finite number", "this is a fault of the calculation before");
    return value.dump();
  };
  try {
    return pretty(json, 0) + "\n";
  } catch (const Json::type_error& e) {
    fail(file.string(), "cannot hold a name or a text that is not UTF-8: " + without_prefix(e.what()),
         "give the photos, pictures and folders names in UTF-8 (convmv renames them), or in plain letters");
  }
}

void write_json(const Json& json, const std::filesystem::path& file) { write_text(json_text(json, file), file); }

void make_output_folder(const std::filesystem::path& folder) {
  fail_unless_name(folder / "x");
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error))
    fail(folder.string(), "is a file, not a folder", "choose another name for the output folder");
  error.clear();
  const fs::path real = fs::weakly_canonical(folder, error);
  if (!error) fail_if_led_outside(folder, real);
  fs::create_directories(folder, error);
  std::error_code unknown;
  if (!fs::is_directory(folder, unknown)) fail_with(folder, "the folder cannot be made", error.value());
  if (::access(folder.c_str(), W_OK | X_OK) != 0) fail_with(folder, "the folder is not writable", errno);
}

std::filesystem::path resolve_path(const std::filesystem::path& file, const std::string& named) {
  return (file.parent_path() / named).lexically_normal();  // `/` keeps an absolute path unchanged
}

std::string path_beside(const std::filesystem::path& file, const std::filesystem::path& path) {
  const fs::path folder = fs::absolute(file).lexically_normal().parent_path();
  const fs::path relative = fs::absolute(path).lexically_normal().lexically_relative(folder);
  return relative.empty() ? path.string() : relative.generic_string();
}

Json to_json(const Eigen::Ref<const Eigen::MatrixXd>& m) {
  Json json = Json::array();
  if (m.cols() == 1) {
    for (Eigen::Index r = 0; r < m.rows(); ++r) json.push_back(m(r, 0));
  } else {
    for (Eigen::Index r = 0; r < m.rows(); ++r) {
      Json row = Json::array();
      for (Eigen::Index c = 0; c < m.cols(); ++c) row.push_back(m(r, c));
      json.push_back(row);
    }
  }
  return json;
}

}  // namespace burin
