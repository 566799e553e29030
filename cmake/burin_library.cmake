# GCC collects its garbage as if memory were scarce. Where there is enough for every compiler, that is put off: a seventh less time.
cmake_host_system_information(RESULT burin_memory_mib QUERY TOTAL_PHYSICAL_MEMORY)
cmake_host_system_information(RESULT burin_cores QUERY NUMBER_OF_LOGICAL_CORES)
math(EXPR burin_memory_per_core_mib "${burin_memory_mib} / ${burin_cores}")
if(CMAKE_UNITY_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND burin_memory_per_core_mib GREATER 3500)
  add_compile_options("SHELL:--param ggc-min-expand=200" "SHELL:--param ggc-min-heapsize=1500000")
endif()

# Headers are included as "burin/room/header.h", as where Burin is installed: a link in the build folder leads to the rooms.
set(burin_include_dir ${PROJECT_BINARY_DIR}/include)
file(MAKE_DIRECTORY ${burin_include_dir})
file(CREATE_LINK ${PROJECT_SOURCE_DIR} ${burin_include_dir}/burin SYMBOLIC)

# burin_library(room USES <public libraries> PRIVATE_USES <libraries that only its .cpp files see>
#               HEADER_ONLY_USES <the same, of headers alone: nothing of them is linked, so users of Burin need not have them>
#               PUBLIC_HEADERS <what users of the library include, and what is installed>)
#
# Makes the library `burin_<room>` (exported as burin::<room>) from every .cpp file in and below the current folder.
# The `coverage` preset counts lines of the rooms in BURIN_COUNTED_ROOMS, all where it is empty; the others run at full speed.
# Headers are included as "burin/room/header.h" here, and as <burin/room/header.h> where Burin is installed. All headers that
# are not among PUBLIC_HEADERS are the house's own business.
function(burin_library room)
  cmake_parse_arguments(ARG "" "" "USES;PRIVATE_USES;HEADER_ONLY_USES;PUBLIC_HEADERS" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS *.cpp)
  # The folder `core` has what the core has instead of the rest of its room.
  if(BURIN_CORE AND IS_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/core)
    list(FILTER sources INCLUDE REGEX "/core/")
  else()
    list(FILTER sources EXCLUDE REGEX "/core/")
  endif()
  if(NOT sources)  # a room with headers only still is a library that others can link
    set(sources ${CMAKE_CURRENT_BINARY_DIR}/no_sources.cpp)
    file(WRITE ${sources} "")
  endif()
  add_library(burin_${room} ${sources})  # static unless BUILD_SHARED_LIBS asks for shared ones
  add_library(burin::${room} ALIAS burin_${room})
  set_target_properties(burin_${room} PROPERTIES EXPORT_NAME ${room} VERSION ${PROJECT_VERSION}
                        SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  target_compile_features(burin_${room} PUBLIC cxx_std_20)
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  list(TRANSFORM ARG_PUBLIC_HEADERS PREPEND ${burin_include_dir}/burin/${folder}/)
  target_sources(burin_${room} PUBLIC FILE_SET HEADERS BASE_DIRS ${burin_include_dir} FILES ${ARG_PUBLIC_HEADERS})
  set_property(GLOBAL APPEND PROPERTY BURIN_PUBLIC_HEADERS ${ARG_PUBLIC_HEADERS})
  list(TRANSFORM ARG_HEADER_ONLY_USES REPLACE "(.+)" "$<BUILD_INTERFACE:\\1>")
  target_link_libraries(burin_${room} PUBLIC ${ARG_USES} PRIVATE ${ARG_PRIVATE_USES} ${ARG_HEADER_ONLY_USES})
  burin_warnings(burin_${room})
  if(BURIN_COUNTED_ROOMS AND NOT room IN_LIST BURIN_COUNTED_ROOMS)
    target_compile_options(burin_${room} PRIVATE -fno-profile-arcs -fno-test-coverage -O3)
  else()
    target_precompile_headers(burin_${room} REUSE_FROM burin_room_headers)  # made with this target's options
  endif()
  burin_check_private_headers(${room})
endfunction()

# Public headers include each other, Eigen and the standard library: no user must have TBB, xsimd or OpenCV to compile, and
# nothing that is installed includes what is not.
function(burin_check_public_headers)
  get_property(headers GLOBAL PROPERTY BURIN_PUBLIC_HEADERS)
  foreach(header ${headers})
    file(STRINGS ${header} includes REGEX "^#include")
    foreach(include ${includes})
      if(include MATCHES "\"(burin/.*)\"")
        if(NOT "${burin_include_dir}/${CMAKE_MATCH_1}" IN_LIST headers)
          file(RELATIVE_PATH name ${burin_include_dir} ${header})
          message(SEND_ERROR "${name} is public and includes ${CMAKE_MATCH_1}, which is not: add that to PUBLIC_HEADERS in its "
                             "room's CMakeLists.txt, or do without it")
        endif()
      elseif(NOT include MATCHES "<(Eigen/[A-Za-z]+|[a-z_0-9]+)>")
        file(RELATIVE_PATH name ${burin_include_dir} ${header})
        message(SEND_ERROR "${name} is public and has ${include}: a public header may need only Eigen and the standard library")
      endif()
    endforeach()
    set_property(DIRECTORY ${PROJECT_SOURCE_DIR} APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${header})
  endforeach()
  list(JOIN headers "\n" lines)
  file(WRITE ${PROJECT_BINARY_DIR}/public_headers.txt "${lines}\n")  # for scripts/api-docs
endfunction()

# The target `check_private_headers` compiles every other header alone. (CMake's header sets do so for public ones: the target
# all_verify_interface_header_sets.)
function(burin_check_private_headers room)
  if(NOT CMAKE_VERIFY_INTERFACE_HEADER_SETS)
    return()
  endif()
  get_property(public GLOBAL PROPERTY BURIN_PUBLIC_HEADERS)
  file(GLOB_RECURSE headers CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR} *.h)
  set(sources "")
  foreach(header ${headers})
    set(name burin/${header})
    if(NOT ${burin_include_dir}/${name} IN_LIST public)
      set(source ${CMAKE_CURRENT_BINARY_DIR}/check_headers/${name}.cpp)
      file(CONFIGURE OUTPUT ${source} CONTENT "#include \"${name}\"\n")
      list(APPEND sources ${source})
    endif()
  endforeach()
  if(NOT sources)
    return()
  endif()
  add_library(burin_${room}_private_headers OBJECT EXCLUDE_FROM_ALL ${sources})
  set_target_properties(burin_${room}_private_headers PROPERTIES UNITY_BUILD OFF)
  target_compile_features(burin_${room}_private_headers PRIVATE cxx_std_20)
  target_include_directories(burin_${room}_private_headers PRIVATE ${burin_include_dir})
  get_target_property(libraries burin_${room} LINK_LIBRARIES)
  target_link_libraries(burin_${room}_private_headers PRIVATE ${libraries})
  # A header's own functions need not be used in a file that holds nothing else.
  target_compile_options(burin_${room}_private_headers PRIVATE -Wno-unused-function -O0)
  if(NOT TARGET check_private_headers)
    add_custom_target(check_private_headers)
  endif()
  add_dependencies(check_private_headers burin_${room}_private_headers)
