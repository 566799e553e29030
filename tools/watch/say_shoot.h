// tools/watch/say_shoot.h - what is said of photos as they come in: a line of facts each, what is wrong with it, what
// to do now, and how far the whole is.
#pragma once

#include <string>

#include "tools/watch/shoot.h"

namespace burin {

/// "1/30 s", the nearest on a camera's dial; "2.5 s".
std::string shutter_words(double exposure_s);

/// Two or more lines, ending in a newline: what the last photo is and shows, its faults, what to do now.
std::string last_photo_words(const Shoot& shoot);

/// What to do now, as half a sentence: "the same place at 1/500 s (f/8, ISO 100), 3 stops darker, for the glints".
std::string next_words(const Shoot& shoot);

/// "5 of 12 shots, 1 begun, 2 to take again"; without a plan "11 photos from 4 places".
std::string state_words(const Shoot& shoot);

/// A line for each wanted shot that is not done: what it lacks.
std::string missing_words(const Shoot& shoot);

/// The last photo as one line of JSON, without a newline; `seconds` it took to judge, `processor_seconds` of all
/// threads.
std::string last_photo_json(const Shoot& shoot, double seconds, double processor_seconds);

}  // namespace burin
