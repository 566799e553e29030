// tools/tether/tethered_shoot.h - exposure brackets with a tethered camera. Each photo is judged immediately, and its
// result determines the next exposure.
#pragma once

#include <CLI/App.hpp>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tools/tether/tethered_camera.h"
#include "tools/watch/shoot.h"

namespace burin {

/// Called after each photo: the shoot including it, the seconds of judging, and the processor seconds of all threads.
using PhotoTold = std::function<void(const Shoot& shoot, double seconds, double processor_seconds)>;

/// Takes one bracket from the camera's present place. Puts the photos into `photos` and into `shoot`. The first
/// exposure shows the tags' paper at 60 % of white; the search starts at the camera's present time. If `stops` is
/// empty, each further photo is three stops darker until no glint clips. Otherwise each of `stops` gives an exposure
/// relative to the paper's. Photos before the first good exposure stay on the card only. Returns an empty string, or
/// the reason for an incomplete bracket. Ends between two photos when `stopped` returns true. Throws the camera's
/// errors.
std::string take_bracket(TetheredCamera& camera, const std::vector<double>& stops, const std::filesystem::path& photos,
                         Shoot& shoot, const PhotoTold& told, const std::function<bool()>& stopped);

/// Options of a whole shoot.
struct TetheredShoot {
  std::string port;              ///< of the camera; empty: the only one
  std::vector<double> stops;     ///< of each bracket; empty: from the photos
  std::filesystem::path photos;  ///< the folder
  bool once = false;             ///< one bracket, without questions
};

/// Adds --brackets and --port, which need the flag `tether`.
void add_tether_options(CLI::App& command, CLI::Option* tether, std::vector<double>& stops, std::string& port);

/// Asks repeatedly for a new place of the camera, and takes a bracket there. Enter on standard input takes one; q, the
/// end of the input, or Ctrl-C (between two photos) ends the shoot. Restores the camera's settings at the end. Prints
/// its steps. Throws the camera's errors; earlier photos remain.
void shoot_tethered(const TetheredShoot& how, Shoot& shoot, const PhotoTold& told);

}  // namespace burin
