# After `cmake --install`, another project says find_package(burin) and links burin::render, burin::calib, ...
include(CMakePackageConfigHelpers)
set(burin_rooms render capture calib optimize)
list(TRANSFORM burin_rooms PREPEND burin_ OUTPUT_VARIABLE burin_targets)
install(TARGETS ${burin_targets} EXPORT burinTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS burin RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
foreach(room ${burin_rooms})
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/burin/${room} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/burin
          FILES_MATCHING PATTERN "*.h")
endforeach()
set(burin_cmake_dir ${CMAKE_INSTALL_LIBDIR}/cmake/burin)
install(EXPORT burinTargets NAMESPACE burin:: DESTINATION ${burin_cmake_dir})
configure_package_config_file(cmake/burinConfig.cmake.in burinConfig.cmake INSTALL_DESTINATION ${burin_cmake_dir})
write_basic_package_version_file(burinConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/burinConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/burinConfigVersion.cmake
              cmake/dependencies.cmake DESTINATION ${burin_cmake_dir})
