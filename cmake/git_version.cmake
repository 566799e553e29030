# burin_git_version(<target> <file>)
#
# Compiles burin::version() (tools/version.h) into the target: the release's number at its tag; else the project's number with the commit,
# "0.2.0-dev.5+g1a2b3c4" (5 commits after the last tag; 0 without one), with ".dirty" for uncommitted changes; without git the number
# alone. Each build looks, and only a change compiles this one source.
if(NOT CMAKE_SCRIPT_MODE_FILE)
  function(burin_git_version target file)
    add_custom_target(burin_git_version BYPRODUCTS ${file}
                      COMMAND ${CMAKE_COMMAND} -DVERSION=${PROJECT_VERSION} -DSOURCE=${PROJECT_SOURCE_DIR} -DOUT=${file}
                              -P ${CMAKE_CURRENT_FUNCTION_LIST_FILE}
                      VERBATIM)
    set_source_files_properties(${file} PROPERTIES GENERATED ON SKIP_UNITY_BUILD_INCLUSION ON SKIP_PRECOMPILE_HEADERS ON)
    target_sources(${target} PRIVATE ${file})
    add_dependencies(${target} burin_git_version)
  endfunction()
  return()
endif()

set(version ${VERSION})
find_program(git git)
if(git AND EXISTS ${SOURCE}/.git)
  execute_process(COMMAND ${git} describe --tags --long --always --dirty=.dirty --abbrev=8 --match "v[0-9]*" WORKING_DIRECTORY ${SOURCE}
                  OUTPUT_VARIABLE described OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(failed)
    set(described "")
  endif()
  if(described MATCHES "^v(.+)-([0-9]+)-g([0-9a-f]+)(\\.dirty)?$")
    set(tag ${CMAKE_MATCH_1})
    set(later ${CMAKE_MATCH_2})
    set(commit "${CMAKE_MATCH_3}${CMAKE_MATCH_4}")
    if(NOT (later EQUAL 0 AND tag STREQUAL VERSION AND NOT commit MATCHES "dirty"))
      set(version "${VERSION}-dev.${later}+g${commit}")
    endif()
  elseif(described MATCHES "^[0-9a-f]+(\\.dirty)?$")
    set(version "${VERSION}-dev.0+g${described}")
  endif()
endif()
set(text "#include \"tools/version.h\"\n\nnamespace burin {\n\nstd::string version() { return \"${version}\"; }\n\n}  // namespace burin\n")
set(before "")
if(EXISTS ${OUT})
  file(READ ${OUT} before)
endif()
if(NOT text STREQUAL before)
  file(WRITE ${OUT} "${text}")
endif()
