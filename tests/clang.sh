#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Clang, which builds strut for browsers and its fuzzers, accepts each file of the engine and the parser.
#
#   sh tests/clang.sh ROOT CLANG FOLDER...
#
# In the folders are other libraries' headers. Left out: what only a system with a shell or Python builds.
set -eu
cd "$1"
clang=$2
shift 2
others=
for folder; do others="$others -isystem $folder"; done
accepts() {
  xargs -P 2 -n 8 "$clang" -std=c17 -D_POSIX_C_SOURCE=200809L -DSTRUT_VERSION='"0"' -I . $others -w -fsyntax-only
}
bad=$(mktemp --suffix .c)
trap 'rm -f "$bad"' EXIT
echo 'static const struct { int n; } one = {1}; const int two = (&one)->n + 1;' >"$bad"
if echo "$bad" | accepts 2>/dev/null; then
  echo "an initializer that is no constant is accepted" >&2
  exit 1
fi
find engine parser -name '*.c' ! -path '*/program/*' ! -path '*/bindings/*' | sort | accepts
