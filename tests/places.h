// tests/places.h - where the tests find things on this machine. Compiled once (places.cpp), so that no test's own
// compilation depends on where the checkout lies.
#pragma once

#include <algorithm>
#include <string>

namespace burin::places {

std::string source();    ///< the checkout
std::string binary();    ///< its build folder
std::string program();   ///< the burin program
std::string compiler();  ///< the C++ compiler and its flags (sanitizers), as CMake's options
std::string data();      ///< tests/data: known values, photos and small rigs that every checkout has
std::string shared();    ///< more rigs, and the same at full size (BURIN_SHARED_DIR); may not exist

/// The folder of a photographed bench: of tests/data if it is there ("b-small", "bench-loop"), else of
/// shared ("a", "b": full size).
std::string rig(const std::string& name);

/// A rig's name as GoogleTest allows it in a test's: INSTANTIATE_TEST_SUITE_P(..., Values("b-small", "b"),
/// as_test_name).
inline constexpr auto as_test_name = [](const auto& info) {
  std::string name = info.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
};

}  // namespace burin::places
