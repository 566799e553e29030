// tools/tether/tethered_camera.h - a tethered camera: its exposure times, and photos from it into a folder.
// gphoto2_camera.cpp alone uses libgphoto2. A build without this library throws Error when it opens a camera.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace burin {

/// A file that the camera delivered after its next release.
struct LateFile {
  std::filesystem::path file;                 ///< the copy on disk
  std::vector<std::filesystem::path> beside;  ///< other files of the same photo
};

/// Files that the camera delivered after one release.
struct TakenPhoto {
  std::vector<std::filesystem::path> files;  ///< of this photo: raw and JPEG
  std::vector<LateFile> late;                ///< of earlier photos
};

/// A connected camera at manual exposure. The destructor restores all changed settings.
class TetheredCamera {
 public:
  /// Connects to the only camera, or to one of several by its `port` ("usb:001,005"). Switches automatic ISO off and
  /// keeps photos on the card. Throws Error for no camera, for none at that port, and for a camera in use by another
  /// program. Throws Error for a fixed exposure time, when the dial is not at M.
  explicit TetheredCamera(const std::string& port = "");
  /// Restores the settings if the camera still answers.
  ~TetheredCamera();
  TetheredCamera(const TetheredCamera&) = delete;
  TetheredCamera& operator=(const TetheredCamera&) = delete;

  const std::string& model() const;

  /// Exposure times of the camera's dial, s, ascending.
  const std::vector<double>& shutters_s() const;

  /// Present exposure time, s; 0 for "bulb".
  double shutter_s() const;

  /// Sets the dial's nearest time (in stops) and returns it.
  double set_shutter(double exposure_s);

  /// Takes a photo and puts all its files (raw and JPEG) into the folder, whole or not at all. If a name is taken, the
  /// new file gets the suffix "-2". The files also stay on the card. Waits until the number of files expected from the
  /// camera's settings, or from an earlier photo, has arrived. A later file goes to the photo that its name, or else
  /// its EXIF, identifies. `stopped` ends the waiting. Throws Error for a camera without answer, a full card, and a
  /// folder without write permission.
  TakenPhoto take(const std::filesystem::path& folder, const std::function<bool()>& stopped = {});

  /// Returns late files when no further photo follows.
  std::vector<LateFile> late_files(const std::filesystem::path& folder);

  /// Restores the settings. If the camera refuses, throws Error with its remaining values.
  void put_back();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Parses a camera's exposure time, s: "1/60", "1/2.5", "0.0166s", "2", "0\"4", "30\""; 0 for "Bulb", "Auto" and
/// similar.
double seconds_of_dial(std::string_view text);

}  // namespace burin
