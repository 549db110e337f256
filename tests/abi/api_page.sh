#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# docs/api.md names each function of the library's header and no other, names no constant that the header lacks, and
# shows tests/abi/example.c. First proves on a made-up tree that it notices.
#
#   sh tests/abi/api_page.sh ROOT
set -eu

# differences ROOT: one line for each difference between the page, the header and the example.
differences() {
  page=$1/docs/api.md header=$1/parser/bindings/abi/abi.h
  sed -n 's/^STRUTLIB_API.*[ *]\(strutlib_[a-z_]*\)(.*/\1/p; s/^ *\(strutlib_[a-z_]*\)(.*/\1/p' "$header" | sort -u |
    while read -r name; do
      grep -qF "\`$name\`" "$page" || echo "docs/api.md does not name $name"
    done
  grep -oE '(strutlib|STRUTLIB)_[A-Za-z_]+' "$page" | sort -u | while read -r name; do
    grep -qw "$name" "$header" || echo "docs/api.md names $name, which abi.h lacks"
  done
  awk '/^```/ { inside = /^```c$/; next } inside' "$page" >"$scratch/shown"
  sed 1d "$1/tests/abi/example.c" | cmp -s - "$scratch/shown" || echo "docs/api.md shows another example.c"
}

root=$(cd "$1" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# Self-test: a page that lacks a function, names two words too many and shows another example.
mkdir -p "$scratch/tree/docs" "$scratch/tree/parser/bindings/abi" "$scratch/tree/tests/abi"
printf 'STRUTLIB_API void strutlib_close(strutlib_scene *scene);\n' >"$scratch/tree/parser/bindings/abi/abi.h"
printf '/* licence */\nint a;\n' >"$scratch/tree/tests/abi/example.c"
printf '`strutlib_close`\n```c\nint a;\n```\n' >"$scratch/tree/docs/api.md"
[ -z "$(differences "$scratch/tree")" ] || { echo "self-test: a good page fails"; exit 1; }
printf '`strutlib_open` `STRUTLIB_NO`\n```c\nint b;\n```\n' >"$scratch/tree/docs/api.md"
[ "$(differences "$scratch/tree" | wc -l)" -eq 4 ] || { echo "self-test: a bad page passes"; exit 1; }

found=$(differences "$root")
[ -z "$found" ] || { echo "$found"; exit 1; }
