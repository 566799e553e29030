# burin_embed(<target> <name> <files...>)
#
# Compiles text files of the current folder (scripts, shaders, style sheets, pages) into the target. They stay files in the tree,
# and the program needs none of them at run time. C++ reads them as
#
#   #include "embedded/<name>.h"
#   std::string_view text = burin::embedded::<name>("page.js");   // the file's own name, without its folder
#
# What is asked for and not embedded throws std::logic_error. A changed file is embedded anew by the next build.
function(burin_embed target name)
  set(sources "")
  foreach(file ${ARGN})
    get_filename_component(file ${file} ABSOLUTE)
    list(APPEND sources ${file})
  endforeach()
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/embedded)
  file(CONFIGURE OUTPUT ${folder}/${name}.h CONTENT [[
// Made by cmake/burin_embed.cmake.
#pragma once

#include <string_view>

namespace burin::embedded {

/// The text of an embedded file by its name, without its folder. Throws std::logic_error for one that is not embedded.
std::string_view @name@(std::string_view file);

}  // namespace burin::embedded
]] @ONLY)
  list(JOIN sources "|" joined)  # a semicolon would part the command line
  add_custom_command(OUTPUT ${folder}/${name}.cpp
                     COMMAND ${CMAKE_COMMAND} -DNAME=${name} -DOUT=${folder}/${name}.cpp "-DFILES=${joined}"
                             -P ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/write_embedded.cmake
                     DEPENDS ${sources} ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/write_embedded.cmake
                     COMMENT "Embedding ${name}" VERBATIM)
  target_sources(${target} PRIVATE ${folder}/${name}.cpp)
  target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR})
endfunction()
