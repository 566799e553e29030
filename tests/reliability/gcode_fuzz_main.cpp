// The long form: gcode_fuzz RUNS SECONDS SEED: so many changed G-code files and as many changed profiles. Prints what
// was done, and each finding; exits with 1 if there was one.
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "tests/reliability/gcode_fuzz.h"

int main(int argc, char** argv) {
  const std::uint64_t runs = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 100000;
  const double seconds = argc > 2 ? std::atof(argv[2]) : 60;
  const std::uint64_t seed = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 1;
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("burin-gcode-fuzz-" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  const burin::GcodeFuzz gcode = burin::fuzz_gcode(seed, runs, seconds / 2);
  const burin::GcodeFuzz profiles = burin::fuzz_profiles(seed, runs, seconds / 2, folder);
  std::filesystem::remove_all(folder);
  std::size_t findings = 0;
  for (const auto& [name, fuzz] : {std::pair{"G-code", &gcode}, std::pair{"profiles", &profiles}}) {
    std::printf("%s: %llu runs, %llu accepted, %zu findings (seed %llu)\n", name,
                static_cast<unsigned long long>(fuzz->runs), static_cast<unsigned long long>(fuzz->accepted),
                fuzz->findings.size(), static_cast<unsigned long long>(seed));
    for (const std::string& finding : fuzz->findings) std::printf("%s\n", finding.c_str());
    findings += fuzz->findings.size();
  }
  return findings == 0 ? 0 : 1;
}
