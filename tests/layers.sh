#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Includes run down the floors only, and cloned functions have names of their own. First proves on
# made-up trees that it notices each kind of breach, then looks at the repository.
#
#   sh tests/layers.sh [ROOT]
set -eu
LC_ALL=C
export LC_ALL

# breaches ROOT: one line per include that is not allowed; nothing where all is well.
breaches() {
  (
    cd "$1"
    find engine parser -type f \( -name '*.c' -o -name '*.h' \) | sort |
      xargs grep -nE '^[[:space:]]*#[[:space:]]*include' /dev/null || true
  ) | awk -v root="$1" '
    # Rooms that are one folder here: a stepper with events and what it calls know each other, as do forces and drives.
    function folder(path) {
      sub("/[^/]*$", "", path); sub("^engine/integrate/events/.*$", "engine/integrate/events", path)
      sub("^engine/forces/drives$", "engine/forces", path); sub("^parser/language/read/.*$", "parser/language/read", path); return path
    }
    function stem(path) { sub("[.][ch]$", "", path); return path }
    function breach(why) { print place ": " why ": " text }
    BEGIN {
      # Folders in the order in which they may include each other; those of a line stand side by side.
      count = split("engine/base|engine/scene/laws|engine/scene|engine/scene/checks|engine/model/algebra|engine/model|engine/forces/strains|" \
        "engine/forces|engine/integrate|" \
        "engine/integrate/events engine/integrate/limit|engine/run/measure|" \
        "engine/run/orbit|engine/run|engine/run/accuracy|engine/run/follow|engine/statics|engine/statics/search|" \
        "engine/statics/equilibria|" \
        "engine/statics/modes engine/statics/rigidity engine/statics/form engine/statics/path|" \
        "engine/output|engine/output/draw|" \
        "engine/output/figures engine/output/page|engine/study/results|" \
        "engine/study/sensitivity|" \
        "engine/study/cluster engine/study/tradeoff engine/study/sweep|" \
        "engine/study/compare engine/study/search engine/study/follow|engine/study/fit|engine/study/report|" \
        "engine/study/figures", line, "|")
      for (i = 1; i <= count; i++) {
        n = split(line[i], side, " ")
        for (k = 1; k <= n; k++) floor[side[k]] = i
      }
      count = split("parser/language/yaml|parser/language/expression|parser/language/keys|parser/language/read|parser/language/write|" \
        "parser/language/study|parser", line, "|")
      for (i = 1; i <= count; i++) parser_floor[line[i]] = i
      # Foreign libraries live in one folder each; those of linear algebra even in one room.
      home["yaml.h"] = "parser/language/yaml"; home["hdf5.h"] = "engine/output"; home["hdf5_hl.h"] = "engine/output"
      home["cJSON.h"] = home["cjson/cJSON.h"] = "engine/output"
      home["zlib.h"] = "engine/output/page"; home["cairo.h"] = home["cairo-pdf.h"] = "engine/output/draw"
      home["cairo-svg.h"] = home["pango/pangocairo.h"] = "engine/output/draw"
      room_of["cholmod.h"] = "engine/model/algebra/cholmod_factor engine/statics/sparse_algebra"
      room_of["SuiteSparseQR_C.h"] = "engine/statics/sparse_algebra"
      room_of["arpack.h"] = room_of["arpack/arpack.h"] = "engine/statics/sparse_algebra"
      room_of["glpk.h"] = "engine/statics/linear_program"
      room_of["nlopt.h"] = "engine/study/search/nlopt_optimiser"
    }
    {
      split($0, part, ":"); file = part[1]; place = file ":" part[2]
      text = $0; sub("^[^:]*:[^:]*:", "", text)
      if (!match(text, /["<][^">]*[">]/)) { breach("cannot be read"); next }
      name = substr(text, RSTART + 1, RLENGTH - 2)
      quoted = substr(text, RSTART, 1) == "\""
      from = folder(file); to = folder(name)
      sub("^parser/program/check$", "parser/program", from); sub("^parser/program/check$", "parser/program", to)
      ours = name ~ "^(engine|parser|tests)/"
      if (!ours) {
        base = name; sub("^suitesparse/", "", base)
        if (quoted) breach("not spelled from the repository root")
        else if (base in home && from != home[base] && from !~ "^parser/(program|program/command|program/study|bindings/abi|bindings/web)$") breach("belongs to " home[base])
        else if (base in room_of && index(" " room_of[base] " ", " " stem(file) " ") == 0)
          breach("belongs to " room_of[base])
        next
      }
      if (!quoted) { breach("a header of ours in angle brackets"); next }
      if (system("test -f \"" root "/" name "\"") != 0) { breach("no such header"); next }
      if (to ~ "^tests") { breach("the product includes a test"); next }
      if (from == to) next
      # On top of everything: the program and the shared library, and below both studies and their options.
      if (from == "parser/program" || from ~ "^parser/bindings/(abi|web)$") {
        if (to == "parser/program" || to == "parser/bindings/abi") breach("runs up")
        next
      }
      if (from ~ "^parser/program/(command|study)$") {
        if (to == "parser/program" || to == "parser/bindings/abi" || to == "parser/program/study") breach("runs up")
        next
      }
      # The front door of the libraries names them all, but never the program.
      if (file == "parser/strut.h") { if (to ~ "^parser/(program|program/command|program/study|bindings/abi|bindings/web)$") breach("runs up"); next }
      if (from ~ "^parser") {
        if (to == "engine/base" || to ~ "^engine/scene") next
        if (!(from in parser_floor)) breach("a folder without a floor")
        else if (!(to in parser_floor) || parser_floor[to] >= parser_floor[from]) breach("runs up")
        next
      }
      if (from == "engine") { if (to !~ "^engine") breach("runs up"); next }
      if (!(from in floor)) { breach("a folder without a floor"); next }
      if (!(to in floor) || floor[to] >= floor[from]) breach("runs up")
    }'
}

failures=0
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# expect COUNT FILE INCLUDE: the tree that holds FILE with that include has COUNT breaches.
expect() {
  rm -rf "$scratch/tree"
  mkdir -p "$scratch/tree"
  for header in engine/base/a.h engine/scene/a.h engine/model/a.h engine/forces/a.h \
    engine/integrate/a.h engine/run/a.h engine/statics/a.h engine/statics/search/a.h \
    engine/statics/modes/a.h engine/output/a.h engine/study/sweep/a.h engine/run/orbit/a.h \
    engine/odd/a.h parser/a.h parser/language/yaml/a.h parser/language/read/a.h parser/program/a.h parser/program/command/a.h \
    parser/bindings/abi/a.h tests/a.h "$2"; do
    mkdir -p "$scratch/tree/${header%/*}"
    : >"$scratch/tree/$header"
  done
  printf '/* a file */\n%s\nint x;\n' "$3" >"$scratch/tree/$2"
  found=$(breaches "$scratch/tree" | wc -l)
  if [ "$found" -ne "$1" ]; then
    echo "self-test: $2 with $3: expected $1 breaches, found $found"
    failures=$((failures + 1))
  fi
}

expect 0 engine/model/b.c '#include "engine/base/a.h"'
expect 0 engine/model/b.c '#include "engine/model/a.h"'
expect 0 engine/study/sweep/b.c '#include "engine/statics/a.h"'
expect 0 engine/run/b.c '#include "engine/run/orbit/a.h"'
expect 1 engine/run/orbit/b.c '#include "engine/run/a.h"'
expect 0 parser/language/read/b.c '#include "parser/language/yaml/a.h"'
expect 1 parser/language/yaml/b.c '#include "parser/language/read/a.h"'
expect 0 parser/b.c '#include "engine/scene/a.h"'
expect 0 parser/program/b.c '#include "engine/study/sweep/a.h"'
expect 0 parser/program/b.c '#include "parser/program/command/a.h"'
expect 0 parser/program/study/b.c '#include "parser/program/command/a.h"'
expect 1 parser/program/study/b.c '#include "parser/program/a.h"'
expect 0 parser/bindings/abi/b.c '#include "parser/program/command/a.h"'
expect 1 parser/program/command/b.c '#include "parser/program/a.h"'
expect 1 parser/bindings/abi/b.c '#include "parser/program/a.h"'
expect 1 parser/language/read/b.c '#include "parser/program/command/a.h"'
expect 0 parser/strut.h '#include "engine/output/a.h"'
expect 0 parser/language/yaml/b.c '#include <yaml.h>'
expect 1 parser/language/read/b.c '#include <yaml.h>'
expect 0 engine/model/algebra/cholmod_factor.c '#include <suitesparse/cholmod.h>'
expect 1 engine/model/algebra/linear_solver.c '#include <cholmod.h>'
expect 0 engine/base/b.c '#include <stdio.h>'
expect 1 engine/base/b.h '#include "engine/scene/a.h"'
expect 1 engine/scene/b.c '  #  include "engine/model/a.h"'
expect 1 engine/model/b.c '#include "engine/forces/a.h"'
expect 1 engine/forces/b.c '#include "engine/run/a.h" // why'
expect 1 engine/run/b.c '#include "engine/output/a.h"'
expect 1 engine/statics/b.c '#include "engine/output/a.h"'
expect 0 engine/output/b.c '#include "engine/statics/a.h"'
expect 0 engine/statics/modes/b.c '#include "engine/statics/search/a.h"'
expect 1 engine/statics/search/b.c '#include "engine/statics/modes/a.h"'
expect 1 engine/statics/form/b.c '#include "engine/statics/modes/a.h"'
expect 1 engine/run/b.c '#include "parser/a.h"'
expect 1 parser/b.c '#include "engine/model/a.h"'
expect 1 parser/b.c '#include "parser/program/a.h"'
expect 1 parser/strut.h '#include "parser/program/a.h"'
expect 1 engine/odd/b.c '#include "engine/base/a.h"'
expect 1 engine/run/b.c '#include "tests/a.h"'
expect 1 parser/program/b.c '#include "tests/a.h"'
expect 1 parser/b.c '#include "a.h"'
expect 1 parser/b.c '#include "../engine/base/a.h"'
expect 1 engine/run/b.c '#include <engine/base/a.h>'
expect 1 engine/run/b.c '#include "engine/base/missing.h"'
expect 1 engine/run/b.c '#include HEADER'
expect 1 engine/run/b.c '#include <yaml.h>'
expect 1 engine/forces/b.c '#include <cholmod.h>'
expect 1 engine/run/b.c '#include <hdf5.h>'

# Functions with STRUT_CLONES that bear one name in two files, which clang does not link.
twins() {
  find "$1/engine" -name '*.c' -exec awk '
    cloned && match($0, /[a-z0-9_]+\(/) { print substr($0, RSTART, RLENGTH - 1); cloned = 0 }
    /^STRUT_CLONES/ { cloned = 1 }
    /^STRUT_(PLAIN_STEPS|EVENT_TRIAL|COPIES)\(/ { sub(/.*\(/, ""); sub(/,.*/, ""); print $0 "_with_balance" }' {} + |
    sort | uniq -d | sed 's/$/ is the name of two cloned functions/'
}
mkdir -p "$scratch/twins/engine"
printf 'STRUT_CLONES\nstatic void same(int a) {\n' | tee "$scratch/twins/engine/a.c" >"$scratch/twins/engine/b.c"
[ -n "$(twins "$scratch/twins")" ] || { echo "twins are not seen"; failures=$((failures + 1)); }

# What docs/dev/architecture.md says of the tree: who uses CHOLMOD, GLPK and NLopt, and the files that it and
# docs/dev/recipes.md name by the end of their paths. Those in strut/ are installed.
strangers() {
  for pair in 'cholmod_:(model/algebra/cholmod_factor|statics/sparse_algebra)' \
    'ds[ae]upd_:statics/sparse_algebra' 'glp_:statics/linear_program' 'nlopt_:study/search/nlopt_optimiser' \
    '(cairo|pango)_:output/draw/canvas' 'H5[A-Z]:output/(hdf5_(file|parts)|trajectory_file)'; do
    (cd "$1" && grep -rlE "\b${pair%%:*}[a-z0-9_]+ *\(" engine parser --include='*.[ch]' || true) |
      grep -vE "^engine/${pair#*:}[.][ch]$" | sed "s/$/ uses ${pair%%:*}/" || true
  done
}
unknown_files() {
  for page in "$1/docs/dev/architecture.md" "$1/docs/dev/recipes.md"; do
    grep -v '^[-+]' "$page" | grep -oE '`[a-z0-9_/]+[.](c|h|sh|py|cmake)(\.in)?`' | tr -d '`' | sort -u |
      grep -v '^strut/' | while read -r name; do
        find "$1" -path "$1/build" -prune -o -path "*/$name" -print | grep -q . ||
          echo "${page##*/} names $name, which does not exist"
      done
  done
}
mkdir -p "$scratch/claims/engine/a" "$scratch/claims/parser" "$scratch/claims/docs/dev"
echo 'cholmod_start(x);' >"$scratch/claims/engine/a/b.c"
echo 'in `engine/a/c.c` and `b.c`' |
  tee "$scratch/claims/docs/dev/architecture.md" >"$scratch/claims/docs/dev/recipes.md"
[ "$(strangers "$scratch/claims" | wc -l) $(unknown_files "$scratch/claims" | wc -l)" = "1 2" ] ||
  { echo "false claims of the pages are not seen"; failures=$((failures + 1)); }

root=${1:-$(dirname "$0")/..}
root=$(cd "$root" && pwd)
found=$(breaches "$root"; twins "$root"; strangers "$root"; unknown_files "$root")
if [ -n "$found" ]; then
  echo "$found"
  failures=$((failures + 1))
fi
count=$(find "$root/engine" "$root/parser" -name '*.[ch]' | wc -l)
[ "$count" -gt 20 ] || { echo "only $count files looked at"; failures=$((failures + 1)); }
[ "$failures" -eq 0 ] && echo "the includes of $count files run down"
exit "$((failures > 0))"
