#include "tests/places.h"

#include <filesystem>

namespace burin::places {

std::string source() { return BURIN_SOURCE_DIR; }
std::string binary() { return BURIN_BINARY_DIR; }
std::string program() { return BURIN_PROGRAM; }
std::string compiler() {
  return "-DCMAKE_CXX_COMPILER='" BURIN_CXX_COMPILER "' -DCMAKE_CXX_FLAGS='" BURIN_CXX_FLAGS "'";
}
std::string data() { return source() + "/tests/data"; }
std::string shared() { return BURIN_SHARED_DIR; }
std::string rig(const std::string& name) {
  const std::string here = data() + "/rigs/" + name;
  return std::filesystem::exists(here) ? here : shared() + "/rigs/" + name;
}

}  // namespace burin::places
