# etcm_command_line(TARGET): the target is a main.cpp that reads a command line with CLI11. That is
# all headers, and a command line is read once: not worth the time it takes to optimise them.
function(etcm_command_line target)
  target_link_libraries(${target} PRIVATE CLI11::CLI11)
  target_compile_options(${target} PRIVATE
    $<$<CONFIG:Release>:-O1> $<$<CONFIG:RelWithDebInfo>:-O0>
  )
endfunction()
