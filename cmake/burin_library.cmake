# burin_library(room USES <public libraries> PRIVATE_USES <libraries only its .cpp files see>)
#
# Makes the static library `burin_<room>` (exported as burin::<room>) from every .cpp file in and below the current folder.
# Headers are included as "burin/room/header.h".
function(burin_library room)
  cmake_parse_arguments(ARG "" "" "USES;PRIVATE_USES" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS *.cpp)
  if(NOT sources)  # a room with headers only still is a library that others can link
    set(sources ${CMAKE_CURRENT_BINARY_DIR}/no_sources.cpp)
    file(WRITE ${sources} "")
  endif()
  add_library(burin_${room} STATIC ${sources})
  add_library(burin::${room} ALIAS burin_${room})
  set_target_properties(burin_${room} PROPERTIES EXPORT_NAME ${room})
  target_compile_features(burin_${room} PUBLIC cxx_std_20)
  target_include_directories(burin_${room} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                                                  $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(burin_${room} PUBLIC ${ARG_USES} PRIVATE ${ARG_PRIVATE_USES})
  burin_warnings(burin_${room})
endfunction()

# Strict warnings for our own code only: never forced on those who link us.
function(burin_warnings target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic $<$<BOOL:${BURIN_WARNINGS_AS_ERRORS}>:-Werror>)
  # -Wrestrict of GCC 12 sees overlaps in std::string that are not there (GCC bug 105651).
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(${target} PRIVATE -Wno-restrict)
  endif()
endfunction()
