// tools/local_time.h - the local time for messages.
#pragma once

#include <string>

namespace burin {

/// Formats the present time in the system's time zone with strftime(). Returns "an unknown time" if the clock has no
/// valid date.
std::string local_time(const char* format);

}  // namespace burin
