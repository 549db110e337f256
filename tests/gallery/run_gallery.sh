#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Every known answer about the structures of models/gallery and models/parts, asked of the program with
# --json.
#
#   sh tests/gallery/run_gallery.sh ROOT STRUT [NAME...]     NAMEs: only these models
#
# A section of a file tests/gallery/*.answers belongs to the NAME.yaml of one of the two, or of models. Its lines:
#
#   [NAME]
#   # a comment
#   COMMAND [OPTIONS...] [%VARIANT] | FILTER | EXPECTED | TOLERANCE
#   %VARIANT = SED-SCRIPT
#
# The first runs `strut COMMAND MODEL OPTIONS... --json`, puts its output through the jq filter (which
# may contain |, may use tests/gallery/gallery.jq, and gives one value) and compares. TOLERANCE is
# absolute; EXPECTED then is a number, a list or a mapping of numbers, as jq writes or computes them
# (without any |):
#   0.995454545, (95 + 1000)/1100, root(2*3), [1, 2.5, 1e-3], {n1: [0, 1], n2: (1/3)}
# With the TOLERANCE `=` the filter's value, as a text, must be EXPECTED to the letter:
#   rigidity | .class | 1 | =        equilibria | stable | 1 | =       equilibria | .remark | null | =
# A command that fails gives {"status": its exit status, "message": what it said}:
#   modes --set load=20 | .status | 3 | =
# The second line makes a variant of the scene by sed, for what a parameter cannot change:
#   %free = s/fixed: [a-z]*/mass: 1/
# A line that ends with a backslash goes on in the next. A command that several lines ask is run once; a line
# without one asks that of the line before, and so does what follows a ` ;; `: FILTER | EXPECTED | TOLERANCE.
set -eu
root=$(cd "$1" && pwd)
strut=$2
shift 2
here=$root/tests/gallery
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
failures=0

# compare FILTER EXPECTED TOLERANCE ANSWER: prints what is wrong, nothing if all is right.
compare() {
  if [ "$3" = "=" ]; then
    got=$(jq -r "include \"gallery\"; ($1) | tostring" -L "$here" "$4" 2>&1) || true
    [ "$got" = "$2" ] || echo "got $got, expected $2"
    return
  fi
  jq -r -L "$here" "include \"gallery\"; ($1) as \$got | ($2) as \$want | ($3) as \$tolerance
    | if agrees(\$got; \$want; \$tolerance) then empty
      else \"got \(\$got | tojson), expected \(\$want | tojson) within \(\$tolerance)\" end" \
    "$4" 2>&1 || true
}

# ask MODEL COMMAND: runs it unless it has been run, and sets `answer` to the file of its output.
ask() {
  answer=$scratch/$(printf '%s %s' "$1" "$2" | cksum | tr ' ' -)
  [ ! -e "$answer" ] || return 0
  model=$1
  set -- $2
  name_of_command=$1
  shift
  options=
  for word; do
    case $word in
      %*) [ -e "$scratch/${word#%}.sed" ] || { echo "no variant $word"; return 1; }
          sed -f "$scratch/${word#%}.sed" "$model" >"$scratch/variant.yaml"
          model=$scratch/variant.yaml ;;
      *) options="$options $word" ;;
    esac
  done
  status=0
  "$strut" "$name_of_command" "$model" $options --json >"$answer" 2>"$scratch/message" || status=$?
  [ "$status" = 0 ] || jq -n --arg message "$(tr '\n' ' ' <"$scratch/message")" --argjson status "$status" \
    '{$status, $message}' >"$answer"
}

