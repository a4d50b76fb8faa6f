# Warnings are a property of our own targets, never of whoever uses them: link this PRIVATE.
# They are errors only where we are the ones to read them.
add_library(etcm_warnings INTERFACE)
target_compile_options(etcm_warnings INTERFACE
  -Wall -Wextra -Wconversion -Wshadow
  # GCC 12 sees overlapping copies inside std::string where there are none (its bug 105329).
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
  $<$<BOOL:${PROJECT_IS_TOP_LEVEL}>:-Werror>
)
