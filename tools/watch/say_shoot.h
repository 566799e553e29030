// tools/watch/say_shoot.h - messages about incoming photos: facts, faults, the next step and the progress of the shoot.
#pragma once

#include <string>

#include "burin/base/files/json_file.h"
#include "tools/watch/shoot.h"

namespace burin {

/// "1/30 s", the nearest on a camera's dial; "2.5 s".
std::string shutter_words(double exposure_s);

/// Returns two or more lines, with a final newline: facts and faults of the latest photo, and the next step.
std::string last_photo_words(const Shoot& shoot);

/// Returns the next step as half a sentence: "the same place at 1/500 s (f/8, ISO 100), 3 stops darker, for the
/// glints".
std::string next_words(const Shoot& shoot);

/// "5 of 12 shots, 1 begun, 2 to take again"; without a plan "11 photos from 4 places".
std::string state_words(const Shoot& shoot);

/// Returns one line per unfinished shot, with its missing part.
std::string missing_words(const Shoot& shoot);

/// Returns the latest photo as JSON. `seconds`: time of judging; `processor_seconds`: of all threads.
Json last_photo_json(const Shoot& shoot, double seconds, double processor_seconds);

}  // namespace burin
