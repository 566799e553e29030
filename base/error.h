// burin/base/error.h - the one exception that Burin throws for bad input.
//
// A person reads the message as it is, so it names the file, the field or value, what is wrong and what to do.
// The burin program prints it and exits with 1; libraries never print and never exit.
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
