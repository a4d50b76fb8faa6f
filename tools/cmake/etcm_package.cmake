# Debian packages by CPack, from the install components: etcm-gateway has the programs and the
# service, libetcm-dev what a compiler needs. tools/package makes them for all architectures.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME etcm)
# The project has no mailbox; the name example.org is kept free for such places.
set(CPACK_PACKAGE_CONTACT "The ETCM mesh authors <etcm@example.org>")
# Each package has its own.
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL runtime development)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
if(etcm_architecture)
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE ${etcm_architecture})
endif()

set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME etcm-gateway)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION net)
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION
"gateway that keeps a Delaunay mesh of position nodes on Modbus
Collects where sensor nodes stand over Modbus RTU and TCP, keeps a Delaunay
mesh of them in which roads, fences and banks are edges, and publishes it as
Modbus registers, files and a page.

With it come etcm-bus, for a laptop on the bus, etcm-nodes, which simulates
nodes, and etcm, which meshes files.")
# What the programs link is found where they run; elsewhere tools/package says it.
set(ETCM_PACKAGE_DEPENDS "" CACHE STRING
  "Depends of the package etcm-gateway, where its libraries are not those of this machine")
if(ETCM_PACKAGE_DEPENDS)
  set(CPACK_DEBIAN_RUNTIME_PACKAGE_DEPENDS "${ETCM_PACKAGE_DEPENDS}")
else()
  set(CPACK_DEBIAN_RUNTIME_PACKAGE_SHLIBDEPS ON)
endif()
# Loaded where a site is in degrees.
if(TARGET etcm::proj)
  set(CPACK_DEBIAN_RUNTIME_PACKAGE_RECOMMENDS "${ETCM_PROJ_PACKAGE}")
endif()
set(etcm_debian "${PROJECT_SOURCE_DIR}/tools/debian")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_CONTROL_EXTRA
  "${etcm_debian}/conffiles" "${etcm_debian}/postinst" "${etcm_debian}/prerm"
  "${etcm_debian}/postrm")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libetcm-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION
"conforming Delaunay meshes in fixed memory, for C++
A library that needs neither heap nor operating system: nodes join, leave and
move, features are unions of edges exactly, and every call that cannot succeed
changes nothing. Static library, headers, CMake and pkg-config files.")

set(CPACK_PRE_BUILD_SCRIPTS "${etcm_debian}/arrange.cmake")
include(CPack)
