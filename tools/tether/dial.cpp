#include <algorithm>
#include <cctype>
#include <string>

#include "burin/base/files/table.h"
#include "tools/tether/tethered_camera.h"

namespace burin {

double seconds_of_dial(std::string_view text) {
  std::string plain;
  for (const char c : text)
    if (!std::isspace(static_cast<unsigned char>(c))) plain += c;
  if (const std::size_t inches = plain.find('"'); inches != std::string::npos)  // 0"4 is 0.4 s, and 30" is 30 s
    plain =
        inches + 1 == plain.size() ? plain.substr(0, inches) : plain.substr(0, inches) + "." + plain.substr(inches + 1);
  if (!plain.empty() && (plain.back() == 's' || plain.back() == 'S')) plain.pop_back();
  const std::size_t slash = plain.find('/');
  const double above = number_in(plain.substr(0, slash)).value_or(0);
  const double below = slash == std::string::npos ? 1 : number_in(plain.substr(slash + 1)).value_or(0);
  return above > 0 && below > 0 ? above / below : 0;
}

}  // namespace burin
