# etcm_runnable(VARIABLE TARGET)
#
# Sets the variable to a path that runs the target's program on this machine, for tests that start
# programs: the program itself, or in a cross build ${CMAKE_BINARY_DIR}/run/TARGET, a script that
# runs it under the emulator.
function(etcm_runnable variable target)
  set(path "$<TARGET_FILE:${target}>")
  if(CMAKE_CROSSCOMPILING_EMULATOR)
    set(script "${CMAKE_BINARY_DIR}/run/${target}")
    get_property(is_made TARGET ${target} PROPERTY etcm_run_script)
    if(NOT is_made)
      list(JOIN CMAKE_CROSSCOMPILING_EMULATOR " " emulator)
      file(GENERATE OUTPUT "${script}"
        CONTENT "#!/bin/sh\nexec ${emulator} '${path}' \"$@\"\n"
        FILE_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE)
      set_property(TARGET ${target} PROPERTY etcm_run_script "${script}")
    endif()
    set(path "${script}")
  endif()
  set(${variable} "${path}" PARENT_SCOPE)
endfunction()
