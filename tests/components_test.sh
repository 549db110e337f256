#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# What the packages are made of, below scratch folders: every installed file belongs to exactly one component
# that has a package (or to the licence, of which Debian has a copy), the ones that everybody has are there, the
# links of the installed pages lead to files, and CITATION.cff names the version. The packages themselves:
# packages.sh.
#
#   sh tests/components_test.sh BUILD
set -eu
build=$(cd "$1" && pwd)
source=$(cd "$(dirname "$0")/.." && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
fail() { echo "$*" >&2; exit 1; }

# list COMPONENT: its files.
list() { (cd "$scratch/$1" && find . ! -type d | sort); }
cmake --install "$build" --prefix "$scratch/all" >/dev/null
for component in program library development python documentation license; do
  mkdir "$scratch/$component"
  cmake --install "$build" --prefix "$scratch/$component" --component "$component" >/dev/null
  list "$component"
done | sort >"$scratch/parts"
list all | diff - "$scratch/parts" || fail "files of no component, or of two"

there() {
  for file in $2; do
    [ -n "$(find "$scratch/$1" -path "$scratch/$1/$file")" ] || fail "$1: no $file"
  done
}
set -f
there program "bin/strut share/strut/matlab/strut.m"
there library "lib*/libstrut.so.0"
there development "include/strut/strut.h include/strut/abi.h lib*/libstrut.so lib*/libstrut_engine.a
  lib*/pkgconfig/strut.pc lib*/pkgconfig/strut-abi.pc lib*/cmake/strut/strutConfig.cmake"
there documentation "share/doc/strut/README.md share/doc/strut/CITATION.cff share/strut/models/crawler/crawler.yaml"
set +f

cd "$scratch/documentation/share/doc/strut"
for page in README.md docs/*.md docs/*/*.md models/*/*.md; do
  [ -e "$page" ] || fail "there is no $page"
  for link in $(awk '/^ *```/ { inside = !inside } !inside' "$page" | grep -o ']([^) ]*)' |
    sed 's/^](//; s/)$//; s/#.*//' | grep -v '^[a-z]*:' | sort -u); do
    [ -e "$(dirname "$page")/$link" ] || fail "$page: no file for the link $link"
  done
done

version=$("$build/strut" --version | sed -n 's/^strut \([0-9.]*\).*/\1/p')
grep -qx "version: $version" "$source/CITATION.cff" || fail "CITATION.cff is not of version $version"
