#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The documents are right: every command of every ```sh block of README.md, docs/*.md and docs/*/*.md, and every
# ```matlab block where Octave is installed, runs in a scratch folder (one per document, holding models/ and the
# tables of docs/paper) with the strut just built first on the PATH, and none fails; every link leads to a file
# and, after #, to a heading of it; every source file that is named exists; and what a page says is printed, is
# (docs_numbers.py). Two blocks of README.md install and build, which is not done here: the one for the tests must
# be what .ci/run runs, the one for users the same with another preset, and its last command runs here.
#
#   sh tests/docs.sh ROOT STRUT
set -eu
root=$(cd "$1" && pwd)
strut=$(cd "$(dirname "$2")" && pwd)/strut
PATH=$(dirname "$strut"):$PATH
PYTHONPATH=$(dirname "$strut")/python
OCTAVE_PATH=$(dirname "$strut")/matlab
export PATH PYTHONPATH OCTAVE_PATH
octave=$(command -v octave-cli || command -v octave || true)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
failures=0
fail() { echo "$*"; failures=$((failures + 1)); }

# folder FILE: the scratch folder of a document, named after its path.
folder() { echo "$scratch/$(echo "${1#"$root"/}" | sed 's/\.md$//; s|/|-|g')"; }

# blocks FILE FOLDER: the sh blocks of FILE as FOLDER/LINE.sh, its matlab blocks as FOLDER/LINE.m, those behind a
# marker "<!-- command: NAME -->" as FOLDER/NAME.command. A fence that would hide commands is reported.
blocks() {
  awk -v file="$1" -v folder="$2" '
    /^<!-- command: [a-z]+ -->$/ { marker = $3; next }
    !inside && /^ *```/ {
      inside = 1
      language = $0; sub("^ *```", "", language)
      if (language !~ /^(sh|python|matlab|yaml|json|c|text|csv|cmake|diff|udiff|js)$/)
        print file ":" NR ": a fence marked \"" language "\": sh for commands, text for the rest"
      out = ""
      if (language == "sh") out = folder "/" (marker == "" ? sprintf("%05d.sh", NR) : marker ".command")
      if (language == "matlab") out = sprintf("%s/%05d.m", folder, NR)
      marker = ""
      next
    }
    inside && /^ *```/ { inside = 0; if (out != "") close(out); next }
    inside && out != "" { print > out }
    inside && out == "" && /^ *\$ [a-z]/ { print file ":" NR ": a command outside an sh block" }
    END { if (inside) print file ": a fence that nothing closes" }' "$1"
}

# commands_work FILE FOLDER: runs the blocks of FILE in FOLDER, in order; says which failed.
commands_work() {
  mkdir -p "$2/blocks" "$2/here"
  complaints=$(blocks "$1" "$2/blocks")
  [ -z "$complaints" ] || { echo "$complaints"; return 1; }
  cp -R "$root/models" "$2/here/models"
  mkdir -p "$2/here/docs/paper" # tables of figures that take too long to make here
  cp "$root"/docs/paper/*.csv "$2/here/docs/paper"
  for block in "$2"/blocks/[0-9]*; do
    [ -e "$block" ] || continue
    # Without the Python package (sanitizers), the page ends where it needs that.
    [ -e "$PYTHONPATH" ] || ! grep -q strut.formats "$block" || break
    ran=$((ran + 1))
    case $block in
      *.m) # without a screen
        [ -n "$octave" ] || continue
        { echo "1;"; printf 'function %s(varargin), end\n' plot xlabel ylabel; cat "$block"; } >"$2/run"
        shell="$octave --quiet --no-init-file" ;;
      *) # "set -e" overlooks a "! command" that should have failed, so that is spelled out.
        sed 's/^! \(.*\)$/if \1; then exit 1; fi/' "$block" >"$2/run"
        shell="bash -euo pipefail" ;;
    esac
    log=${block%.*}.log
    if ! (cd "$2/here" && $shell "$2/run") >"$log" 2>&1 </dev/null; then
      echo "$1, the block at line $(basename "${block%.*}" | sed 's/^0*//'):"
      cat "$block"
      echo "--- ended badly, saying:"
      tail -n 20 "$log"
      return 1
    fi
  done
}

# wrong_numbers FILE FOLDER: numbers that FILE says are printed, which no block that ran in FOLDER printed.
wrong_numbers() {
  [ -n "$octave" ] || ! grep -q '^```matlab' "$1" || return 0
  python3 "$root/tests/docs_numbers.py" "$1" "$2/blocks"
}

# dead_links FILE: the links of FILE, to files and to headings, that lead nowhere. Web addresses are not
# followed.
dead_links() {
  folder=$(dirname "$1")
  awk '/^ *```/ { inside = !inside } !inside' "$1" | grep -o ']([^) ]*)' | sed 's/^](//; s/)$//' |
    grep -v '^[a-z]*:' | sort -u |
    while read -r link; do
      file=${link%%#*}
      heading=${link#"$file"}
      target=$1
      [ -z "$file" ] || target=$folder/$file
      if [ ! -e "$target" ]; then
        echo "$1: no file for the link $link"
      elif [ -n "$heading" ] && ! headings "$target" | grep -qxF "${heading#\#}"; then
        echo "$1: no heading for the link $link"
      fi
    done
}

# lost_files FILE: source files that FILE names, with or without ending, and that do not exist.
lost_files() {
  grep -oE '`(engine|parser|tests|models)/[A-Za-z0-9_/.-]+`' "$1" | tr -d '`' | grep -v NAME | sort -u |
    while read -r path; do
      [ -e "$root/$path" ] || [ -e "$root/$path.c" ] || [ -e "$root/$path.h" ] ||
        echo "$1: there is no $path"
    done
}

# headings FILE: the anchors of its headings, as GitHub and GitLab name them.
headings() {
  awk '/^ *```/ { inside = !inside } !inside && /^#+ / { sub(/^#+ /, ""); print tolower($0) }' "$1" |
    sed 's/[^a-z0-9_ -]//g; s/ /-/g'
}

# Self-test: a document whose commands work, and some that must be noticed.
ran=0
document() { printf '%b' "$1" >"$scratch/made-up.md"; rm -rf "$scratch/self"; }
document 'a\n```sh\necho a >left\n```\nb\n```sh\ntest -s left\nstrut --version\n```\n'
commands_work "$scratch/made-up.md" "$scratch/self" || fail "self-test: a good document fails"
[ "$ran" -eq 2 ] || fail "self-test: ran $ran blocks of 2"
for bad in '```sh\nfalse\ntrue\n```\n' '```sh\nfalse | cat\n```\n' '```bash\ntrue\n```\n' \
  '```sh\n! true\ntrue\n```\n' '```text\n$ strut run a.yaml\n```\n' '```sh\ntrue\n' \
  ${octave:+'```matlab\nerror("x")\n```\n'}; do
  document "$bad"
  ! commands_work "$scratch/made-up.md" "$scratch/self" >/dev/null ||
    fail "self-test: passes: $bad"
done

claim() { # TEXT: a document that claims TEXT, and the numbers in it that its command does not print
  printed="v 12.34 mm/s; {\\\"t\\\": 0.0025}; -7"
  document "\`\`\`sh\necho \"$printed\"\n\`\`\`\n\n<!-- printed -->\n$1\n"
  commands_work "$scratch/made-up.md" "$scratch/self" >/dev/null
  wrong_numbers "$scratch/made-up.md" "$scratch/self"
}
for good in 'With 12.3 mm/s or 0.0123 m/s, after 2.5 ms: **7**.' \
  'n1, `9.9` and [a](b9.md) by 7 and -7\n\n9.9 elsewhere'; do
  said=$(claim "$good") || fail "self-test: $said: $good"
done
for bad in '<!--printed-->' '12.4 mm/s' '12.3 m/s' '12.34 N' '12.345 mm/s' '0.0026' '+7' '12.34 and 8' 'nothing'; do
  ! claim "$bad" >/dev/null || fail "self-test: passes: $bad"
done

document '# A\n## One, two\n[b](#one-two) [c](https://example.org/x)\n'
[ -z "$(dead_links "$scratch/made-up.md")" ] || fail "self-test: a good link is dead"
for bad in '# A\n[b](#two)\n' '# A\n[b](nowhere.md)\n'; do
  document "$bad"
  [ -n "$(dead_links "$scratch/made-up.md")" ] || fail "self-test: passes: $bad"
done
document 'See `engine/base` and `engine/base/memory`, `engine/output/NAME.c`.\n'
[ -z "$(lost_files "$scratch/made-up.md")" ] || fail "self-test: a file that exists is lost"
document 'See `engine/base/nowhere.c`.\n'
[ -n "$(lost_files "$scratch/made-up.md")" ] || fail "self-test: a lost file passes"

ran=0
for document in "$root"/README.md "$root"/docs/*.md "$root"/docs/*/*.md; do
  [ -e "$document" ] || continue
  commands_work "$document" "$(folder "$document")" ||
    fail "${document#"$root"/}: a command fails"
  lost=$(dead_links "$document"; lost_files "$document")
  [ -z "$lost" ] || fail "$lost"
done
echo "$ran blocks of commands ran"
[ "$ran" -gt 0 ] || fail "there were no commands"

# The two command lines of README.md.
build=$scratch/README/blocks/build.command
tests=$scratch/README/blocks/tests.command
for line in "$build" "$tests"; do
  [ "$(wc -l <"$line")" -eq 1 ] || fail "$(basename "$line" .command): not one line"
done
sh "$root/.ci/run" --print | cmp - "$tests" || fail ".ci/run runs something else than README.md says"
built=$(sed 's/ && build\/release\/strut .*//' "$build")
tested=$(sed 's/ && ctest .*//; s/install.sh tests/install.sh/; s/preset tests/preset release/g' "$tests")
[ "$built" = "$tested" ] || fail "the two command lines build in different ways: $built | $tested"
crawl=$(sed -n 's/.* && build\/release\/\(strut .*\)/\1/p' "$build")
[ -n "$crawl" ] || fail "the first command line does not end with a run"
log=$scratch/README/blocks/$(awk '/^<!-- command: build -->/ { printf "%05d", NR + 1 }' "$root/README.md").log
(cd "$scratch/README/here" && sh -euc "$crawl") >"$log" 2>&1 </dev/null ||
  { cat "$log"; fail "failed: $crawl"; }

for document in "$root"/README.md "$root"/docs/*.md "$root"/docs/*/*.md; do
  [ -e "$document" ] || continue
  wrong_numbers "$document" "$(folder "$document")" || failures=$((failures + 1))
done
exit "$((failures > 0))"
