# SPDX-License-Identifier: GPL-3.0-or-later
# For WebAssembly: the libraries that strut uses, compiled from the sources of Debian's packages as they are. The
# targets have the names that find_package and pkg-config give them elsewhere.
#
# A source is Debian's upstream archive with Debian's patches, both checked by hash; the build directory keeps them.
# -DFETCHCONTENT_BASE_DIR=FOLDER keeps them elsewhere, for several builds.

# emcc starts Python and node for each file, which takes longer than most files do: clang is called as emcc calls it.
execute_process(COMMAND "${CMAKE_C_COMPILER}" --cflags OUTPUT_VARIABLE flags OUTPUT_STRIP_TRAILING_WHITESPACE
                COMMAND_ERROR_IS_FATAL ANY)
find_program(STRUT_WEB_CLANG NAMES clang-14 clang REQUIRED)
set(CMAKE_C_COMPILE_OBJECT
    "\"${STRUT_WEB_CLANG}\" ${flags} <DEFINES> <INCLUDES> <FLAGS> -o <OBJECT> -c <SOURCE>")

include(FetchContent)
find_program(STRUT_PATCH patch REQUIRED)

set(STRUT_DEBIAN "http://deb.debian.org/debian" CACHE STRING "Where Debian's sources are")
set(STRUT_DEBIAN_ARCHIVE "https://snapshot.debian.org/archive/debian/20251001T000000Z"
    CACHE STRING "Where they are once Debian has newer ones")

# strut_debian_source(NAME FOLDER ARCHIVE HASH PATCHES HASH): NAME_SOURCE_DIR has the patched source.
function(strut_debian_source name folder archive archive_hash patches patches_hash)
  foreach(part IN ITEMS archive patches)
    FetchContent_Declare(
      ${name}_${part}
      URL "${STRUT_DEBIAN}/pool/main/${folder}/${${part}}"
          "${STRUT_DEBIAN_ARCHIVE}/pool/main/${folder}/${${part}}"
      URL_HASH SHA256=${${part}_hash}
      DOWNLOAD_EXTRACT_TIMESTAMP ON)
    FetchContent_GetProperties(${name}_${part})
    if(NOT ${name}_${part}_POPULATED)
      FetchContent_Populate(${name}_${part})
    endif()
  endforeach()
  set(source "${${name}_archive_SOURCE_DIR}")
  set(series "${${name}_patches_SOURCE_DIR}/patches/series")
  if(EXISTS "${series}" AND NOT EXISTS "${source}/patched")
    file(STRINGS "${series}" names REGEX "^[^#]")
    foreach(patch IN LISTS names)
      execute_process(
        COMMAND "${STRUT_PATCH}" -p1 --quiet -i "${${name}_patches_SOURCE_DIR}/patches/${patch}"
        WORKING_DIRECTORY "${source}" COMMAND_ERROR_IS_FATAL ANY)
    endforeach()
    file(TOUCH "${source}/patched")
  endif()
  set(${name}_SOURCE_DIR "${source}" PARENT_SCOPE)
endfunction()

# strut_web_library(NAME ALIAS SOURCE...): one that other people wrote: no warnings of ours.
function(strut_web_library name alias)
  add_library(${name} STATIC ${ARGN})
  add_library(${alias} ALIAS ${name})
  target_compile_options(${name} PRIVATE -w -ffp-contract=off)
endfunction()

# ---- GSL: the folders that strut uses ----

strut_debian_source(
  gsl g/gsl gsl_2.7.1+dfsg.orig.tar.gz
  e560d6b9c6e254e46769bbb03583c00ecafbdd51b062c55db23b3b9612868567
  gsl_2.7.1+dfsg-5+deb12u1.debian.tar.xz
  c48c5cd287b15844092e9c392c12b9bc385f0ab86f157184de5cc23c8963652b)
