// tools/local_time.h - the time of day, for people.
#pragma once

#include <string>

namespace burin {

/// Now, in the system's time zone, as strftime() formats it; "an unknown time" where the clock is so far off that no
/// date is.
std::string local_time(const char* format);

}  // namespace burin
