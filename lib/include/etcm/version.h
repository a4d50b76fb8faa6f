// Which version of the library this header belongs to; for C and C++. Semantic versioning: before
// 1.0 a minor version may break its users.
#pragma once

#define ETCM_VERSION_MAJOR 0
#define ETCM_VERSION_MINOR 1
#define ETCM_VERSION_PATCH 0
#define ETCM_VERSION_STRING "0.1.0"
// One number that grows, for #if ETCM_VERSION >= 10203 (1.2.3).
#define ETCM_VERSION (ETCM_VERSION_MAJOR * 10000 + ETCM_VERSION_MINOR * 100 + ETCM_VERSION_PATCH)
