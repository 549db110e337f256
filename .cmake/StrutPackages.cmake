# SPDX-License-Identifier: GPL-3.0-or-later
# Debian packages: "cmake --workflow --preset packages" builds and makes them, or, in a build tree configured
# with the prefix /usr, "cpack -G DEB". Each is one component of the install rules; one whose files are not
# built here is left out. What only packages hold (copyright, changelogs, symbols) is added by
# packages/stage.cmake, between installation and packing.

set(STRUT_MAINTAINER "The strut developers <strut@developers.invalid>"
    CACHE STRING "Name and address of who makes the packages")

# Packages for several releases of Debian have ordered versions: 0.1.0-1~deb12 precedes 0.1.0-1~deb13.
set(STRUT_PACKAGE_RELEASE 1)
if(EXISTS /etc/os-release)
  file(STRINGS /etc/os-release strut_os REGEX "^(ID|VERSION_ID)=")
  string(REGEX REPLACE "[^0-9]" "" strut_os_version "${strut_os}")
  if(strut_os MATCHES "ID=debian" AND strut_os_version)
    string(APPEND STRUT_PACKAGE_RELEASE "~deb${strut_os_version}")
  endif()
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME strut)
set(CPACK_PACKAGE_VERSION "${PROJECT_VERSION}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "") # each package has its own
set(CPACK_PACKAGE_CONTACT "${STRUT_MAINTAINER}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_SOURCE strut)
set(CPACK_DEBIAN_PACKAGE_RELEASE "${STRUT_PACKAGE_RELEASE}")
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS "${PROJECT_BINARY_DIR}") # of libstrut.so.0
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS ON)
set(CPACK_PRE_BUILD_SCRIPTS "${PROJECT_SOURCE_DIR}/.cmake/packages/stage.cmake")
set(CPACK_STRUT_SOURCE_DIR "${PROJECT_SOURCE_DIR}")

# Lines of a description have at most 79 characters.
set(strut_about
    "strut describes planar tensegrity structures, and the robots made of them, in
a YAML file; it finds their equilibria and simulates how they move, with
contact and friction.")

# strut_package(COMPONENT PACKAGE SECTION SYNOPSIS TEXT [DEPENDS package...] [RECOMMENDS package...]
#               [SUGGESTS package...] [ON component...])
# ON: components of the same version that it depends on.
set(CPACK_COMPONENTS_ALL "")
get_cmake_property(strut_components COMPONENTS)
macro(strut_package component package section synopsis text)
  cmake_parse_arguments(arg "" "" "DEPENDS;RECOMMENDS;SUGGESTS;ON" ${ARGN})
  string(TOUPPER "${component}" upper)
  if("${component}" IN_LIST strut_components)
    list(APPEND CPACK_COMPONENTS_ALL "${component}")
    set(CPACK_COMPONENT_${upper}_DESCRIPTION "${synopsis}\n${strut_about}\n.\n${text}")
    set(CPACK_COMPONENT_${upper}_DEPENDS ${arg_ON})
    set(CPACK_DEBIAN_${upper}_PACKAGE_NAME "${package}")
    set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION "${section}")
    foreach(relation DEPENDS RECOMMENDS SUGGESTS)
      list(JOIN arg_${relation} ", " CPACK_DEBIAN_${upper}_PACKAGE_${relation})
    endforeach()
  endif()
endmacro()

strut_package(
  program strut science "simulator of planar tensegrity structures and robots"
  "This package holds the program."
  DEPENDS fonts-dejavu-core
  RECOMMENDS strut-doc
  SUGGESTS ffmpeg python3-strut)
strut_package(
  library libstrut0 libs "simulator of planar tensegrity structures - shared library"
  "This package holds the shared library, whose binary interface is stable."
  RECOMMENDS fonts-dejavu-core)
strut_package(
  development libstrut-dev libdevel "simulator of planar tensegrity structures - C headers"
  "This package holds the headers, the static libraries, and what CMake and
pkg-config read."
  ON library
  DEPENDS libarpack2-dev libcjson-dev libglpk-dev libgsl-dev libhdf5-dev libnlopt-dev
          libpango1.0-dev libsuitesparse-dev libyaml-dev zlib1g-dev
  SUGGESTS strut-doc)
strut_package(
  python python3-strut python "simulator of planar tensegrity structures - Python module"
  "This package holds the module for Python 3."
  ON library
  DEPENDS "python3 (>= 3.11)"
  RECOMMENDS python3-numpy
  SUGGESTS python3-pandas python3-matplotlib)
strut_package(
  documentation strut-doc doc "simulator of planar tensegrity structures - manual and models"
  "This package holds a tutorial, the reference, and the models they use."
  SUGGESTS strut)
set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_SHLIBDEPS OFF)

# stage.cmake finds what the library depends on, since CPack's own way adds scripts that call ldconfig.
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA
    "${PROJECT_BINARY_DIR}/control/symbols" "${PROJECT_BINARY_DIR}/control/shlibs"
    "${PROJECT_SOURCE_DIR}/.cmake/packages/library/triggers")
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA
    "${PROJECT_SOURCE_DIR}/.cmake/packages/python/postinst"
    "${PROJECT_SOURCE_DIR}/.cmake/packages/python/prerm")

include(CPack)
