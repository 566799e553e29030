// burin/base/error.h - the only exception that Burin throws for bad input.
//
// People read the message unchanged, so it contains the file, the field or value, the problem and the remedy. The burin
// program prints it and exits with 1; libraries never print and never exit.
#pragma once

#include <stdexcept>
#include <string>

namespace burin {

struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Throws Error("where: what; remedy"). `where` is a file, or file and field: "board.json: tags.list[3].size_mm".
[[noreturn]] void fail(const std::string& where, const std::string& what, const std::string& remedy);

}  // namespace burin