# trim TEXT: sets `trimmed` to it without the spaces around it.
trim() {
  trimmed=${1#"${1%%[! ]*}"}
  trimmed=${trimmed%"${trimmed##*[! ]}"}
}

# answers FILE MODEL [NAME]: all lines of a file, or of its section NAME; one line of output for each that is
# wrong.
answers() {
  rm -f "$scratch"/*.sed
  asked_last='' command_last=''
  awk -v name="${3-}" 'BEGIN { asked = name == "" }
       /^\[/ { asked = $0 == "[" name "]"; next }
       !asked { next }
       { if (!start) start = NR }
       /\\$/ { sub(/\\$/, ""); held = held $0; next }
       { n = split(held $0, part, / +;; +/)
         for (k = 1; k <= n; k++) print start ": " (k > 1 ? "| " : "") part[k]
         held = ""; start = 0 }' "$1" >"$scratch/lines"
  while IFS= read -r line; do
    number=${line%%: *}
    line=${line#*: }
    case $line in
      '' | '#'*) continue ;;
      %*) trim "${line%%=*}"
          printf '%s\n' "${line#*=}" >"$scratch/${trimmed#%}.sed"
          continue ;;
      *'|'*'|'*'|'*) ;;
      *) echo "${1##*/}:$number: not COMMAND | FILTER | EXPECTED | TOLERANCE: $line"; continue ;;
    esac
    trim "${line%%|*}"
    command=${trimmed:-$command_last}
    command_last=$command
    rest=${line#*|}
    trim "${rest##*|}"
    tolerance=$trimmed
    rest=${rest%|*}
    trim "${rest##*|}"
    expected=$trimmed
    trim "${rest%|*}"
    filter=$trimmed
    [ "$command" = "$asked_last" ] || ask "$2" "$command" ||
      { echo "${1##*/}:$number: $command: cannot be asked"; asked_last=; continue; }
    asked_last=$command
    wrong=$(compare "$filter" "$expected" "$tolerance" "$answer")
    [ -z "$wrong" ] || echo "${1##*/}:$number: $command: $filter: $(echo "$wrong" | tr '\n' ' ')" \
      "$(jq -r '.message? // empty' "$answer")"
    echo x >>"$scratch/asked"
  done <"$scratch/lines"
}

# Self-test: right answers pass, wrong ones are noticed.
: >"$scratch/asked"
cat >"$scratch/self.yaml" <<'YAML'
strut: 1
name: itself
parameters: {long: 3 m}
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [long, 4 m], mass: 1}}
members: {m: {kind: bar, nodes: [a, b], stiffness: 1 N/m}}
YAML
cat >"$scratch/good.answers" <<'TEXT'
# right, all of them
%wide = s/4 m/40 m/
check | .name | itself | =
check | .members.m.drawn_length | 5 | 1e-12 ;; .members.m.stiffness | 1 | 0
| .members[] | [.drawn_length, .stiffness] | [root(9 + 16), 1] | 1e-12
check --set long=30 %wide | .members.m.drawn_length | 50 | \
  1e-12
check --set long=2kg | .status | 2 | =
TEXT
cat >"$scratch/bad.answers" <<'TEXT'
check | .name | itsel | =
check | .members.m.drawn_length | 5.1 | 1e-2
check | .members.m.drawn_length | [5] | 1e-2
check | .members.m.no_length | 5 | 1e-2
check | .members[] | [.drawn_length] | [5, 1] | 1e-2
check --set long=2kg | .members.m.drawn_length | 5 | 1e-2
check --set long=30 | .members.m.drawn_length | 5 | 1e-2
check %none | .members.m.drawn_length | 5 | 1e-2
check | .members.m.drawn_length | 5
check | .members.( | 5 | 1
check | .name | itself | = ;; .members.m.stiffness | 2 | 0
TEXT
answers "$scratch/good.answers" "$scratch/self.yaml" >"$scratch/wrong"
[ ! -s "$scratch/wrong" ] || { cat "$scratch/wrong"; echo "self-test fails"; exit 1; }
answers "$scratch/bad.answers" "$scratch/self.yaml" >"$scratch/wrong"
for number in 1 2 3 4 5 6 7 8 9 10 11; do
  grep -q "^bad.answers:$number: " "$scratch/wrong" ||
    { echo "self-test: bad.answers:$number passes"; exit 1; }
done

: >"$scratch/asked"
sed -n 's/^\[\(.*\)]$/\1/p' "$here"/*.answers | sort >"$scratch/sections"
for name in $(ls "$root"/models/gallery/*.yaml "$root"/models/parts/*.yaml | sed 's|.*/||; s|\.yaml$||' |
  sort -u - "$scratch/sections"); do
  case " ${*:-$name} " in *" $name "*) ;; *) continue ;; esac
  model=$root/models/gallery/$name.yaml
  [ -e "$model" ] || model=$root/models/parts/$name.yaml
  [ -e "$model" ] || model=$root/models/$name.yaml
  if [ ! -e "$model" ] || [ "$(grep -cx "$name" "$scratch/sections")" != 1 ]; then
    echo "$name: needs models/gallery or parts/$name.yaml and one section [$name] in tests/gallery"
    failures=$((failures + 1))
    continue
  fi
  answers "$(grep -lxF "[$name]" "$here"/*.answers)" "$model" "$name" >"$scratch/wrong"
  cat "$scratch/wrong"
  failures=$((failures + $(wc -l <"$scratch/wrong")))
done
asked=$(wc -l <"$scratch/asked")
echo "$asked answers, $failures wrong"
exit "$((failures > 0))"
