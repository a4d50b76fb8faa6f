# etcm_mesh_variant(NAME [ID_BITS 16|32] [FORCE_LIMBS] [UNCHECKED] [ANALYSIS] [JOINED]
#                   [OPTIONS option...])
#
# The library once more, compiled in another way than this build's own: an object library of the
# same sources with the same flags, and OPTIONS after them; UNCHECKED without checks of arguments;
# with ANALYSIS those of etcm_analysis too; JOINED into one source, which is sooner compiled. For tests.
function(etcm_mesh_variant name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "FORCE_LIMBS;UNCHECKED;ANALYSIS;JOINED" "ID_BITS" "OPTIONS")
  if(NOT arg_ID_BITS)
    set(arg_ID_BITS ${ETCM_ID_BITS})
  endif()
  get_target_property(folder etcm_mesh SOURCE_DIR)
  get_target_property(sources etcm_mesh SOURCES)
  if(arg_ANALYSIS)
    get_target_property(more etcm_analysis SOURCES)
    list(APPEND sources ${more})
  endif()
  get_target_property(options etcm_mesh COMPILE_OPTIONS)
  list(TRANSFORM sources PREPEND "${folder}/")

  add_library(${name} OBJECT ${sources})
  set_target_properties(${name} PROPERTIES UNITY_BUILD ${arg_JOINED} UNITY_BUILD_BATCH_SIZE 0)
  target_compile_features(${name} PUBLIC cxx_std_20)
  target_include_directories(${name} PUBLIC "${folder}/include" PRIVATE "${folder}/src")
  target_compile_definitions(${name} PUBLIC ETCM_ID_BITS=${arg_ID_BITS}
    $<$<AND:$<BOOL:${ETCM_CHECK_ARGUMENTS}>,$<NOT:$<BOOL:${arg_UNCHECKED}>>>:ETCM_CHECK_ARGUMENTS>
    $<$<BOOL:${ETCM_VERIFY}>:ETCM_VERIFY>
    $<$<BOOL:${arg_FORCE_LIMBS}>:ETCM_FORCE_LIMBS>)
  target_compile_options(${name} PRIVATE ${options} ${arg_OPTIONS})
  # Where they are joined, names shadow each other that never meet in the library.
  if(NOT arg_JOINED)
    target_link_libraries(${name} PRIVATE etcm_warnings)
  endif()
endfunction()
