# What makes the installed tree findable: find_package(etcm) and pkg-config.
# Other folders add their targets with install(TARGETS ... EXPORT etcm-targets),
# COMPONENT development for what a compiler needs, programs for what a user runs.
include(CMakePackageConfigHelpers)

set(etcm_package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/etcm")

install(EXPORT etcm-targets NAMESPACE etcm::
  DESTINATION ${etcm_package_dir} COMPONENT development
)

configure_package_config_file(
  "${CMAKE_CURRENT_LIST_DIR}/etcm-config.cmake.in"
  "${PROJECT_BINARY_DIR}/etcm-config.cmake"
  INSTALL_DESTINATION ${etcm_package_dir}
)
# Before 1.0 a minor version may break its users.
write_basic_package_version_file(
  "${PROJECT_BINARY_DIR}/etcm-config-version.cmake"
  COMPATIBILITY SameMinorVersion
)
install(FILES
  "${PROJECT_BINARY_DIR}/etcm-config.cmake"
  "${PROJECT_BINARY_DIR}/etcm-config-version.cmake"
  DESTINATION ${etcm_package_dir} COMPONENT development
)

install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/etcm
  COMPONENT development)

# Relative, so that the tree can be moved.
file(RELATIVE_PATH etcm_pc_prefix
  "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/"
)
configure_file("${CMAKE_CURRENT_LIST_DIR}/etcm.pc.in" "${PROJECT_BINARY_DIR}/etcm.pc" @ONLY)
install(FILES "${PROJECT_BINARY_DIR}/etcm.pc"
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development
)

# One header and one source, for machines that no package is for. Made as it is installed, so it is
# never that of older sources.
find_package(Python3 QUIET COMPONENTS Interpreter)
if(Python3_FOUND)
  install(CODE "
    set(folder \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DATADIR}/etcm/drop-in\")
    message(STATUS \"Installing: \${folder}\")
    execute_process(COMMAND \"${Python3_EXECUTABLE}\" \"${PROJECT_SOURCE_DIR}/tools/drop_in\" \"\${folder}\"
      COMMAND_ERROR_IS_FATAL ANY)"
    COMPONENT development)
endif()
