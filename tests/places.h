// tests/places.h - where the tests find things on this machine. Compiled once (places.cpp), so that no test's own
// compilation depends on where the checkout lies.
#pragma once

#include <string>

namespace burin::places {

std::string source();   ///< the checkout
std::string binary();   ///< its build folder
std::string program();  ///< the burin program
std::string shared();   ///< rigs and pictures beside the checkout; may not exist

}  // namespace burin::places
