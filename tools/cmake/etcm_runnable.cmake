# etcm_runnable(VARIABLE TARGET)
#
# Sets the variable to a path that runs the target's program on this machine, for tests that start
# programs: the program itself, or in a cross build ${CMAKE_BINARY_DIR}/run/TARGET, a script that
# runs it under the emulator.
function(etcm_runnable variable target)
  set(path "$<TARGET_FILE:${target}>")
  if(CMAKE_CROSSCOMPILING_EMULATOR)
    list(JOIN CMAKE_CROSSCOMPILING_EMULATOR " " emulator)
    file(GENERATE OUTPUT "${CMAKE_BINARY_DIR}/run/${target}"
      CONTENT "#!/bin/sh\nexec ${emulator} '${path}' \"$@\"\n"
      FILE_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE)
    set(path "${CMAKE_BINARY_DIR}/run/${target}")
  endif()
  set(${variable} "${path}" PARENT_SCOPE)
endfunction()
