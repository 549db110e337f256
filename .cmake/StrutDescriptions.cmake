# SPDX-License-Identifier: GPL-3.0-or-later
# What the program tells about itself, made by running it after it was built, and installed: the schema of
# the language for editors, the completion scripts of shells, the manual. A cross-compiled program that nothing here can run goes without.
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
# Where bash-completion looks, and Debian's zsh and fish.
strut_describe_and_install(bash-completion/completions strut help --completion bash)
strut_describe_and_install(zsh/vendor-completions _strut help --completion zsh)
strut_describe_and_install(fish/vendor_completions.d strut.fish help --completion fish)

# Manual pages: of the program, of each command in the table of commands.c, of the language.
strut_describe_and_install(man/man1 strut.1 help --man)
strut_describe_and_install(man/man5 strut-model.5 help --man model)
set(commands "${PROJECT_SOURCE_DIR}/parser/program/commands.c")
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${commands}")
file(STRINGS "${commands}" rows REGEX "^    {\"[A-Za-z, ]+\", &strut_command_[a-z]+},$")
foreach(row IN LISTS rows)
  string(REGEX REPLACE ".*&strut_command_([a-z]+).*" "\\1" command "${row}")
  strut_describe_and_install(man/man1 strut-${command}.1 help --man ${command})
endforeach()

add_custom_target(strut_descriptions ALL DEPENDS ${strut_described})
