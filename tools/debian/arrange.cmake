# Run by CPack on the files of each component before they become a package: puts what Debian wants
# elsewhere than `cmake --install` does, and adds the documents that every package of Debian has.
set(here "${CMAKE_CURRENT_LIST_DIR}")
set(root "${CPACK_TEMPORARY_INSTALL_DIRECTORY}")

# The service starts what is in /usr/bin, and its settings are in /etc, wherever the build was meant
# to go.
set(runtime "${root}/runtime")
if(EXISTS "${runtime}/usr/etc")
  file(RENAME "${runtime}/usr/etc" "${runtime}/etc")
endif()
set(unit "${runtime}/usr/lib/systemd/system/etcm-gateway.service")
file(READ "${unit}" text)
string(REGEX REPLACE "ExecStart=[^ ]*/etcm-gateway" "ExecStart=/usr/bin/etcm-gateway" text "${text}")
file(WRITE "${unit}" "${text}")

# Debian's packages have it as their copyright.
file(REMOVE_RECURSE "${root}/development/usr/share/doc/etcm")

function(compress file)
  execute_process(COMMAND gzip -9nf "${file}" COMMAND_ERROR_IS_FATAL ANY)
endfunction()

foreach(pair IN ITEMS "runtime=etcm-gateway" "development=libetcm-dev")
  string(REPLACE "=" ";" pair "${pair}")
  list(GET pair 0 component)
  list(GET pair 1 package)
  set(documents "${root}/${component}/usr/share/doc/${package}")
  configure_file("${here}/changelog" "${documents}/changelog" @ONLY
    FILE_PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
  compress("${documents}/changelog")
  configure_file("${here}/copyright" "${documents}/copyright" COPYONLY)
  file(GLOB pages "${root}/${component}/usr/share/man/man*/*.[0-9]")
  foreach(page IN LISTS pages)
    compress("${page}")
  endforeach()
endforeach()
