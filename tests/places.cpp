#include "tests/places.h"

namespace burin::places {

std::string source() { return BURIN_SOURCE_DIR; }
std::string binary() { return BURIN_BINARY_DIR; }
std::string program() { return BURIN_PROGRAM; }
std::string shared() { return BURIN_SHARED_DIR; }

}  // namespace burin::places
