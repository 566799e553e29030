#include "render/error.h"

namespace burin {

void fail(const std::string& where, const std::string& what, const std::string& remedy) {
  throw Error(where + ": " + what + "; " + remedy);
}

}  // namespace burin
