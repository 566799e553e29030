# After `cmake --install`, another project says find_package(burin) and links burin::render, burin::calib, ... Installed are the
# libraries, their public headers (PUBLIC_HEADERS in each room's CMakeLists.txt), the program with its manual pages and completion, and
# under share/ the sample, the examples and the documents.
include(CMakePackageConfigHelpers)
set(burin_rooms base pictures scene render optimize)
if(NOT BURIN_CORE)
  list(APPEND burin_rooms capture simulate calib)
endif()
list(TRANSFORM burin_rooms PREPEND burin_ OUTPUT_VARIABLE burin_targets)
install(TARGETS ${burin_targets} EXPORT burinTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
        FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
if(NOT BURIN_CORE)
  install(TARGETS burin RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  install(FILES tools/studio/burin-studio.desktop DESTINATION ${CMAKE_INSTALL_DATADIR}/applications)
  install(FILES tools/studio/burin.svg DESTINATION ${CMAKE_INSTALL_DATADIR}/icons/hicolor/scalable/apps)
endif()

set(burin_cmake_dir ${CMAKE_INSTALL_LIBDIR}/cmake/burin)
install(EXPORT burinTargets NAMESPACE burin:: DESTINATION ${burin_cmake_dir})
configure_package_config_file(cmake/burinConfig.cmake.in burinConfig.cmake INSTALL_DESTINATION ${burin_cmake_dir})
write_basic_package_version_file(burinConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/burinConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/burinConfigVersion.cmake
              cmake/burin_needs.cmake cmake/dependencies.cmake DESTINATION ${burin_cmake_dir})

install(DIRECTORY examples samples DESTINATION ${CMAKE_INSTALL_DATADIR}/burin PATTERN "round-*" EXCLUDE)  # what a loop made of a sample
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES README.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY ${PROJECT_BINARY_DIR}/manual/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 OPTIONAL FILES_MATCHING PATTERN "*.1")
install(FILES ${PROJECT_BINARY_DIR}/manual/burin.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME burin
        OPTIONAL)
install(FILES ${PROJECT_BINARY_DIR}/manual/burin.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d OPTIONAL)
install(FILES ${PROJECT_BINARY_DIR}/manual/_burin DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions OPTIONAL)

# `cpack --config build/release/CPackConfig.cmake` makes a Debian package, whose dependencies are those of the files in it.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME burin)
set(CPACK_PACKAGE_CONTACT "Burin's makers <burin@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
include(CPack)
