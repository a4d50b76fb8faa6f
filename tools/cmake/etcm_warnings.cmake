# Warnings are a property of our own targets, never of whoever uses them: link this PRIVATE.
# They are errors where CMakePresets.json says so, for our own builds alone.
add_library(etcm_warnings INTERFACE)
target_compile_options(etcm_warnings INTERFACE
  -Wall -Wextra -Wconversion -Wshadow
  # GCC 12 sees overlapping copies inside std::string where there are none (its bug 105329).
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
)
