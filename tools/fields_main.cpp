// Prints each field that the readers of our files request, as lines of JSON, for scripts/schemas: burin_fields FILE...
#include <fmt/format.h>

#include <cstdio>
#include <exception>

#include "burin/base/files/json_file.h"
#include "tools/check_file.h"

int main(int argc, char** argv) {
  burin::observe_fields([](const std::string& where, const std::string& key, const std::string& kind) {
    fmt::print("{}\n", burin::Json({where, key, kind}).dump());
  });
  try {
    for (int i = 1; i < argc; ++i) {
      const burin::Report report = burin::check_file(argv[i]);
      if (report.failure) throw burin::InputError(*report.failure);
    }
  } catch (const std::exception& error) {
    fmt::print(stderr, "burin_fields: {}\n", error.what());
    return 1;
  }
  return 0;
}