set(gsl_include "${CMAKE_BINARY_DIR}/gsl_include")
file(GLOB gsl_headers "${gsl_SOURCE_DIR}/gsl_*.h" "${gsl_SOURCE_DIR}/*/gsl_*.h")
file(COPY ${gsl_headers} DESTINATION "${gsl_include}/gsl")
# What its configure finds of a C17 compiler with IEEE arithmetic.
file(WRITE "${gsl_include}/config.h"
     "#define HAVE_INLINE 1\n#define HAVE_C99_INLINE 1\n#define HAVE_IEEE_COMPARISONS 1\n"
     "#define HAVE_IEEE_DENORMALS 1\n#define HAVE_EXIT_SUCCESS_AND_FAILURE 1\n"
     "#define HAVE_DECL_ISNAN 1\n#define HAVE_DECL_ISINF 1\n#define HAVE_DECL_ISFINITE 1\n"
     "#define HAVE_DECL_FINITE 1\n#define HAVE_DECL_LOG1P 1\n#define HAVE_DECL_LDEXP 1\n"
     "#define HAVE_DECL_HYPOT 1\n#define HAVE_DECL_FREXP 1\n#define HAVE_DECL_EXPM1 1\n"
     "#define HAVE_DECL_ACOSH 1\n#define HAVE_DECL_ASINH 1\n#define HAVE_DECL_ATANH 1\n"
     "#define RELEASED 1\n#define GSL_COERCE_DBL(x) (x)\n"
     "#define RETURN_IF_NULL(x) if (!x) { return ; }\n")
set(gsl_sources "${gsl_SOURCE_DIR}/cdf/gaussinv.c" "${gsl_SOURCE_DIR}/randist/gauss.c")
foreach(folder IN ITEMS blas block complex eigen err interpolation linalg matrix permutation qrng rng sort sys vector)
  file(GLOB sources "${gsl_SOURCE_DIR}/${folder}/*.c")
  list(APPEND gsl_sources ${sources})
endforeach()
file(GLOB gsl_cblas_sources "${gsl_SOURCE_DIR}/cblas/*.c")
# Programs, and texts that other files include.
set(gsl_others "/(test[^/]*|[^/]*_source|apply_givens|cholesky_common|svdstep|qrstep|rng-dump)\\.c$")
list(FILTER gsl_sources EXCLUDE REGEX "${gsl_others}")
list(FILTER gsl_cblas_sources EXCLUDE REGEX "${gsl_others}")
strut_web_library(gsl_web GSL::gsl ${gsl_sources})
strut_web_library(gsl_cblas_web GSL::gslcblas ${gsl_cblas_sources})
foreach(target IN ITEMS gsl_web gsl_cblas_web)
  target_include_directories(${target} PUBLIC "${gsl_include}" PRIVATE "${gsl_SOURCE_DIR}")
endforeach()
target_link_libraries(gsl_web PUBLIC gsl_cblas_web)

# ---- libyaml, cJSON, zlib ----

strut_debian_source(
  yaml liby/libyaml libyaml_0.2.5.orig.tar.gz
  fa240dbf262be053f3898006d502d514936c818e422afdcf33921c63bed9bf2e
  libyaml_0.2.5-1.debian.tar.xz
  8730e0510129e516c3c7c1cda7428e02a0a122699e57ed203f835a338a686d1f)
set(yaml "${yaml_SOURCE_DIR}/src")
strut_web_library(yaml_web PkgConfig::LIBYAML "${yaml}/api.c" "${yaml}/parser.c" "${yaml}/reader.c"
                  "${yaml}/scanner.c")
target_include_directories(yaml_web PUBLIC "${yaml_SOURCE_DIR}/include")
target_compile_definitions(
  yaml_web PRIVATE YAML_VERSION_MAJOR=0 YAML_VERSION_MINOR=2 YAML_VERSION_PATCH=5
                   YAML_VERSION_STRING="0.2.5")

strut_debian_source(
  cjson c/cjson cjson_1.7.15.orig.tar.gz
  5308fd4bd90cef7aa060558514de6a1a4a0819974a26e6ed13973c5f624c24b2
  cjson_1.7.15-1+deb12u4.debian.tar.xz
  afd19a970966cf534ff1e9ec077d710a5e7e78eb4ec9b499c8bdc32e55da12cb)
