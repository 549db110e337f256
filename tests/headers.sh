#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Every header compiles alone: as C17 with all warnings, twice in one file (its guard holds), and,
# if strut.h leads to it, as C++17 too. All of them compile in one file: no name means two things.
# First proves on made-up headers that it notices.
#
#   sh tests/headers.sh ROOT CC CXX [FOLDER...]
#
# CXX may be empty: then C++ is left out. In the folders are other libraries' headers, for ours that
# are not public.
# shellcheck disable=SC2086  # lists of words are meant to split
set -eu
root=$(cd "$1" && pwd)
cc=$2
cxx=$3
shift 3
others=
for folder; do others="$others -isystem $folder"; done
warnings="-Wall -Wextra -Wpedantic -Wshadow -Wundef -Werror"

# compiles ROOT HEADER: says why not.
compiles() {
  printf '#include "%s"\n#include "%s"\nextern int after;\n' "$2" "$2" |
    $cc -std=c17 -D_POSIX_C_SOURCE=200809L $warnings -Wstrict-prototypes -Wvla -I "$1" \
      $others -fsyntax-only -x c -
}
# compile_together ROOT HEADER...: says which names clash.
compile_together() {
  folder=$1
  shift
  printf '#include "%s"\n' "$@" | $cc -std=c17 -D_POSIX_C_SOURCE=200809L -Werror -Wno-psabi \
    -I "$folder" $others -fsyntax-only -x c -
}
# strut.h lends C++ the word "restrict" for the headers below it.
compiles_as_cxx() {
  lent=-Drestrict=__restrict
  [ "$2" != parser/strut.h ] || lent=
  printf '#include "%s"\n' "$2" |
    $cxx -std=c++17 -Wall -Wextra -Wshadow -Wundef -Werror $lent -I "$1" -fsyntax-only -x c++ -
}
# reachable ROOT HEADER: the header and all of ours that it includes, once each.
reachable() {
  seen=
  queue=$2
  while [ -n "${queue# }" ]; do
    next=
    for header in $queue; do
      case " $seen " in *" $header "*) continue ;; esac
      seen="$seen $header"
      next="$next $(sed -n 's/^#include "\([^"]*\)".*/\1/p' "$1/$header")"
    done
    queue=${next# }
  done
  printf '%s\n' $seen | sort
}

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
failures=0
fail() { echo "$*"; failures=$((failures + 1)); }

printf '#ifndef A\n#define A\ntypedef int number;\n#include "b.h"\n#endif\n' >"$scratch/a.h"
printf '#ifndef B\n#define B\nnumber twice(number);\n#endif\n' >"$scratch/b.h"
printf 'struct unguarded { int a; };\n' >"$scratch/c.h"
printf '#ifndef D\n#define D\nextern int *class;\n#endif\n' >"$scratch/d.h"
compiles "$scratch" a.h || fail "self-test: a good header is refused"
! compiles "$scratch" b.h 2>/dev/null || fail "self-test: a header that needs another passes"
! compiles "$scratch" c.h 2>/dev/null || fail "self-test: a header without a guard passes"
compiles "$scratch" d.h || fail "self-test: a C header is refused"
printf '#ifndef E\n#define E\ntypedef double number;\n#endif\n' >"$scratch/e.h"
compile_together "$scratch" a.h d.h || fail "self-test: headers without a clash are refused"
! compile_together "$scratch" a.h e.h 2>/dev/null || fail "self-test: a clash of names passes"
if [ -n "$cxx" ]; then
  ! compiles_as_cxx "$scratch" d.h 2>/dev/null || fail "self-test: C++'s words pass as names"
fi
[ "$(reachable "$scratch" a.h | tr '\n' ' ')" = 'a.h b.h ' ] || fail "self-test: reachable"

headers=$(cd "$root" && find engine parser -name '*.h' | sort)
public=$(reachable "$root" parser/strut.h)
compile_together "$root" $headers || fail "two headers give one name two meanings"
for header in $headers; do
  compiles "$root" "$header" || fail "$header does not compile alone"
done
if [ -n "$cxx" ]; then
  for header in $public; do
    compiles_as_cxx "$root" "$header" || fail "$header does not compile as C++"
  done
fi
[ "$(echo "$headers" | wc -l)" -gt 15 ] || fail "too few headers looked at"
[ "$(echo "$public" | wc -l)" -gt 8 ] || fail "too few public headers looked at"
[ "$failures" -eq 0 ] && echo "$(echo "$headers" | wc -l) headers compile alone," \
  "$(echo "$public" | wc -l) of them as C++ ($cc, ${cxx:-no C++ compiler})"
exit "$((failures > 0))"
