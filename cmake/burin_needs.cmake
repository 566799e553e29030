# burin_needs(<name> <what it is> <Debian's package> <its project's page> [MODULE <pkg-config's name>] [LEAST <version>]
#             [find_package's arguments])
#
# Finds a library by find_package, or by pkg-config as the target PkgConfig::<name>. LEAST is for packages whose next major version
# serves as well, and would not answer to an older one's number. What is not there does not end the configuration
# at once: burin_settle_needs() names all of it together, with the packages. Read where Burin is built and where it is used.
macro(burin_needs name words package page)
  cmake_parse_arguments(burin_need "" "MODULE;LEAST" "" ${ARGN})
  if(NOT burin_need_MODULE)
    find_package(${name} ${burin_need_UNPARSED_ARGUMENTS} QUIET)
  elseif(NOT TARGET PkgConfig::${name} AND COMMAND pkg_check_modules)
    pkg_check_modules(${name} QUIET IMPORTED_TARGET GLOBAL ${burin_need_MODULE})
    # Rooms share precompiled headers, which GCC refuses to a room with a flag of its own. Burin links threads itself.
    if(TARGET PkgConfig::${name})
      get_target_property(burin_need_options PkgConfig::${name} INTERFACE_COMPILE_OPTIONS)
      if(burin_need_options)
        list(REMOVE_ITEM burin_need_options -pthread)
        set_property(TARGET PkgConfig::${name} PROPERTY INTERFACE_COMPILE_OPTIONS "${burin_need_options}")
      endif()
    endif()
  endif()
  if(NOT ${name}_FOUND AND NOT TARGET PkgConfig::${name})
    set(burin_need_why "")
    if(${name}_NOT_FOUND_MESSAGE)
      set(burin_need_why " (it is there, but: ${${name}_NOT_FOUND_MESSAGE})")
    elseif(NOT "${${name}_CONSIDERED_VERSIONS}" MATCHES "^(unknown)?$")
      set(burin_need_why ", and not ${${name}_CONSIDERED_VERSIONS}")
    endif()
    if("${burin_need_why}" MATCHES "CUDA")
      burin_lacks_cuda(${name} "${burin_need_why}" ${package})
    else()
      burin_lacks("${words}${burin_need_why}" ${package} ${page})
    endif()
  elseif(burin_need_LEAST AND "${${name}_VERSION}" VERSION_LESS "${burin_need_LEAST}")
    burin_lacks("${words}, and not ${${name}_VERSION}" ${package} ${page})
  endif()
endmacro()

# Notes that something is missing.
macro(burin_lacks words package page)
  string(REPLACE ";" ", " burin_need_line "${words}")
  string(APPEND burin_missing "  ${burin_need_line}: Debian's ${package}, or ${page}\n")
  list(APPEND burin_missing_packages ${package})
endmacro()

macro(burin_lacks_cuda words why package)
  burin_lacks("CUDA's toolkit, since this ${words} was built with CUDA${why} (without CUDA: ${package})" nvidia-cuda-toolkit
              https://docs.nvidia.com/cuda)
endmacro()

# Targets that <target> links and nobody defined. CMake would find out only once everything is configured, and name no remedy. A library
# that was built with CUDA names CUDA's targets, which CMake itself can find.
macro(burin_needs_what_links target words package page)
  get_target_property(burin_need_links ${target} INTERFACE_LINK_LIBRARIES)
  string(REGEX MATCHALL "[A-Za-z0-9_]+::[A-Za-z0-9_]+" burin_need_links "${burin_need_links}")
  if("${burin_need_links}" MATCHES "CUDA::")
    find_package(CUDAToolkit QUIET)
  endif()
  set(burin_need_undefined "")
  foreach(burin_need_link IN LISTS burin_need_links)
    if(NOT TARGET ${burin_need_link})
      list(APPEND burin_need_undefined ${burin_need_link})
    endif()
  endforeach()
  if("${burin_need_undefined}" MATCHES "CUDA::")
    burin_lacks_cuda("${words}" " and links ${burin_need_undefined}" ${package})
  elseif(burin_need_undefined)
    burin_lacks("${burin_need_undefined}, which this ${words} links" ${package} ${page})
  endif()
endmacro()

# All that is missing, and what to do, in <out>; empty where nothing is.
function(burin_words_of_missing out)
  set(words "")
  if(burin_missing)
    list(REMOVE_DUPLICATES burin_missing_packages)
    list(JOIN burin_missing_packages " " packages)
    string(CONCAT words "Burin needs what was not found here:\n${burin_missing}"
           "On Debian and Ubuntu:\n  apt-get install ${packages}\n"
           "For one that lies in a folder of its own: -DCMAKE_PREFIX_PATH=FOLDER. Other systems: README.md.")
  endif()
  set(${out} "${words}" PARENT_SCOPE)
endfunction()

# Ends the configuration with it.
function(burin_settle_needs)
  burin_words_of_missing(words)
  if(words)
    message(FATAL_ERROR "${words}")
  endif()
endfunction()
