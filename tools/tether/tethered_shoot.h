// tools/tether/tethered_shoot.h - brackets by a connected camera, each photo judged the moment it is there: from the
// first exposure on, the next one follows from what the last one shows.
#pragma once

#include <CLI/App.hpp>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tools/tether/tethered_camera.h"
#include "tools/watch/shoot.h"

namespace burin {

/// Told after each photo: the shoot with it, the seconds it took to judge it, and the processor's.
using PhotoTold = std::function<void(const Shoot& shoot, double seconds, double processor_seconds)>;

/// One bracket from where the camera stands, its photos put into `photos` and taken into `shoot`. First the tags' paper
/// at 60 % of white, beginning with the time that the camera is set to; then, where `stops` is empty, three stops
/// darker each time until no glint is clipped, or else as many stops from the paper's exposure as each of `stops` says.
/// Photos on the way to the first good exposure of the paper are left on the card alone. Empty, or why the bracket
/// ended before it was whole. Ends between two photos when `stopped` says so. Throws Error as the camera does.
std::string take_bracket(TetheredCamera& camera, const std::vector<double>& stops, const std::filesystem::path& photos,
                         Shoot& shoot, const PhotoTold& told, const std::function<bool()>& stopped);

/// How a whole shoot goes.
struct TetheredShoot {
  std::string port;              ///< of the camera; empty: the one there is
  std::vector<double> stops;     ///< of each bracket; empty: by what the photos show
  std::filesystem::path photos;  ///< the folder
  bool once = false;             ///< one bracket, without asking
};

/// --brackets and --port, which go with the flag `tether`.
void add_tether_options(CLI::App& command, CLI::Option* tether, std::vector<double>& stops, std::string& port);

/// Asks for the camera to be put to the next place, again and again, and takes a bracket from each: Enter on standard
/// input takes one, q or the input's end ends it, and so does Ctrl-C (between two photos). Then puts the camera's
/// settings back. Prints what it does. Throws Error as the camera does; photos so far are kept.
void shoot_tethered(const TetheredShoot& how, Shoot& shoot, const PhotoTold& told);

}  // namespace burin
