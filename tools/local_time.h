// tools/local_time.h - the clock on the wall, for what a person reads.
#pragma once

#include <ctime>

namespace burin {

/// Now, in the time zone of this machine. (fmt::localtime is gone since fmt 12; std::tm is written by every
/// fmt/chrono.h.)
inline std::tm local_time() {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  ::localtime_r(&now, &local);
  return local;
}

}  // namespace burin
