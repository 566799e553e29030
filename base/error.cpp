#include "burin/base/error.h"

#include "burin/base/files/printable.h"

namespace burin {
namespace {

// Libraries report errors in several lines; people get one sentence.
std::string one_line(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c != '\n' && c != '\r')
      out += c;
    else if (!out.empty() && !out.ends_with(", "))
      out += ", ";
  }
  while (out.ends_with(", ")) out.resize(out.size() - 2);
  return printable(out);
}

}  // namespace

void fail(const std::string& where, const std::string& what, const std::string& remedy) {
  throw Error(one_line(where + ": " + what + "; " + remedy));
}

}  // namespace burin
