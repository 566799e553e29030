// burin/capture/session.h - a session: photos of one board, each with its view, lamp and exposure.
// docs/file-formats.md, `session.json`.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "burin/scene/sensor.h"

namespace burin {

/// One photo of a session.
struct Photo {
  std::filesystem::path file;  ///< absolute or relative to the working directory
  std::string view;            ///< photos of one view share a camera pose
  std::string light = "lamp";
  double exposure_s = 0;
  double iso = 100;
  double f_number = 0;
  Encoding encoding = Encoding::linear;
  /// Camera effects of its stored values, apart from the encoding (with_camera() copies them from a bench).
  Response response;
  Sharpening sharpening;
  Eigen::Vector3d balance{1, 1, 1};  ///< factors on R, G, B to divide out
  GreenSites green_sites = GreenSites::unknown;
  bool on_camera = false;  ///< the lamp rides on the camera: `light` is its name at this view (lamp_on_camera)
};

/// Photos of one bench (`session.json`).
struct Session {
  std::filesystem::path file;   ///< source file; empty if there is none
  std::filesystem::path board;  ///< board.json
  std::vector<Photo> photos;
  std::optional<Response> response;      ///< of all its photos, if known; "none" also means sRGB alone
  std::optional<Sharpening> sharpening;  ///< of all its photos, if known
};

/// The name of an on-camera lamp, such as a phone's torch, at a view: "torch@v03". The lamp moves with the camera, so
/// each view has another lamp.
std::string lamp_on_camera(const std::string& lamp, const std::string& view);

/// Reads `session.json`. Throws Error on anything missing, unknown or out of range, missing photos included.
Session read_session(const std::filesystem::path& file);

/// Writes `session.json`, paths relative to its folder; atomically.
void write_session(const Session& session, const std::filesystem::path& file);

/// The name of a photo in a bench's balances: its path from the session's folder.
std::string photo_name(const Session& session, const Photo& photo);

/// The session with the camera effects of a measured bench: response, sharpening and balance.
Session with_camera(Session session, const Sensor& sensor);

/// exposure_factor() of the photo's settings. Throws Error naming the photo if they give none.
double exposure_factor(const Photo& photo);

}  // namespace burin
