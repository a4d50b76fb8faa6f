# The reference of the library as HTML, by Doxygen where it is installed: the target etcm_reference,
# a part of all. A warning is an error.
find_package(Doxygen QUIET)
find_package(Python3 QUIET COMPONENTS Interpreter)
if(NOT DOXYGEN_FOUND OR NOT Python3_FOUND)
  message(STATUS "No reference as HTML: it takes doxygen and Python")
  return()
endif()
set(ETCM_REFERENCE_FOLDER ${CMAKE_CURRENT_BINARY_DIR}/reference)
configure_file(${CMAKE_CURRENT_LIST_DIR}/Doxyfile.in ${CMAKE_CURRENT_BINARY_DIR}/Doxyfile @ONLY)
# Not CONFIGURE_DEPENDS, with which no build can be planned before it is configured again.
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS
  ${CMAKE_CURRENT_LIST_DIR}/include/etcm ${CMAKE_CURRENT_LIST_DIR}/include/etcm/c)
file(GLOB etcm_headers ${CMAKE_CURRENT_LIST_DIR}/include/etcm/*.h
  ${CMAKE_CURRENT_LIST_DIR}/include/etcm/c/*.h)
set(etcm_reference_page ${ETCM_REFERENCE_FOLDER}/html/index.html)
file(MAKE_DIRECTORY ${ETCM_REFERENCE_FOLDER})
add_custom_command(OUTPUT ${etcm_reference_page}
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${ETCM_REFERENCE_FOLDER}/html
  COMMAND ${DOXYGEN_EXECUTABLE} ${CMAKE_CURRENT_BINARY_DIR}/Doxyfile
  DEPENDS ${etcm_headers} ${CMAKE_CURRENT_LIST_DIR}/reference_filter.py
    ${CMAKE_CURRENT_LIST_DIR}/reference_main.dox ${CMAKE_CURRENT_BINARY_DIR}/Doxyfile
  COMMENT "Reference of the library" VERBATIM)
add_custom_target(etcm_reference ALL DEPENDS ${etcm_reference_page})
# Not there where only a part has been built.
install(DIRECTORY ${ETCM_REFERENCE_FOLDER}/html
  DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libetcm-dev COMPONENT development OPTIONAL)
