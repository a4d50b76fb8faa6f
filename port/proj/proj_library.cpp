#include "proj/proj_library.h"

#include <dlfcn.h>

namespace etcm::port {

namespace {

template <class Function>
bool find(void* library, const char* name, Function& function) {
  function = reinterpret_cast<Function>(dlsym(library, name));
  return function != nullptr;
}

bool find_all(void* library, ProjLibrary& proj) {
  return find(library, "proj_context_create", proj.context_create) &&
         find(library, "proj_context_destroy", proj.context_destroy) &&
         find(library, "proj_context_set_enable_network", proj.context_set_enable_network) &&
         find(library, "proj_log_level", proj.log_level) &&
         find(library, "proj_create", proj.create) &&
         find(library, "proj_create_crs_to_crs_from_pj", proj.create_crs_to_crs_from_pj) &&
         find(library, "proj_normalize_for_visualization", proj.normalize_for_visualization) &&
         find(library, "proj_get_type", proj.get_type) &&
         find(library, "proj_crs_get_coordinate_system", proj.crs_get_coordinate_system) &&
         find(library, "proj_cs_get_axis_info", proj.cs_get_axis_info) &&
         find(library, "proj_destroy", proj.destroy) && find(library, "proj_trans", proj.trans) &&
         find(library, "proj_errno_reset", proj.errno_reset);
}

}  // namespace

const ProjLibrary* load_proj(std::string& why) {
  static ProjLibrary proj;
  static bool is_loaded = false;
  if (is_loaded) return &proj;
  void* const library = dlopen(ETCM_PROJ_LIBRARY, RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    why = std::string(ETCM_PROJ_LIBRARY) + " is not installed (apt-get install " +
          ETCM_PROJ_PACKAGE + ")";
    return nullptr;
  }
  is_loaded = find_all(library, proj);
  if (is_loaded) return &proj;
  why = std::string(ETCM_PROJ_LIBRARY) + " is older than the one that this program was built with";
  dlclose(library);
  return nullptr;
}

}  // namespace etcm::port
