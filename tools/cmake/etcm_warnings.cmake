# Warnings are a property of our own targets, never of whoever uses them: link this PRIVATE.
add_library(etcm_warnings INTERFACE)
target_compile_options(etcm_warnings INTERFACE -Wall -Wextra -Wconversion -Wshadow -Werror)
