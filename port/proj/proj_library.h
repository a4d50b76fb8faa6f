// The functions of PROJ that are used, from its shared library.
#pragma once

#include <proj.h>

#include <string>

namespace etcm::port {

struct ProjLibrary {
  decltype(&::proj_context_create) context_create = nullptr;
  decltype(&::proj_context_destroy) context_destroy = nullptr;
  decltype(&::proj_context_set_enable_network) context_set_enable_network = nullptr;
  decltype(&::proj_log_level) log_level = nullptr;
  decltype(&::proj_create) create = nullptr;
  decltype(&::proj_create_crs_to_crs_from_pj) create_crs_to_crs_from_pj = nullptr;
  decltype(&::proj_normalize_for_visualization) normalize_for_visualization = nullptr;
  decltype(&::proj_get_type) get_type = nullptr;
  decltype(&::proj_crs_get_coordinate_system) crs_get_coordinate_system = nullptr;
  decltype(&::proj_cs_get_axis_info) cs_get_axis_info = nullptr;
  decltype(&::proj_destroy) destroy = nullptr;
  decltype(&::proj_trans) trans = nullptr;
  decltype(&::proj_errno_reset) errno_reset = nullptr;
};

// The same at each call; loaded at the first, and never let go. Null where the system has none:
// then `why` says so, and a later call tries again. One call at a time.
const ProjLibrary* load_proj(std::string& why);

}  // namespace etcm::port
