// tests/tools/program.h - runs the burin program as a person does, and holds what it said.
#pragma once

#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/places.h"
#include "tests/temporary_folder.h"

namespace burin {

struct Outcome {
  int exit_code = -1;  ///< -1 if it did not end by itself (a crash)
  std::string out, err;
};

inline std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

/// `command_line` in the shell, standard input closed; what it prints goes through files in `folder`.
inline Outcome run_shell(const TemporaryFolder& folder, const std::string& command_line) {
  const auto out = folder / ".stdout", err = folder / ".stderr";
  const int status = std::system(
      ("( " + command_line + " ) </dev/null >" + quoted(out.string()) + " 2>" + quoted(err.string())).c_str());
  Outcome run;
  if (WIFEXITED(status)) run.exit_code = WEXITSTATUS(status) < 128 ? WEXITSTATUS(status) : -1;
  run.out = file_text(out);
  run.err = file_text(err);
  std::filesystem::remove(out);
  std::filesystem::remove(err);
  return run;
}

/// `burin ARGUMENTS...` with the given working directory.
inline Outcome run_burin(const TemporaryFolder& folder, const std::vector<std::string>& arguments) {
  std::string line = "cd " + quoted(folder.path().string()) + " && " + quoted(places::program());
  for (const std::string& argument : arguments) line += " " + quoted(argument);
  return run_shell(folder, line);
}

}  // namespace burin
