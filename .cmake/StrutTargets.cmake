# SPDX-License-Identifier: GPL-3.0-or-later
# How every target of strut is compiled, and the functions that make one.

set(STRUT_WARNINGS
    -Wall -Wextra -Wpedantic -Wshadow -Wstrict-prototypes -Wmissing-prototypes -Wvla -Wconversion
    -Wdouble-promotion -Wundef)

# A test preset keeps assertions at full optimisation; only Release drops them.
set(CMAKE_C_FLAGS_RELEASE "-O3 -DNDEBUG")
set(CMAKE_C_FLAGS_RELWITHDEBINFO "-O3 -g")
if(EMSCRIPTEN) # a page is loaded; what takes the time of a step says so itself
  set(CMAKE_C_FLAGS_RELEASE "-Oz -DNDEBUG -msimd128")
endif()

# strut_compile_options(TARGET): the same language, definitions and floating-point rules everywhere,
# so that a result's bits do not depend on who compiled what.
function(strut_compile_options target)
  set_target_properties(
    ${target}
    PROPERTIES C_STANDARD 17
               C_STANDARD_REQUIRED ON
               C_EXTENSIONS OFF
               C_VISIBILITY_PRESET hidden
               POSITION_INDEPENDENT_CODE ON) # static libraries are parts of libstrut.so.0, too
  target_compile_definitions(${target} PRIVATE _POSIX_C_SOURCE=200809L
                                               STRUT_VERSION="${PROJECT_VERSION}")
  target_compile_options(${target} PRIVATE ${STRUT_WARNINGS} -ffp-contract=off -fno-math-errno
                                           -Wno-psabi)
  if(EMSCRIPTEN) # clang 14 drops terms where it vectorises arithmetic.h under -Oz
    target_compile_options(${target} PRIVATE -fno-slp-vectorize)
  else()
    target_compile_options(${target} PRIVATE -fno-semantic-interposition)
  endif()
  if(STRUT_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(STRUT_SANITIZE OR STRUT_FUZZ)
    # Function multiversioning resolves symbols before the sanitizers have started.
    target_compile_definitions(${target} PRIVATE STRUT_NO_CLONES)
    set(sanitizers -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
    if(STRUT_FUZZ)
      list(APPEND sanitizers -fsanitize=fuzzer-no-link)
    endif()
    target_compile_options(${target} PRIVATE ${sanitizers})
    target_link_options(${target} PRIVATE ${sanitizers})
  endif()
endfunction()

# strut_library(ROOM SOURCE...): the library strut_ROOM; other projects know it as strut::ROOM.
function(strut_library room)
  set(name strut_${room})
  add_library(${name} ${ARGN})
  add_library(strut::${room} ALIAS ${name})
  strut_compile_options(${name})
  target_include_directories(
    ${name} PUBLIC "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>"
                   "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/strut>")
  set_target_properties(
    ${name}
    PROPERTIES EXPORT_NAME ${room}
               VERSION ${PROJECT_VERSION}
               SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
endfunction()

# strut_module(NAME SOURCE...): modules/strut-NAME.so, which the program loads by itself and which calls functions of the program.
function(strut_module name)
  add_library(strut_${name}_module MODULE ${ARGN})
  strut_compile_options(strut_${name}_module)
  target_include_directories(strut_${name}_module PRIVATE "${PROJECT_SOURCE_DIR}")
  target_link_options(strut_${name}_module PRIVATE -Wl,--as-needed)
  set_target_properties(
    strut_${name}_module PROPERTIES PREFIX "" OUTPUT_NAME strut-${name}
                                    LIBRARY_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/modules")
endfunction()

# strut_all_listed(FOLDER TARGET...): says which source files of FOLDER none of the targets has, so
# that a new file does not stay out of the build unnoticed.
function(strut_all_listed folder)
  file(GLOB_RECURSE there CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/${folder}/*.c")
  list(FILTER there EXCLUDE REGEX "/web/") # built by the preset web
  foreach(target IN LISTS ARGN)
    if(TARGET ${target})
      get_target_property(sources ${target} SOURCES)
      get_target_property(home ${target} SOURCE_DIR)
      list(TRANSFORM sources PREPEND "${home}/")
      list(REMOVE_ITEM there ${sources})
    endif()
  endforeach()
  if(there)
    list(JOIN there "\n  " there)
    message(WARNING "Built nowhere, because no list of sources names them:\n  ${there}")
  endif()
endfunction()
