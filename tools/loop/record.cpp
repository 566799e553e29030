#include "tools/loop/record.h"

#include <algorithm>
#include <array>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/files/json_file.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

using Status = MadeRecord::Status;
constexpr std::array<std::pair<Status, const char*>, 5> kStatusNames{{{Status::begun, "begun"},
                                                                      {Status::interrupted, "interrupted"},
                                                                      {Status::done, "done"},
                                                                      {Status::accepted, "accepted"},
                                                                      {Status::adopted, "adopted"}}};

Json texts_json(const std::map<std::string, std::string>& texts) {
  Json json = Json::object();
  for (const auto& [name, text] : texts) json[name] = text;
  return json;
}

std::map<std::string, std::string> read_texts(JsonObject& parent, const std::string& key) {
  std::map<std::string, std::string> texts;
  if (!parent.has(key)) return texts;
  JsonObject json = parent.object(key);
  for (const std::string& name : json.keys()) texts[name] = json.text(name);
  return texts;
}

}  // namespace

const char* in_words(Status status) {
  for (const auto& [value, name] : kStatusNames)
    if (value == status) return name;
  return "";
}

std::optional<MadeRecord> read_record(const fs::path& file) {
  if (!fs::exists(file)) return std::nullopt;
  const Json json = read_json(file, "burin/made", 1);
  JsonObject object(json, file.string());
  object.has("format");
  object.has("version");
  MadeRecord record;
  record.stage = object.text("stage");
  const std::string status = object.text("status");
  const auto known =
      std::find_if(kStatusNames.begin(), kStatusNames.end(), [&](const auto& entry) { return status == entry.second; });
  if (known == kStatusNames.end())
    object.fail_field("status", "is \"" + status + "\"", "use begun, interrupted, done, accepted or adopted");
  record.status = known->first;
  record.burin = object.text("burin");
  record.options = read_texts(object, "options");
  record.inputs = read_texts(object, "inputs");
  record.outputs = read_texts(object, "outputs");
  if (object.has("kept")) {
    JsonObject kept = object.object("kept");
    record.kept = {read_texts(kept, "options"), read_texts(kept, "inputs"), read_texts(kept, "outputs")};
    kept.finish();
  }
  if (object.has("accepted_unknown"))
    for (const Json& name : object.raw("accepted_unknown")) {
      if (!name.is_string()) object.fail_field("accepted_unknown", "holds what is no text", "name parameters");
      record.accepted_unknown.push_back(name.get<std::string>());
    }
  object.finish();
  return record;
}

void write_record(const MadeRecord& record, const fs::path& file) {
  Json json;
  json["format"] = "burin/made";
  json["version"] = 1;
  json["stage"] = record.stage;
  json["status"] = in_words(record.status);
  json["burin"] = record.burin;
  json["options"] = texts_json(record.options);
  json["inputs"] = texts_json(record.inputs);
  json["outputs"] = texts_json(record.outputs);
  const MadeRecord::Kept& kept = record.kept;
  if (!kept.options.empty() || !kept.inputs.empty() || !kept.outputs.empty())
    json["kept"] = {{"options", texts_json(kept.options)},
                    {"inputs", texts_json(kept.inputs)},
                    {"outputs", texts_json(kept.outputs)}};
  if (!record.accepted_unknown.empty()) json["accepted_unknown"] = record.accepted_unknown;
  make_output_folder(file.parent_path());
  write_json(json, file);
}

std::string path_in_project(const fs::path& project, const fs::path& file) {
  const fs::path from = fs::absolute(project).lexically_normal(), to = fs::absolute(file).lexically_normal();
  // A project named "p/." or "p/" has an empty last part.
  return to.lexically_relative(from.has_filename() ? from : from.parent_path()).string();
}

}  // namespace burin
