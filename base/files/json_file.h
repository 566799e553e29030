// burin/base/files/json_file.h - reading Burin's JSON files strictly, and writing them
// (burin/base/files/write_file.h). Include it in .cpp files only: it pulls in nlohmann-json.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "burin/base/files/write_file.h"

namespace burin {

using Json = nlohmann::ordered_json;

/// One JSON object during reading, with its file and its path in the file. It returns typed fields and records the
/// requested keys; finish() reports unknown ones. Every error names file, field and remedy.
class JsonObject {
 public:
  JsonObject(const Json& json,
             std::string where);  ///< `where`: "board.json" or "board.json: tags". Throws for any value but an object.

  const std::string& where() const { return where_; }
  bool has(const std::string& key) const;  ///< marks the key as known

  double number(const std::string& key);  ///< at most 1e18, of either sign
  double number(const std::string& key, double fallback);
  double positive(const std::string& key);
  double positive(const std::string& key, double fallback);
  int integer(const std::string& key);
  int integer(const std::string& key, int fallback);
  bool boolean(const std::string& key);
  bool boolean(const std::string& key, bool fallback);
  std::string text(const std::string& key);
  std::string text(const std::string& key, const std::string& fallback);
  std::vector<double> numbers(const std::string& key, int count);  ///< exactly `count`, or any number if count < 0
  Eigen::Vector2d vec2(const std::string& key);
  Eigen::Vector3d vec3(const std::string& key);
  Eigen::Vector3d vec3(const std::string& key, const Eigen::Vector3d& fallback);
  Eigen::MatrixXd matrix(const std::string& key, int rows, int cols);  ///< rows as arrays
  JsonObject object(const std::string& key);
  std::vector<JsonObject> objects(const std::string& key);  ///< an array of objects
  const Json& raw(const std::string& key);                  ///< any value; throws if missing
  std::vector<std::string> keys() const;                    ///< in the file's order, for objects used as maps

  /// Throws with the first unrequested key, and with all known keys.
  void finish() const;

  /// Throws Error about one field: "board.json: tags.size_mm: what; remedy".
  [[noreturn]] void fail_field(const std::string& key, const std::string& what, const std::string& remedy) const;

 private:
  double number_in(const Json& value, const std::string& key) const;
  const Json& wanted(const std::string& key, const std::string& kind);  // throws if missing
  std::vector<std::string> all_keys() const;

  const Json* json_;
  std::string where_;
  mutable std::set<std::string> asked_;
};

/// Called with each request of a JsonObject: the object's place, a key of it, and the kind of value that the reader
/// wants: "number", "positive", "integer", "boolean", "text", "numbers 3", "matrix 4 4", "object", "objects", "any";
/// "may be missing"; without key "begin", "map" (any keys) and "finish" (no other keys).
using FieldObserver = std::function<void(const std::string& where, const std::string& key, const std::string& kind)>;

/// Sets the process' observer; none by default. For the schemas of our files (scripts/schemas); one thread only.
void observe_fields(FieldObserver observer);

/// The object's "version". Throws Error for another "format", and for a version above `version` or below `oldest` (0:
/// only `version` itself is valid).
int check_format(JsonObject object, const std::string& format, int version, int oldest = 0);

/// Parses a JSON file and checks its "format" ("burin/board") and "version" (check_format). Throws Error with line and
/// column for broken JSON. The caller keeps the Json alive while it reads the JsonObject, which has requested both keys
/// already.
Json read_json(const std::filesystem::path& file, const std::string& format, int version, int oldest = 0);

/// The whole content of a file. Throws Error if it is missing, a folder or unreadable.
std::string read_text(const std::filesystem::path& file);

/// Pretty-printed JSON, doubles with the necessary digits. Throws Error with `file`, its destination, for a non-finite
/// number or a text that is not UTF-8.
std::string json_text(const Json& json, const std::filesystem::path& file);

/// Writes json_text() (write_file).
void write_json(const Json& json, const std::filesystem::path& file);

/// Makes a folder and its parents for output. Throws Error with its name if the call fails or the folder is not
/// writable.
void make_output_folder(const std::filesystem::path& folder);

/// Converts a path in a JSON file, relative to the file's folder, into one that works from the working directory.
std::filesystem::path resolve_path(const std::filesystem::path& file, const std::string& named);

/// The inverse: the name of `path` in `file`, relative to the file's folder if possible.
std::string path_beside(const std::filesystem::path& file, const std::filesystem::path& path);

Json to_json(const Eigen::Ref<const Eigen::MatrixXd>& m);  ///< a vector as a flat array, a matrix as an array of rows

}  // namespace burin
