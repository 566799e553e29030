// burin/capture/session.h - a session: photos of one board, which view and lamp each shows, and how it was exposed.
// docs/file-formats.md, `session.json`.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "burin/render/sensor.h"

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
};

/// Photos of one bench (`session.json`).
struct Session {
  std::filesystem::path file;   ///< where it was read from; empty if it was not
  std::filesystem::path board;  ///< board.json
  std::vector<Photo> photos;
};

/// Reads `session.json`. Throws Error on anything missing, unknown or out of range, photos that do not exist included.
Session read_session(const std::filesystem::path& file);

/// Writes `session.json`, paths relative to its folder; atomically.
void write_session(const Session& session, const std::filesystem::path& file);

/// exposure_factor() of the photo's settings. Throws Error naming the photo where they give none.
double exposure_factor(const Photo& photo);

}  // namespace burin
