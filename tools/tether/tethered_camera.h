// tools/tether/tethered_camera.h - a camera on a cable: its exposure times, and photos from it into a folder. The one
// file that talks to libgphoto2 is gphoto2_camera.cpp; where Burin was built without it, opening a camera says so.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace burin {

/// A file that a camera handed over only after it had been released again.
struct LateFile {
  std::filesystem::path file;                 ///< our copy
  std::vector<std::filesystem::path> beside;  ///< the other files of the photo that it is of
};

/// What the camera handed over when it was released.
struct TakenPhoto {
  std::vector<std::filesystem::path> files;  ///< of this photo: raw and JPEG
  std::vector<LateFile> late;                ///< of earlier ones
};

/// A connected camera, at manual exposure. Whatever of its settings is changed is put back at the end.
class TetheredCamera {
 public:
  /// Connects to the camera that there is, or to the one at `port` ("usb:001,005") where there are several. Automatic
  /// ISO is switched off, and photos are made to stay on the card. Throws Error where there is no camera or none at
  /// that port, where another program holds it, and for one whose exposure time cannot be set: its dial is not at M.
  explicit TetheredCamera(const std::string& port = "");
  /// Puts settings back, as far as the camera still answers.
  ~TetheredCamera();
  TetheredCamera(const TetheredCamera&) = delete;
  TetheredCamera& operator=(const TetheredCamera&) = delete;

  const std::string& model() const;

  /// The exposure times of its dial, s, ascending.
  const std::vector<double>& shutters_s() const;

  /// What it is set to now; 0 for a time that is none ("bulb").
  double shutter_s() const;

  /// Sets the time of its dial that is nearest (in stops), and returns it.
  double set_shutter(double exposure_s);

  /// Takes a photo, and puts all files that it makes of it (raw and JPEG) into the folder, whole or not at all; files
  /// of their names that are there already stay, and these get "-2" behind theirs. They stay on the card as well.
  /// Waits until as many files are there as the camera's settings promise, or as it made of a photo before; a file that
  /// comes later still is put to the photo that its name, else its EXIF, says it is of. `stopped` ends the waiting.
  /// Throws Error where the camera does not answer any more, its card is full, or the folder cannot be written.
  TakenPhoto take(const std::filesystem::path& folder, const std::function<bool()>& stopped = {});

  /// Files that are late still, when no further photo will be taken.
  std::vector<LateFile> late_files(const std::filesystem::path& folder);

  /// Puts settings back. Throws Error where the camera does not take them, naming what it is left at.
  void put_back();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// A time as cameras write it: "1/60", "1/2.5", "0.0166s", "2", "0\"4", "30\""; 0 for "Bulb", "Auto" and the like.
double seconds_of_dial(std::string_view text);

}  // namespace burin
