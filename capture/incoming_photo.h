// burin/capture/incoming_photo.h - a candidate photo of a session, by its header alone.
#pragma once

#include <filesystem>
#include <string>

#include "burin/capture/exif.h"

namespace burin {

/// A photo before its pixels are read.
struct IncomingPhoto {
  std::filesystem::path file;
  Exif exif;
  std::string unreadable;  ///< reason why its header could not be read; empty if it could
  std::string light;       ///< the lit lamp; empty: the caller's lamp
};

}  // namespace burin
