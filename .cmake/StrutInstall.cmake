# SPDX-License-Identifier: GPL-3.0-or-later
# Where things go: the program, the libraries, their headers as the tree they are in the repository
# (below include/strut, so that "engine/..." is spelled alike everywhere), and two descriptions for
# other projects, one for CMake, one for pkg-config; pages and models.
#
# Every rule names its component, each of which becomes a package (StrutPackages): program, library,
# development, python, documentation. Rules elsewhere that name none belong to the program.
include(CMakePackageConfigHelpers)

set(strut_package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/strut")

install(TARGETS strut RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT program)
if(NOT BUILD_SHARED_LIBS)
  install(TARGETS strut_algebra_module strut_hdf5_module strut_drawing_module
          LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}/strut" COMPONENT program)
endif()
install(
  TARGETS strut_engine strut_output strut_pictures strut_study strut_parser
  EXPORT strut
  ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT development
  LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT library NAMELINK_COMPONENT development)

# The library with the stable interface stands alone: its header, its file, find_package(strut-abi) and
# pkg-config strut-abi.
install(
  TARGETS strut_abi
  EXPORT strut-abi
  LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT library NAMELINK_COMPONENT development)
install(FILES "${PROJECT_SOURCE_DIR}/parser/bindings/abi/abi.h"
        DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/strut" COMPONENT development)
install(EXPORT strut-abi NAMESPACE strut:: FILE strut-abiConfig.cmake
        DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/strut-abi" COMPONENT development)
write_basic_package_version_file("${PROJECT_BINARY_DIR}/strut-abiConfigVersion.cmake"
                                 COMPATIBILITY SameMajorVersion)
install(FILES "${PROJECT_BINARY_DIR}/strut-abiConfigVersion.cmake"
        DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/strut-abi" COMPONENT development)

# strut.h and what it includes, all the way; nothing else is meant for others.
function(strut_public_headers result)
  set(seen)
  set(queue parser/strut.h)
  while(queue)
    list(POP_FRONT queue header)
    list(APPEND seen "${header}")
    file(STRINGS "${PROJECT_SOURCE_DIR}/${header}" includes REGEX "^#include \"")
    foreach(line IN LISTS includes)
      string(REGEX REPLACE "^#include \"([^\"]*)\".*" "\\1" included "${line}")
      if(NOT included IN_LIST seen AND NOT included IN_LIST queue)
        list(APPEND queue "${included}")
      endif()
    endforeach()
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS
                                           "${PROJECT_SOURCE_DIR}/${header}")
  endwhile()
  set(${result} ${seen} PARENT_SCOPE)
endfunction()

strut_public_headers(headers)
foreach(header IN LISTS headers)
  get_filename_component(folder "${header}" DIRECTORY)
  if(header STREQUAL "parser/strut.h")
    set(folder "")
  endif()
  install(FILES "${PROJECT_SOURCE_DIR}/${header}"
          DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/strut/${folder}" COMPONENT development)
endforeach()

# CMake: find_package(strut), targets strut::engine, strut::output, strut::pictures,
# strut::study, strut::parser.
install(EXPORT strut NAMESPACE strut:: FILE strutTargets.cmake DESTINATION "${strut_package_dir}"
        COMPONENT development)
configure_package_config_file(
  "${PROJECT_SOURCE_DIR}/.cmake/strutConfig.cmake.in" "${PROJECT_BINARY_DIR}/strutConfig.cmake"
  INSTALL_DESTINATION "${strut_package_dir}" NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file("${PROJECT_BINARY_DIR}/strutConfigVersion.cmake"
                                 COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/strutConfig.cmake"
              "${PROJECT_BINARY_DIR}/strutConfigVersion.cmake"
              "${PROJECT_SOURCE_DIR}/.cmake/FindSuiteSparse.cmake"
              "${PROJECT_SOURCE_DIR}/.cmake/FindGLPK.cmake"
        DESTINATION "${strut_package_dir}" COMPONENT development)

# pkg-config: a static libstrut needs everything named at every link, a shared one only itself.
set(strut_pc_beneath "-lhdf5_hl -lspqr -lcholmod -lglpk -lm")
if(OpenMP_C_FOUND)
  string(APPEND strut_pc_beneath " ${OpenMP_C_FLAGS}")
endif()
if(BUILD_SHARED_LIBS)
  set(strut_pc_private ".private")
  set(strut_pc_libraries "\nLibs.private: ${strut_pc_beneath}")
else()
  set(strut_pc_private "")
  set(strut_pc_libraries " ${strut_pc_beneath}")
endif()
# Its prefix is found from where the file lies, so that an installed tree may be moved.
file(RELATIVE_PATH strut_pc_prefix "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/")
foreach(name strut strut-pictures strut-abi)
  configure_file("${PROJECT_SOURCE_DIR}/.cmake/${name}.pc.in" "${PROJECT_BINARY_DIR}/${name}.pc" @ONLY)
  install(FILES "${PROJECT_BINARY_DIR}/${name}.pc"
          DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig" COMPONENT development)
endforeach()

# The pages as the tree they are in the repository. The models are data of the program, which does without
# pages where these are not wanted; links between the two folders keep those of the texts alive.
install(FILES "${PROJECT_SOURCE_DIR}/README.md" "${PROJECT_SOURCE_DIR}/CITATION.cff"
        DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT documentation)
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE"
        DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT license)
install(DIRECTORY "${PROJECT_SOURCE_DIR}/docs" DESTINATION "${CMAKE_INSTALL_DOCDIR}"
        COMPONENT documentation
        PATTERN "*.sh" EXCLUDE PATTERN "*.awk" EXCLUDE PATTERN "*.def" EXCLUDE
        PATTERN "site" EXCLUDE)
set(strut_data_dir "${CMAKE_INSTALL_DATADIR}/strut")
install(DIRECTORY "${PROJECT_SOURCE_DIR}/models" DESTINATION "${strut_data_dir}"
        COMPONENT documentation)

# strut_install_link(FOLDER NAME TARGET): FOLDER/NAME leads to TARGET, however the tree is moved.
function(strut_install_link folder name target)
  file(RELATIVE_PATH path "/${folder}" "/${target}")
  file(MAKE_DIRECTORY "${PROJECT_BINARY_DIR}/links")
  file(CREATE_LINK "${path}" "${PROJECT_BINARY_DIR}/links/${name}" SYMBOLIC)
  install(FILES "${PROJECT_BINARY_DIR}/links/${name}" DESTINATION "${folder}"
          COMPONENT documentation)
endfunction()
strut_install_link("${CMAKE_INSTALL_DOCDIR}" models "${strut_data_dir}/models")
strut_install_link("${strut_data_dir}" docs "${CMAKE_INSTALL_DOCDIR}/docs")
