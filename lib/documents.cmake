# The documents of the library as they are installed, beside what the headers call docs/...: no link
# leads to what is not there. A header is named as a program includes it, and of other files of the
# project the name alone is left.
set(etcm_documents_folder ${CMAKE_INSTALL_DATADIR}/doc/libetcm-dev)
file(GLOB etcm_documents RELATIVE ${CMAKE_CURRENT_LIST_DIR} ${CMAKE_CURRENT_LIST_DIR}/docs/*.md)
foreach(document IN LISTS etcm_documents ITEMS README.md examples/README.md ../CHANGELOG.md)
  set(source ${CMAKE_CURRENT_LIST_DIR}/${document})
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${source})
  file(READ ${source} text)
  string(REGEX REPLACE "\\[[^]]*\\]\\((\\.\\./)*include/(etcm/[^)#]*)\\)" "`\\2`" text "${text}")
  string(REGEX REPLACE "\\[([^]]*)\\]\\((\\.\\./)*(src|tests|tools|firmware|port)/[^)]*\\)" "\\1"
    text "${text}")
  string(REPLACE "](lib/" "](" text "${text}")
  string(REPLACE "../" "" installed ${document})
  file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/documents/${installed} "${text}")
endforeach()
install(DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/documents/ DESTINATION ${etcm_documents_folder}
  COMPONENT development)
install(DIRECTORY examples DESTINATION ${etcm_documents_folder} COMPONENT development
  PATTERN CMakeLists.txt EXCLUDE PATTERN *.md EXCLUDE)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${etcm_documents_folder} COMPONENT development)