strut_web_library(cjson_web PkgConfig::CJSON "${cjson_SOURCE_DIR}/cJSON.c")
file(COPY "${cjson_SOURCE_DIR}/cJSON.h" DESTINATION "${CMAKE_BINARY_DIR}/cjson_include/cjson")
target_include_directories(cjson_web PUBLIC "${CMAKE_BINARY_DIR}/cjson_include")

strut_debian_source(
  zlib z/zlib zlib_1.2.13.dfsg.orig.tar.bz2
  71feb7947e3c00ef125f83b79a4e529bde31171e5babe48b391f06758d1ab0a1
  zlib_1.2.13.dfsg-1.debian.tar.xz
  f66cf3d4f2d7defcd4d1fd1fb0a11ee39f1e01b42ec7d059c9dc5c1695133c44)
set(z "${zlib_SOURCE_DIR}")
strut_web_library(zlib_web ZLIB::ZLIB "${z}/adler32.c" "${z}/crc32.c" "${z}/deflate.c" "${z}/trees.c"
                  "${z}/zutil.c")
target_include_directories(zlib_web PUBLIC "${z}")

# ---- CHOLMOD: simplicial factors in AMD's order, as cholmod_factor.c asks for them ----

strut_debian_source(
  suitesparse s/suitesparse suitesparse_5.12.0+dfsg.orig.tar.xz
  bb106c43049138c19675cd70322e72ff8e4fd8bdcab3a096307fd78488913faf
  suitesparse_5.12.0+dfsg-2.debian.tar.xz
  2e5836427ac968d6fdf33de80a46cd0f0f74ae43732663d6ec3a198bc99678f3)
set(s "${suitesparse_SOURCE_DIR}")
file(GLOB cholmod_sources "${s}/CHOLMOD/Core/cholmod_*.c" "${s}/CHOLMOD/Cholesky/cholmod_*.c" "${s}/AMD/Source/amd_*.c"
     "${s}/COLAMD/Source/colamd.c")
strut_web_library(cholmod_web SuiteSparse::CHOLMOD ${cholmod_sources}
                  "${s}/SuiteSparse_config/SuiteSparse_config.c")
target_include_directories(cholmod_web PUBLIC "${s}/SuiteSparse_config" "${s}/AMD/Include" "${s}/COLAMD/Include"
                           "${s}/CHOLMOD/Include")
target_compile_definitions(cholmod_web PRIVATE NCHECK NMATRIXOPS NMODIFY NSUPERNODAL NPARTITION NCAMD NTIMER NPRINT)

# ---- GLPK: its simplex method ----

strut_debian_source(
  glpk g/glpk glpk_5.0.orig.tar.gz
  4a1013eebb50f728fc601bdd833b0b2870333c3b3e5a816eeba921d95bec6f15
  glpk_5.0-1.debian.tar.xz
  34ecc0f680fd70d2d0ed6f2ba11bbc68b033c7dcfcd4ceafcce84902999429da)
set(g "${glpk_SOURCE_DIR}/src")
file(GLOB glpk_sources "${g}/api/advbas.c" "${g}/api/prob*.c" "${g}/bflib/*.c" "${g}/draft/*.c" "${g}/env/*.c" "${g}/misc/*.c"
     "${g}/simplex/*.c")
list(FILTER glpk_sources EXCLUDE REGEX "/spydual.c$") # missing.c
strut_web_library(glpk_web GLPK::glpk ${glpk_sources})
target_include_directories(
  glpk_web PUBLIC "${g}" PRIVATE "${g}/api" "${g}/bflib" "${g}/draft" "${g}/env" "${g}/intopt" "${g}/misc" "${g}/npp"
  "${g}/mpl" "${g}/proxy" "${g}/simplex" "${g}/minisat" "${z}" "${s}/AMD/Include" "${s}/COLAMD/Include" "${s}/SuiteSparse_config")

# ---- what strut does without in a browser ----

foreach(absent IN ITEMS SuiteSparse::SPQR PkgConfig::ARPACK PkgConfig::NLOPT PkgConfig::PANGOCAIRO hdf5::hdf5
                        hdf5::hdf5_hl)
  add_library(${absent} INTERFACE IMPORTED GLOBAL)
endforeach()
