#include "tools/local_time.h"

#include <array>
#include <ctime>

namespace burin {

std::string local_time(const char* format) {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  std::array<char, 64> text{};
  if (::localtime_r(&now, &parts) == nullptr || std::strftime(text.data(), text.size(), format, &parts) == 0)
    return "an unknown time";
  return text.data();
}

}  // namespace burin
