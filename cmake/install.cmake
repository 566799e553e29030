# After `cmake --install`, another project says find_package(burin) and links burin::render, burin::calib, ... Installed are the
# libraries, their public headers (PUBLIC_HEADERS in each room's CMakeLists.txt), the program, and under share/ the sample, the
# examples and the documents.
include(CMakePackageConfigHelpers)
set(burin_rooms render capture calib optimize)
list(TRANSFORM burin_rooms PREPEND burin_ OUTPUT_VARIABLE burin_targets)
install(TARGETS ${burin_targets} EXPORT burinTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
        FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(TARGETS burin RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})

set(burin_cmake_dir ${CMAKE_INSTALL_LIBDIR}/cmake/burin)
install(EXPORT burinTargets NAMESPACE burin:: DESTINATION ${burin_cmake_dir})
configure_package_config_file(cmake/burinConfig.cmake.in burinConfig.cmake INSTALL_DESTINATION ${burin_cmake_dir})
write_basic_package_version_file(burinConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/burinConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/burinConfigVersion.cmake
              cmake/dependencies.cmake DESTINATION ${burin_cmake_dir})

install(DIRECTORY examples samples DESTINATION ${CMAKE_INSTALL_DATADIR}/burin PATTERN "round-*" EXCLUDE)  # what a loop made of a sample
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES README.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