endfunction()

# Strict warnings for our own code only: never forced on those who link us.
function(burin_warnings target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic $<$<BOOL:${BURIN_WARNINGS_AS_ERRORS}>:-Werror>)
  if(CMAKE_UNITY_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")  # then every .cpp file is one that another includes
    target_compile_options(${target} PRIVATE -Wno-subobject-linkage)
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_FLAGS MATCHES "-fsanitize")  # checks hide from GCC what was set
    target_compile_options(${target} PRIVATE -Wno-maybe-uninitialized)
  endif()
  # GCC 12 sees overlaps and lengths in std::string that are not there (GCC bug 105651); later ones check in earnest.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(${target} PRIVATE -Wno-restrict -Wno-stringop-overflow -Wno-array-bounds)
  endif()
endfunction()

# Compiles files of the current folder for wider machines than the rest. GCC 12 takes the undefined operands inside its own
# AVX-512 intrinsics for uninitialized variables. With a sanitizer the generic kernels are checked; for the wider ones, the same
# code, a compiler would need too long.
function(burin_simd_files)
  cmake_parse_arguments(ARG "" "" "AVX2;AVX512" ${ARGN})
  if(NOT CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    return()
  endif()
  if(CMAKE_CXX_FLAGS MATCHES "-fsanitize")
    set(unchecked "-fno-sanitize=all")
  endif()
  # What was precompiled for other machines does not fit.
  set_source_files_properties(${ARG_AVX2} ${ARG_AVX512} PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
  set_source_files_properties(${ARG_AVX2} PROPERTIES COMPILE_OPTIONS "-mavx2;-mfma;${unchecked}")
  set_source_files_properties(${ARG_AVX512} PROPERTIES
    COMPILE_OPTIONS "-mavx512f;-mavx512cd;-mavx512dq;-mavx512bw;-mfma;$<$<CXX_COMPILER_ID:GNU>:-Wno-uninitialized;-Wno-maybe-uninitialized>;${unchecked}")
endfunction()

# Where whole builds begin from nothing (the presets), what most files begin with is read once, and files are compiled a handful at
# a time: that is two thirds of all compiling. A file still includes what it uses, and stands alone: builds with ccache do without
# both (tools/build), and every header is compiled alone.
function(burin_precompile target)
  target_precompile_headers(${target} PRIVATE
    <algorithm> <array> <atomic> <cmath> <cstdint> <filesystem> <functional> <limits> <map> <memory> <numbers> <numeric> <optional>
    <random> <set> <span> <string> <string_view> <utility> <vector> <Eigen/Core> <Eigen/Geometry> ${ARGN})
endfunction()

# What is precompiled for all rooms: nothing but what `burin_precompile` names, and no room's definitions.
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/room_headers.cpp
     CONTENT "// Nothing: CMake wants a file for the target whose precompiled headers the rooms share.\n")
add_library(burin_room_headers STATIC ${PROJECT_BINARY_DIR}/room_headers.cpp)
target_link_libraries(burin_room_headers PRIVATE Eigen3::Eigen)
target_compile_features(burin_room_headers PUBLIC cxx_std_20)
if(BUILD_SHARED_LIBS)  # as the rooms have it; static ones follow CMAKE_POSITION_INDEPENDENT_CODE, and so does this
  set_target_properties(burin_room_headers PROPERTIES POSITION_INDEPENDENT_CODE ON)
endif()
burin_warnings(burin_room_headers)
burin_precompile(burin_room_headers)
