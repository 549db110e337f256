# SPDX-License-Identifier: GPL-3.0-or-later
# Run by CPack (StrutPackages) between installation and packing: adds to each component's files what a Debian
# package has besides, the same bytes each time: copyright and changelogs, compressed pages of the manual; no
# sections that nobody reads; symbols and dependencies of the shared library. Every date is SOURCE_DATE_EPOCH, by default that of the
# last commit.

cmake_policy(VERSION 3.25)
find_program(gzip gzip REQUIRED)
find_program(strip strip REQUIRED)
set(here "${CPACK_STRUT_SOURCE_DIR}/.cmake/packages")
set(version "${CPACK_PACKAGE_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}")

# CPack reads the variable, too, and gives this date to all files.
if(NOT DEFINED ENV{SOURCE_DATE_EPOCH})
  execute_process(
    COMMAND git -C "${CPACK_STRUT_SOURCE_DIR}" log -1 --format=%ct
    OUTPUT_VARIABLE epoch OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(NOT epoch)
    file(TIMESTAMP "${CPACK_STRUT_SOURCE_DIR}/docs/changelog.md" epoch "%s" UTC)
  endif()
  set(ENV{SOURCE_DATE_EPOCH} "${epoch}")
endif()
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)

file(READ "${CPACK_STRUT_SOURCE_DIR}/engine/output/page/dygraphs_notice.txt" expat)
string(STRIP "${expat}" expat)
string(REGEX REPLACE "\n\n" "\n.\n" expat "${expat}")
string(REGEX REPLACE "\n" "\n " expat " ${expat}")

# compress(FILE): FILE becomes FILE.gz, without its name and date.
function(compress file)
  execute_process(COMMAND "${gzip}" -9nf "${file}" COMMAND_ERROR_IS_FATAL ANY)
  file(CHMOD "${file}.gz" PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
endfunction()

# library_control(FOLDER): the symbols and shlibs of the library below FOLDER, and what it depends on.
function(library_control folder)
  get_filename_component(build "${CPACK_TOPLEVEL_DIRECTORY}/../../.." ABSOLUTE)
  set(control "${build}/control")
  file(REMOVE_RECURSE "${control}")
  file(MAKE_DIRECTORY "${control}/debian")
  file(WRITE "${control}/debian/control"
       "Source: strut\n\nPackage: libstrut0\nArchitecture: any\n")
  file(GLOB libraries "${folder}/usr/lib/*/libstrut.so.0" "${folder}/usr/lib/libstrut.so.0")
  execute_process(
    COMMAND dpkg-gensymbols -q -plibstrut0 -v${CPACK_PACKAGE_VERSION} "-P${folder}"
            "-O${control}/symbols"
    WORKING_DIRECTORY "${control}" COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET ERROR_QUIET)
  file(READ "${control}/symbols" symbols)
  string(REPLACE " #MINVER#\n" " #MINVER#\n* Build-Depends-Package: libstrut-dev\n" symbols "${symbols}")
  file(WRITE "${control}/symbols" "${symbols}")
  file(WRITE "${control}/shlibs" "libstrut 0 libstrut0 (>= ${CPACK_PACKAGE_VERSION})\n")
  execute_process(
    COMMAND dpkg-shlibdeps -O ${libraries}
    WORKING_DIRECTORY "${control}" COMMAND_ERROR_IS_FATAL ANY OUTPUT_VARIABLE depends ERROR_QUIET)
  string(REGEX REPLACE "^.*Depends=|\n" "" depends "${depends}")
  set(CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS "${depends}" PARENT_SCOPE)
endfunction()

foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  set(folder "${CPACK_TEMPORARY_DIRECTORY}/${component}")
  string(TOUPPER "${component}" upper)
  set(doc "${folder}/usr/share/doc/${CPACK_DEBIAN_${upper}_PACKAGE_NAME}")
  configure_file("${here}/copyright.in" "${doc}/copyright" @ONLY)
  configure_file("${here}/changelog.in" "${doc}/changelog.Debian" @ONLY)
  file(COPY_FILE "${CPACK_STRUT_SOURCE_DIR}/docs/changelog.md" "${doc}/changelog")
  compress("${doc}/changelog.Debian")
  compress("${doc}/changelog")
  file(GLOB_RECURSE binaries "${folder}/usr/bin/strut" "${folder}/*.so*" "${folder}/*.a")
  foreach(binary IN LISTS binaries)
    if(NOT IS_SYMLINK "${binary}")
      set(how --strip-unneeded)
      if(binary MATCHES "[.]a$")
        set(how --strip-debug)
      endif()
      execute_process(
        COMMAND "${strip}" ${how} --enable-deterministic-archives -R .comment -R .note "${binary}"
        COMMAND_ERROR_IS_FATAL ANY)
    endif()
  endforeach()
  file(GLOB pages "${folder}/usr/share/man/*/*.[1-9]")
  foreach(page IN LISTS pages)
    compress("${page}")
  endforeach()
  execute_process(COMMAND find "${folder}" -type d -exec chmod 755 {} + COMMAND_ERROR_IS_FATAL ANY)
  file(CHMOD "${doc}/copyright" PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
  if(component STREQUAL "library")
    library_control("${folder}")
  endif()
endforeach()
