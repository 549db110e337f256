#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Prints docs/api.md: the comments of the library's header, function by function, and an example.
#
#   sh tests/abi/api_page.sh ROOT >docs/api.md
#   sh tests/abi/api_page.sh ROOT check    fails where docs/api.md is another text
set -eu
root=$(cd "$1" && pwd)

page() {
  cat <<'TEXT'
# The library

`libstrut.so.0` does what the program does, for programs in any language that can call C: opaque handles, texts,
arrays of doubles. It stays compatible; the [C tree](dev/architecture.md#libraries-and-program) beside it changes with
every release. This page is made of the comments in `parser/bindings/abi/abi.h` by `tests/abi/api_page.sh`.

TEXT
  # The file's comment, without its first sentence.
  awk '/^\/\*\*/ { inside = 1; next }
    inside && /\*\// { exit }
    inside { sub("^ [*] ?", ""); if (seen || /^$/) { seen = 1; print } }' "$root/parser/bindings/abi/abi.h" | sed 1d
  cat <<'TEXT'

## Example

Built by `cc -o example example.c $(pkg-config --cflags --libs strut-abi)`, or in CMake by
`find_package(strut-abi)` and `target_link_libraries(example PRIVATE strut::abi)`:

```c
TEXT
  sed 1d "$root/tests/abi/example.c"
  printf '```\n'
  cat <<'TEXT'

The same in Julia, by `ccall`: [`docs/julia/crawler.jl`](julia/crawler.jl), which no test has run (Debian has no Julia).
TEXT
  # Of each section the declarations that stand together, behind what is said of them.
  awk '
    function flush() {
      if (code != "") {
        printf "\n```c\n%s```\n", code
        if (comment != "") printf "\n%s", comment
      } else if (comment != "") {
        printf "\n%s", comment
      }
      code = comment = ""
    }
    /^\/\* ---- .* ---- \*\/$/ {
      flush(); heading = $0; gsub(/^\/\* ---- | ---- \*\/$/, "", heading)
      print "\n## " toupper(substr(heading, 1, 1)) substr(heading, 2); started = 1; next
    }
    !started { next }
    /^#ifdef __cplusplus/ { exit }
    /^\/\*\*/ {
      flush()
      if (/\*\/$/) { line = $0; sub("^/[*][*] ", "", line); sub(" [*]/$", "", line); comment = line "\n"; next }
      inside = 1; next
    }
    inside && /^ \*\/$/ { inside = 0; next }
    inside { line = $0; sub("^ [*] ?", "", line); if (line ~ /^  [^ ]/) sub("^  ", "- ", line); else if (line ~ /^    /) sub("^    ", "  ", line); comment = comment line "\n"; next }
    /^$/ { next }
    { sub("^STRUTLIB_API ", ""); sub("^ {13}", ""); code = code $0 "\n" }
    END { flush() }' "$root/parser/bindings/abi/abi.h"
}

if [ "${2-}" = check ]; then
  scratch=$(mktemp)
  trap 'rm -f "$scratch"' EXIT
  page >"$scratch"
  cmp "$scratch" "$root/docs/api.md" && exit
  echo "docs/api.md is not what parser/bindings/abi/abi.h says: sh tests/abi/api_page.sh . >docs/api.md"
  exit 1
fi
page
