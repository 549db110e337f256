# SPDX-License-Identifier: GPL-3.0-or-later
# What the program tells about itself, made by running it after it was built, and installed: the schema of
# the language for editors, and the manual page. A cross-compiled program that nothing here can run goes without.
if(CMAKE_CROSSCOMPILING AND NOT CMAKE_CROSSCOMPILING_EMULATOR)
  return()
endif()

set(strut_described "") # the files

# strut_describe(FILE WORD...): FILE is what "strut WORD..." prints.
function(strut_describe file)
  set(path "${PROJECT_BINARY_DIR}/descriptions/${file}")
  get_filename_component(folder "${path}" DIRECTORY)
  file(MAKE_DIRECTORY "${folder}")
  add_custom_command(OUTPUT "${path}" COMMAND strut ${ARGN} > "${path}" DEPENDS strut VERBATIM
                     COMMENT "")
  set(strut_described ${strut_described} "${path}" PARENT_SCOPE)
endfunction()

# strut_describe_and_install(FOLDER FILE WORD...): the same, installed below share/FOLDER.
macro(strut_describe_and_install folder file)
  strut_describe(${file} ${ARGN})
  install(FILES "${PROJECT_BINARY_DIR}/descriptions/${file}"
          DESTINATION "${CMAKE_INSTALL_DATADIR}/${folder}" COMPONENT program)
endmacro()

strut_describe_and_install(strut strut-1.schema.json keys --schema)
strut_describe_and_install(strut strut-1.study.schema.json keys --schema --study)
install(FILES "${PROJECT_SOURCE_DIR}/parser/program/strut.bash" RENAME strut COMPONENT program
        DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions")

# The manual page, for packages; help2man takes its date from SOURCE_DATE_EPOCH.
find_program(HELP2MAN help2man)
if(HELP2MAN)
  execute_process(COMMAND date -u -d "${STRUT_DATE}" +%s OUTPUT_VARIABLE seconds
                  OUTPUT_STRIP_TRAILING_WHITESPACE)
  set(page "${PROJECT_BINARY_DIR}/descriptions/strut.1")
  add_custom_command(
    OUTPUT "${page}" DEPENDS strut VERBATIM COMMENT ""
    COMMAND ${CMAKE_COMMAND} -E env SOURCE_DATE_EPOCH=${seconds} "${HELP2MAN}" --no-info
            --name "planar structures of bars, springs and cables" --output "${page}" $<TARGET_FILE:strut>)
  list(APPEND strut_described "${page}")
  install(FILES "${page}" DESTINATION "${CMAKE_INSTALL_MANDIR}/man1" COMPONENT program)
endif()

add_custom_target(strut_descriptions ALL DEPENDS ${strut_described})
