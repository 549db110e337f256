# SPDX-License-Identifier: GPL-3.0-or-later
# SuiteSparse::NAME for each component, such as CHOLMOD or SPQR.
#
# SuiteSparse 7 brings a CMake config per component; 5.12 (Debian 12) brings neither that nor a
# pkg-config file, so its header and library are looked for by name.
include(FindPackageHandleStandardArgs)

find_path(SuiteSparse_INCLUDE_DIR NAMES cholmod.h PATH_SUFFIXES suitesparse)
mark_as_advanced(SuiteSparse_INCLUDE_DIR)

foreach(component IN LISTS SuiteSparse_FIND_COMPONENTS)
  if(NOT TARGET SuiteSparse::${component})
    find_package(${component} CONFIG QUIET)
  endif()
  if(NOT TARGET SuiteSparse::${component})
    string(TOLOWER ${component} library)
    find_library(SuiteSparse_${component}_LIBRARY NAMES ${library})
    mark_as_advanced(SuiteSparse_${component}_LIBRARY)
    if(SuiteSparse_INCLUDE_DIR AND SuiteSparse_${component}_LIBRARY)
      add_library(SuiteSparse::${component} UNKNOWN IMPORTED)
      set_target_properties(
        SuiteSparse::${component}
        PROPERTIES IMPORTED_LOCATION "${SuiteSparse_${component}_LIBRARY}"
                   INTERFACE_INCLUDE_DIRECTORIES "${SuiteSparse_INCLUDE_DIR}")
    endif()
  endif()
  if(TARGET SuiteSparse::${component})
    set(SuiteSparse_${component}_FOUND TRUE)
  endif()
endforeach()

find_package_handle_standard_args(SuiteSparse REQUIRED_VARS SuiteSparse_INCLUDE_DIR
                                  HANDLE_COMPONENTS)
