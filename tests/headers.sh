#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Every header compiles alone: as C17 with all warnings, twice in one file (its guard holds), and,
# if strut.h leads to it, as C++17 too. All of them compile in one file: no name means two things.
# What strut.h leads to declares only what the libraries export. First proves on made-up headers that
# it notices.
#
#   sh tests/headers.sh ROOT CC CXX [FOLDER|LIBRARY...]
#
# CXX may be empty: then C++ is left out. In the folders are other libraries' headers, for ours that
# are not public. Without libraries (.a, .so) exports are left out.
set -eu
root=$(cd "$1" && pwd)
cc=$2
cxx=$3
shift 3
others=
libraries=
for given; do
  if [ -d "$given" ]; then others="$others -isystem $given"; else libraries="$libraries $given"; fi
done
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
# preprocessed ROOT HEADER LANGUAGE: c or c++, with the lines that say which file a line comes from.
preprocessed() {
  case $3 in
  c) printf '#include "%s"\n' "$2" | $cc -std=c17 -D_POSIX_C_SOURCE=200809L -I "$1" -E -x c - ;;
  *) printf '#include "%s"\n' "$2" | $cxx -std=c++17 -Drestrict=__restrict -I "$1" -E -x c++ - ;;
  esac
}
# declared ROOT: the functions and objects with a linker's name that the preprocessed text on standard
# input declares in files of ROOT. Bodies are skipped; a declaration ends at a semicolon or a body.
declared() {
  awk -v root="$1/" '
    function end_declaration() {
      gsub(/__attribute__ *\(\([^()]*(\([^()]*\))?[^()]*\)\)/, "", text)
      gsub(/extern *"C"( *"C[+][+]")?/, "", text)
      if (text ~ /^ *(typedef|static) / || text ~ /^ *_Static_assert/) return text = ""
      if (match(text, /[A-Za-z_][A-Za-z_0-9]* *\(/)) {
        name = substr(text, RSTART, RLENGTH - 1)
      } else if (text ~ /^ *extern /) {
        name = text
        sub(/ *(\[.*|=.*)?$/, "", name)
        sub(/.*[^A-Za-z_0-9]/, "", name)
      } else {
        return text = ""
      }
      gsub(/ /, "", name)
      print name
      text = ""
    }
    /^# [0-9]+ "/ { ours = index($3, "\"" root) == 1; next }
    !ours || /^#/ { next }
    {
      for (i = 1; i <= length($0); i++) {
        c = substr($0, i, 1)
        if (c == "{" && depth == 0 && text ~ /extern *"C" *$/) text = ""
        else if (c == "{") depth++
        else if (c == "}" && depth > 0 && --depth == 0 && text ~ /\) *$/) end_declaration()
        else if (c == ";" && depth == 0) end_declaration()
        else if (c != "}" && depth == 0) text = text c
      }
      text = text " "
    }' | sort -u
}
# exported LIBRARY...: the names that others may link to.
exported() {
  readelf -sW "$@" | awk '$5 ~ /GLOBAL|WEAK/ && $6 == "DEFAULT" && $7 != "UND" { print $8 }' |
    sort -u
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
cat >"$scratch/f.h" <<'END'
#define API __attribute__((visibility("default")))
#ifdef __cplusplus
extern "C" {
#endif
struct inner { int (*call)(int); struct { int a; } b; };
typedef struct outer { struct inner a; } outer;
typedef int (*callback)(void);
enum { ONE = 1 };
static inline int local(int a) { if (a) { return a; } return ONE; }
API int exported_call(const struct inner *a,
                      callback b);
int hidden_call(void); int
hidden_too (struct inner a);
extern API const int exported_rows[];
extern const struct inner *hidden_row;
#ifdef __cplusplus
}
#endif
END
names='exported_call exported_rows hidden_call hidden_row hidden_too '
for language in c ${cxx:+c++}; do
  found=$(preprocessed "$scratch" f.h $language | declared "$scratch" | tr '\n' ' ')
  [ "$found" = "$names" ] || fail "self-test: of f.h's declarations in $language it sees: $found"
done
cat >"$scratch/f.c" <<'END'
#define API __attribute__((visibility("default")))
API int exported_call(void) { return 0; }
int hidden_call(void) { return 0; }
API extern const int exported_rows[];
const int exported_rows[] = {1};
END
$cc -fvisibility=hidden -c "$scratch/f.c" -o "$scratch/f.o"
[ "$(exported "$scratch/f.o" | tr '\n' ' ')" = 'exported_call exported_rows ' ] ||
  fail "self-test: exported"
[ "$(reachable "$scratch" a.h | tr '\n' ' ')" = 'a.h b.h ' ] || fail "self-test: reachable"

# Bindings of other languages include the headers of these.
headers=$(cd "$root" && find engine parser -name "*.h" | sort)
# Texts of laws are included once for each kernel (engine/scene/laws/words.h), by headers that are looked at.
texts=$(cd "$root" && grep -l '^#include "engine/scene/laws/words.h"' $headers)
headers=$(printf '%s\n' $headers | grep -vxF "$(printf '%s\nengine/scene/laws/words.h\nengine/scene/laws/words_end.h' "$texts")")
public=$(reachable "$root" parser/strut.h | grep -vxF "$texts")
compile_together "$root" $headers || fail "two headers give one name two meanings"
for header in $headers; do
  compiles "$root" "$header" || fail "$header does not compile alone"
done
if [ -n "$cxx" ]; then
  for header in $public; do
    compiles_as_cxx "$root" "$header" || fail "$header does not compile as C++"
  done
fi
if [ -n "$libraries" ]; then
  exported $libraries >"$scratch/exported"
  for language in c ${cxx:+c++}; do
    for header in $public; do
      preprocessed "$root" "$header" $language
    done | declared "$root" >"$scratch/declared"
    [ "$(wc -l <"$scratch/declared")" -gt 100 ] || fail "too few declarations looked at"
    for name in $(comm -23 "$scratch/declared" "$scratch/exported"); do
      fail "$name is declared in a header that is installed, but not exported"
    done
  done
fi
[ "$(echo "$headers" | wc -l)" -gt 15 ] || fail "too few headers looked at"
[ "$(echo "$public" | wc -l)" -gt 8 ] || fail "too few public headers looked at"
[ "$failures" -eq 0 ] && echo "$(echo "$headers" | wc -l) headers compile alone," \
  "$(echo "$public" | wc -l) of them as C++ ($cc, ${cxx:-no C++ compiler})"
exit "$((failures > 0))"
