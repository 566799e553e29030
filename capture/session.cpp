#include "burin/capture/session.h"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/files/input_file.h"
#include "burin/base/files/json_file.h"
#include "burin/base/limits.h"
#include "burin/scene/files/camera_effects_json.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::pair<Encoding, const char*>, 3> kEncodings{
    {{Encoding::linear, "linear"}, {Encoding::srgb, "srgb"}, {Encoding::raw, "raw"}}};

Encoding encoding_of(JsonObject& object) {
  const std::string text = object.text("encoding");
  for (const auto& [encoding, name] : kEncodings)
    if (text == name) return encoding;
  object.fail_field("encoding", "\"" + text + "\" is not known", "write \"linear\", \"srgb\" or \"raw\"");
}

}  // namespace

Session read_session(const fs::path& file) {
  const Json json = read_json(file, "burin/session", 1);
  JsonObject root(json, file.string());

  Session session;
  session.file = file;
  session.board = resolve_path(file, root.text("board"));
  std::set<fs::path> seen;
  for (JsonObject& entry : root.objects("photos")) {
    Photo photo;
    photo.file = resolve_path(file, entry.text("file")).lexically_normal();
    photo.view = entry.text("view");
    photo.light = entry.text("light", photo.light);
    photo.on_camera = entry.boolean("on_camera", false);
    photo.exposure_s = entry.positive("exposure_s");
    photo.iso = entry.positive("iso", photo.iso);
    photo.f_number = entry.positive("f_number");
    photo.encoding = encoding_of(entry);
    entry.finish();
    if (photo.view.empty()) entry.fail_field("view", "is empty", "give each place of the camera a name");
    if (photo.on_camera) photo.light = lamp_on_camera(photo.light, photo.view);
    if (!seen.insert(photo.file).second)
      entry.fail_field("file", photo.file.string() + " is listed twice", "list each photo once");
    std::error_code unknown;
    if (!fs::is_regular_file(photo.file, unknown))
      entry.fail_field("file", "there is no file " + photo.file.string(),
                       "put the photo there, or take it off the list");
    session.photos.push_back(std::move(photo));
  }
  if (root.has("response")) session.response = read_response(root.object("response"));
  if (root.has("sharpening")) session.sharpening = read_sharpening(root.object("sharpening"));
  root.finish();
  require_at_most(session.photos.size(), limit::kPhotos, file.string() + ": photos", "photos",
                  "calibrate with some of them: a few dozen from many directions are enough");
  if (session.photos.empty()) root.fail_field("photos", "the list is empty", "a session needs at least one photo");
  std::error_code unknown;
  if (!fs::is_regular_file(session.board, unknown))
    root.fail_field("board", "there is no file " + session.board.string(), "put board.json there, or correct the path");
  return session;
}

void write_session(const Session& session, const fs::path& file) {
  Json json;
  json["format"] = "burin/session";
  json["version"] = 1;
  json["board"] = path_beside(file, session.board);
  json["photos"] = Json::array();
  for (const Photo& photo : session.photos) {
    const auto* name = std::find_if(kEncodings.begin(), kEncodings.end(),
                                    [&](const auto& entry) { return entry.first == photo.encoding; });
    Json entry;
    entry["file"] = path_beside(file, photo.file);
    entry["view"] = photo.view;
    entry["light"] = photo.light;
    if (photo.on_camera) {
      entry["light"] = photo.light.substr(0, photo.light.size() - lamp_on_camera("", photo.view).size());
      entry["on_camera"] = true;
    }
    entry["exposure_s"] = photo.exposure_s;
    entry["iso"] = photo.iso;
    entry["f_number"] = photo.f_number;
    entry["encoding"] = name->second;
    json["photos"].push_back(std::move(entry));
  }
  if (session.response) json["response"] = response_json(*session.response);
  if (session.sharpening) json["sharpening"] = sharpening_json(*session.sharpening);
  write_json(json, file);
}

std::string lamp_on_camera(const std::string& lamp, const std::string& view) { return lamp + "@" + view; }

std::string photo_name(const Session& session, const Photo& photo) {
  return session.file.empty() ? photo.file.generic_string() : path_beside(session.file, photo.file);
}

Session with_camera(Session session, const Sensor& sensor) {
  for (Photo& photo : session.photos) {
    photo.response = sensor.response;
    photo.sharpening = sensor.sharpening;
    photo.green_sites = sensor.green_sites;
    const auto balance = sensor.balance.find(photo_name(session, photo));
    photo.balance = balance == sensor.balance.end() ? Eigen::Vector3d::Ones().eval() : balance->second;
  }
  return session;
}

double exposure_factor(const Photo& photo) {
  const double factor = exposure_factor(photo.exposure_s, photo.iso, photo.f_number);
  if (!(factor > 0) || !(factor < 1e12))
    fail(photo.file.string(), "exposure time, ISO and f-number give no exposure",
         "give exposure_s, iso and f_number, all above zero");
  return factor;
}

}  // namespace burin
