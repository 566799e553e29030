// The long form: gcode_fuzz RUNS SECONDS SEED [PART]: so many changed G-code files, as many made-up profiles, and as
// many tool paths from files of which one number was changed (PART: files, profiles or inputs alone). Prints what was
// done, and each finding; exits with 1 if there was one.
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>

#include "tests/reliability/gcode_fuzz.h"

int main(int argc, char** argv) {
  const std::uint64_t runs = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 100000;
  const double seconds = argc > 2 ? std::atof(argv[2]) : 60;
  const std::uint64_t seed = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 1;
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("burin-gcode-fuzz-" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  const std::string part = argc > 4 ? argv[4] : "";
  const double share = part.empty() ? seconds / 3 : seconds;
  burin::GcodeFuzz gcode, profiles, inputs;
  if (part.empty() || part == "files") gcode = burin::fuzz_gcode(seed, runs, share);
  if (part.empty() || part == "profiles") profiles = burin::fuzz_profiles(seed, runs, share, folder);
  if (part.empty() || part == "inputs") inputs = burin::fuzz_inputs(seed, runs, share, folder);
  std::filesystem::remove_all(folder);
  std::size_t findings = 0;
  for (const auto& [name, fuzz] :
       {std::pair{"G-code", &gcode}, std::pair{"profiles", &profiles}, std::pair{"inputs", &inputs}}) {
    std::printf("%s: %llu runs, %llu accepted (%llu of them released), %zu findings (seed %llu)\n", name,
                static_cast<unsigned long long>(fuzz->runs), static_cast<unsigned long long>(fuzz->accepted),
                static_cast<unsigned long long>(fuzz->released), fuzz->findings.size(),
                static_cast<unsigned long long>(seed));
    for (const std::string& finding : fuzz->findings) std::printf("%s\n", finding.c_str());
    findings += fuzz->findings.size();
  }
  return findings == 0 ? 0 : 1;
}
