#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The library exports what its header declares and nothing else, under one version, and its soname is that of the
# interface. What tests/abi/baseline.txt lists, the declarations of earlier releases, is still declared alike; a
# release adds its own by the third argument "baseline".
#
#   sh tests/abi/exports.sh LIBRARY ROOT
set -eu
library=$1
root=$2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
failures=0
fail() { echo "$*"; failures=$((failures + 1)); }

nm -D --defined-only "$library" | awk '$2 != "A" { print $3 }' | sort >"$scratch/there"
sed -n 's/^STRUTLIB_API.*[ *]\(strutlib_[a-z_]*\)(.*/\1/p; s/^ *\(strutlib_[a-z_]*\)(.*/\1/p' \
  "$root/parser/bindings/abi/abi.h" | sed 's/$/@@STRUT_0/' | sort -u >"$scratch/declared"
cmp "$scratch/there" "$scratch/declared" || {
  diff "$scratch/declared" "$scratch/there" || true
  fail "the library exports something else than its header declares"
}
[ "$(wc -l <"$scratch/there")" -gt 60 ] || fail "only $(wc -l <"$scratch/there") exports looked at"
readelf -d "$library" | grep -q 'SONAME.*\[libstrut.so.0\]' || fail "the soname is not libstrut.so.0"

# One line for each declaration: what callers were compiled against.
awk '{ gsub("/[*][^*]*[*]/", "") }
  /^\/\*/ { inside = 1 }
  !inside && /^(STRUTLIB_API|typedef|  )/ { line = line " " $0 }
  !inside && /;$/ { gsub(/ +/, " ", line); gsub(/[(] /, "(", line); sub("^ (STRUTLIB_API )?", "", line); print line; line = "" }
  /\*\// { inside = 0 }' "$root/parser/bindings/abi/abi.h" | sort >"$scratch/now"
grep -E '^#define STRUTLIB_[A-Z_]+ [0-9]+' "$root/parser/bindings/abi/abi.h" |
  sed 's| */[*].*||' | grep -v ABI_VERSION | sort >>"$scratch/now"
while read -r line; do
  grep -qxF "$line" "$scratch/now" || fail "no longer declared: $line"
done <"$root/tests/abi/baseline.txt"
[ "${3-}" != baseline ] || cp "$scratch/now" "$root/tests/abi/baseline.txt"
[ "$failures" -gt 0 ] || echo "$(wc -l <"$scratch/there") functions"
exit "$((failures > 0))"
