#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# An installed strut is whole: it is installed below a scratch folder, moved, and then a program of
# somebody else's is built against it, by way of CMake and of pkg-config, and run.
#
#   sh tests/install_test.sh BUILD
set -eu
build=$(cd "$1" && pwd)
source=$(cd "$(dirname "$0")/.." && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cache() { sed -n "s/^$1:[A-Z]*=//p" "$build/CMakeCache.txt"; }

cmake --install "$build" --prefix "$scratch/first" >/dev/null
mv "$scratch/first" "$scratch/prefix"
prefix=$scratch/prefix
compiler=$(cache CMAKE_C_COMPILER)
# A sanitized library needs its sanitizers in the program as well.
sanitizers=
[ "$(cache STRUT_SANITIZE)" = OFF ] || sanitizers='-fsanitize=address,undefined'

mkdir "$scratch/user"
cd "$scratch/user"
cp "$source/tests/install_user.c" user.c
cat >CMakeLists.txt <<'END'
cmake_minimum_required(VERSION 3.25)
project(user C)
find_package(strut 0.1 REQUIRED)
add_executable(user user.c)
target_link_libraries(user PRIVATE strut::parser strut::output strut::engine)
add_executable(drawer user.c)
target_compile_definitions(drawer PRIVATE DRAW)
target_link_libraries(drawer PRIVATE strut::parser strut::pictures strut::output strut::engine)
add_executable(sweeper user.c)
target_compile_definitions(sweeper PRIVATE SWEEP)
target_link_libraries(sweeper PRIVATE strut::parser strut::study strut::engine)
END
sed -n 's/^ *"\(.*\)\\n".*/\1/p' user.c >model.yaml
sed -i 's/^strut: 1$/&\nparameters: {pull: 10}/; s/stiffness: 10/stiffness: pull/' model.yaml
cat >study.yaml <<'END'
strut: 1
study: pulls
model: model.yaml
axes: [{pull: [10, 20, 40]}]
keep: [duration, positions]
END
cmake -S . -B build -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_C_COMPILER="$compiler" \
  -DCMAKE_C_FLAGS="$sanitizers" -DCMAKE_BUILD_TYPE=Release >configure.log 2>&1 ||
  { cat configure.log; exit 1; }
cmake --build build >build.log 2>&1 || { cat build.log; exit 1; }
./build/user >by-cmake
grep '"status":[[:space:]]*"completed"' by-cmake || { cat by-cmake; exit 1; }
test -s nodes.csv
test -s trajectory.h5
# Who only computes has nothing of what draws.
! ldd build/user | grep -E 'cairo|pango' || { echo "the program that draws nothing links Cairo"; exit 1; }
./build/drawer >by-cmake.drawer
cmp by-cmake by-cmake.drawer
mv shape.svg shape-by-cmake.svg
./build/sweeper >by-cmake.sweeper
cmp by-cmake by-cmake.sweeper
[ "$(grep -c ',completed,$' table.csv)" -eq 3 ] || { cat table.csv; exit 1; }
mv table.csv table-by-cmake.csv
rm points.slots

PKG_CONFIG_PATH=$(dirname "$(find "$prefix" -name strut.pc)")
export PKG_CONFIG_PATH
LD_LIBRARY_PATH=${PKG_CONFIG_PATH%/pkgconfig} # for shared ones, which nobody registered here
export LD_LIBRARY_PATH
"$compiler" -std=c17 $sanitizers user.c -o user $(pkg-config --cflags --libs strut)
./user >by-pkg-config
cmp by-cmake by-pkg-config
"$compiler" -std=c17 -DDRAW $sanitizers user.c -o drawer \
  $(pkg-config --cflags --libs strut strut-pictures)
./drawer >by-pkg-config
cmp by-cmake by-pkg-config
cmp shape-by-cmake.svg shape.svg
"$compiler" -std=c17 -DSWEEP $sanitizers user.c -o sweeper \
  $(pkg-config --cflags --libs strut strut-pictures)
./sweeper >by-pkg-config
cmp by-cmake by-pkg-config
cmp table-by-cmake.csv table.csv
"$prefix/bin/strut" sweep study.yaml -o by-program --quiet
cmp table-by-cmake.csv by-program/table.csv

# The library with the stable interface stands alone: one header, one file, both ways to find it.
mkdir "$scratch/abi"
cd "$scratch/abi"
cp "$source/tests/abi/example.c" .
cat >CMakeLists.txt <<'END'
cmake_minimum_required(VERSION 3.25)
project(example C)
find_package(strut-abi 0.1 REQUIRED)
add_executable(example example.c)
target_link_libraries(example PRIVATE strut::abi)
END
cmake -S . -B build -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_C_COMPILER="$compiler" \
  -DCMAKE_C_FLAGS="$sanitizers" >configure.log 2>&1 || { cat configure.log; exit 1; }
cmake --build build >build.log 2>&1 || { cat build.log; exit 1; }
./build/example "$source/models/crawler/crawler.yaml" >by-cmake
grep -q 'velocity 0.01003 m/s, motion periodic' by-cmake || { cat by-cmake; exit 1; }
# The command that docs/api.md gives, with the compiler of this build as cc.
command=$(sed -n 's/^Build it with `\(cc .*\)`, or in CMake with$/\1/p' "$source/docs/api.md")
printf '#!/bin/sh\nexec "%s" %s "$@"\n' "$compiler" "$sanitizers" >cc
chmod +x cc
(PATH=$scratch/abi:$PATH && eval "$command")
./example "$source/models/crawler/crawler.yaml" >by-pkg-config
cmp by-cmake by-pkg-config
! ldd example | grep 'libstrut_' || exit 1
ldd example | grep -q 'libstrut.so.0' || { echo "the example is not linked to libstrut.so.0"; exit 1; }
cd "$scratch/user"

"$prefix/bin/strut" --version
"$prefix/bin/strut" keys --schema >schema
cmp schema "$prefix/share/strut/strut-1.schema.json"
"$prefix/bin/strut" keys --schema --study >schema
cmp schema "$prefix/share/strut/strut-1.study.schema.json"
"$prefix/bin/strut" examples crawler
cmp crawler.yaml "$source/models/crawler/crawler.yaml"
test -s "$prefix/share/bash-completion/completions/strut"
! command -v help2man >/dev/null || test -s "$prefix/share/man/man1/strut.1"
"$prefix/bin/strut" check "$source/models/crawler/crawler.yaml" >/dev/null

# The file for MATLAB and Octave finds the program of its installation.
if command -v octave-cli >/dev/null; then
  (cd "$scratch" && env -u STRUT OCTAVE_PATH="$prefix/share/strut/matlab" octave-cli --quiet --no-init-file --eval \
    "model = strut.load('$source/models/crawler/crawler.yaml'); disp(model.name)") | grep -qx 'Nine-member multistable crawler'
fi

# The Python package finds the library beside it, wherever both are.
package=$(dirname "$(find "$prefix" -path "*/strut/_strut.py")")
if [ -e "$package/__init__.py" ]; then
  (cd / && env -u LD_LIBRARY_PATH PYTHONPATH="${package%/*}" PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 -c '
import strut, sys
assert strut.__file__.startswith(sys.argv[1])
print(strut.load(sys.argv[2]).run(accuracy="1 %", record=False))
import strut.formats.__main__' "$prefix" "$source/models/crawler/crawler.yaml")
fi
