#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The program starts without the libraries that only some commands need, loads them when one does, and says
# what is missing where it cannot.
#
#   sh tests/cli/modules_test.sh STRUT
. "$(dirname "$0")/lib.sh"

# As linked: nothing of what takes long to load.
built=$(dirname "$strut")
if [ -d "$built/modules" ]; then
  ldd "$strut" >out
  for library in hdf5 cairo pango cholmod spqr arpack blas; do out_has_not "lib$library"; done
else
  echo "skipped: built with shared libraries, which load the others"
  exit 77
fi

# What the modules call of strut, the program has.
nm -D --defined-only "$strut" | awk '{ print $3 }' | sort >offered
for module in "$built"/modules/*.so; do
  nm -D --undefined-only "$module" | awk '$2 ~ /^strut_/ { print $2 }' | sort >called
  [ -s called ] || fail "${module##*/} calls nothing of strut"
  [ -z "$(comm -23 called offered)" ] ||
    fail "${module##*/} calls what the program does not offer: $(comm -23 called offered)"
done

mkdir -p moved/bin moved/modules
cp "$strut" moved/bin/strut
strut=$work/moved/bin/strut

# A scene of the usual size is checked and run without them.
expect 0 check "$crawler"
expect 0 run "$models/basics/pendulum.yaml"

# missing CODE MODULE WORD...: the program needs the module, says so and writes nothing.
missing() {
  code=$1 module=$2
  shift 2
  expect "$code" "$@"
  err_has "cannot load the module '$module' of strut: no such file beside the program; install strut again"
}
missing 4 strut-hdf5.so run "$models/basics/pendulum.yaml" -o pendulum
absent pendulum
missing 4 strut-drawing.so run "$models/basics/pendulum.yaml" --plot pendulum.svg
absent pendulum.svg
missing 4 strut-algebra.so equilibria "$models/basics/von-mises-truss.yaml"
missing 4 strut-algebra.so run "$models/basics/pendulum.yaml" --integrator midpoint
missing 4 strut-algebra.so run "$models/basics/von-mises-truss.yaml" # settles

# What is no module, and a module of another strut.
folder=$built/modules
mkdir -p moved/bin/modules
cp "$folder"/strut-algebra.so "$folder"/strut-hdf5.so moved/bin/modules
echo nothing >moved/bin/modules/strut-drawing.so
tells 4 "cannot load the module 'strut-drawing.so' of strut: " run "$models/basics/pendulum.yaml" --plot pendulum.svg
err_has "install strut again"
version=$("$strut" --version | sed 's/^strut //')
sed "s/$version/9.9.9/g" "$folder/strut-hdf5.so" >moved/bin/modules/strut-hdf5.so
[ "${#version}" -ne 5 ] || {
  tells 4 "a module belongs to strut 9.9.9, and this is strut $version: install strut again" run "$models/basics/pendulum.yaml" -o pendulum
}

# Beside the program they are found.
cp "$folder"/*.so moved/bin/modules
expect 0 run "$models/basics/pendulum.yaml" -o pendulum --plot pendulum.svg
[ -s pendulum/trajectory.h5 ] || fail "no trajectory.h5"
[ -s pendulum.svg ] || fail "no pendulum.svg"
expect 0 modes "$models/basics/x-frame.yaml"
