# SPDX-License-Identifier: GPL-3.0-or-later
# shellcheck shell=sh
# For the tests of the program: run it, look at what it said. Sourced with the program's path in $1.
set -u

strut=$(realpath "$1")
here=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd)
root=$(dirname "$(dirname "$here")")
models=$root/models crawler=$root/models/crawler/crawler.yaml hopper=$root/tests/cli/hopper.yaml
work=$(mktemp -d)
failures=0
mounted=

finish() { # of every test, whose last command succeeds: it fails where a check has failed
  [ -z "$mounted" ] || umount "$mounted"
  rm -rf "$work"
  [ "$failures" -eq 0 ] || { echo "$failures failed" && exit 1; }
}
trap finish EXIT
cd "$work" || exit 1

# fail TEXT: notes a failure and shows what the last command printed.
fail() {
  failures=$((failures + 1))
  echo "FAILED: $*"
  [ $failures -le 5 ] || return 0
  [ ! -s "$work/out" ] || head -c 600 "$work/out" | sed 's/^/    out| /'
  [ ! -s "$work/err" ] || head -c 600 "$work/err" | sed 's/^/    err| /'
}

# yaml [FILE]: writes a scene or a study, whose first line is that of all, and the rest the standard input.
yaml() (
  [ $# -eq 0 ] || exec >"$1"
  echo 'strut: 1'
  cat
)

# frame FILE CABLE BAR: four cables with the keys CABLE around two bars with the keys BAR.
frame() {
  yaml "$1" <<END
name: Frame
groups: {cable: {kind: cable, $2},
  bar: {kind: bar, $3}}
nodes: {a: [0, 0], b: [1, 0], c: [1, 1], d: [0, 1]}
members:
  ab: {group: cable, nodes: [a, b]}
  bc: {group: cable, nodes: [b, c]}
  cd: {group: cable, nodes: [c, d]}
  da: {group: cable, nodes: [d, a]}
  ac: {group: bar, nodes: [a, c]}
  bd: {group: bar, nodes: [b, d]}
END
}

# expect CODE WORD...: runs strut WORD..., keeps stdout in out and stderr in err, compares the code.
expect() {
  expected_code=$1
  shift
  "$strut" "$@" >"$work/out" 2>"$work/err" </dev/null
  code=$?
  [ "$code" -eq "$expected_code" ] || fail "strut $*: exit code $code, expected $expected_code"
}

# formats CODE WORD...: as expect, of python3 -m strut.formats; false where the Python package was not built.
formats() {
  package=$(dirname "$strut")/python
  [ -e "$package/strut/_strut.py" ] || return 1
  expected_code=$1
  shift
  PYTHONPATH=$package /usr/bin/python3 -m strut.formats "$@" >"$work/out" 2>"$work/err" </dev/null
  code=$?
  [ "$code" -eq "$expected_code" ] || fail "formats $*: exit code $code, expected $expected_code"
}

# near [FILTER EXPECTED TOLERANCE]...: the JSON in out through jq, and a number, or an array of them, that jq computes.
near() {
  while [ $# -gt 0 ]; do
    jq -e "def own: $own; ($1) as \$got | ($2) as \$want | ($3) as \$near | [\$got, \$want] | map([.] | flatten) |
      transpose | all((.[0] - .[1] | fabs) <= \$near)" out >jq.out 2>&1 ||
      fail "$1 is $(jq -c "$1" out 2>&1), expected $(jq -n "$2") within $(jq -n "def own: $own; $3")"
    shift 3
  done
}
own=0 # what the word stands for in a TOLERANCE: the method's own one in `by`
# by "METHOD[:OWN]..." FILE [FILTER EXPECTED TOLERANCE]...: runs the scene by each of these methods, and the same of each.
by() {
  _rows=$1 _file=$2 && shift 2
  for _row in $_rows; do
    case $_row in *:*) own=${_row#*:} ;; *) own=0 ;; esac
    expect 0 run "$_file" --integrator "${_row%:*}" --json
    near "$@"
  done
}
# gives FILTER EXPECTED TOLERANCE WORD...: runs strut WORD... --json, and the same.
gives() { _got=$1 _want=$2 _near=$3 && shift 3 && expect 0 "$@" --json; near "$_got" "$_want" "$_near"; }
# finds CONDITION WORD...: the same with a condition that holds.
finds() { _condition=$1 && shift && expect 0 "$@" --json; holds "$_condition"; }
# near_number ACTUAL EXPECTED TOLERANCE WHAT
near_number() {
  awk -v a="$1" -v b="$2" -v t="$3" 'BEGIN { d = a - b; exit !(d <= t && -d <= t) }' ||
    fail "$4: $1, expected $2 within $3"
}
# shows CODE TEXT WORD..., tells CODE TEXT WORD...: the same, and stdout (stderr) has the text.
shows() { _code=$1 _text=$2 && shift 2 && expect "$_code" "$@"; out_has "$_text"; }
tells() { _code=$1 _text=$2 && shift 2 && expect "$_code" "$@"; err_has "$_text"; }
# refuses CODE TEXT WORD...: as tells, and stdout has nothing.
refuses() { tells "$@"; out_empty; }
# edit PROGRAM FILE CHECK...: what sed makes of the file, checked: the last word of the check is its name.
edit() {
  sed "$1" "$2" >edited.yaml
  shift 2
  "$@" edited.yaml
}
# writes_back FILE: what strut export writes, in written.yaml, reads back as the same.
writes_back() {
  expect 0 export "$1"
  cp "$work/out" written.yaml
  expect 0 export written.yaml
  same "$work/out" written.yaml
}
# holds CONDITION...: of the JSON in out, by jq.
holds() { for _it; do jq -e "$_it" "$work/out" >"$work/jq.out" 2>&1 || fail "not so: $_it"; done; }
# out_has TEXT..., out_has_not TEXT..., err_has TEXT...: each of them.
out_has() { for _it; do grep -qF -- "$_it" "$work/out" || fail "stdout lacks '$_it'"; done; }
out_has_not() { for _it; do ! grep -qF -- "$_it" "$work/out" || fail "stdout has '$_it'"; done; }
err_has() { for _it; do grep -qF -- "$_it" "$work/err" || fail "stderr lacks '$_it'"; done; }
out_empty() { [ ! -s "$work/out" ] || fail "stdout is not empty"; }
err_empty() { [ ! -s "$work/err" ] || fail "stderr is not empty"; }
same() { cmp -s "$1" "$2" || fail "$1 and $2 differ"; }
# same_directory A B: the same files with the same bytes, hidden ones too.
same_directory() { diff -r "$1" "$2" >"$work/out" 2>&1 || fail "$1 and $2 differ"; }
absent() { [ ! -e "$1" ] || fail "$1 exists"; }
# files DIRECTORY NAME...: exactly these, hidden ones counted, but not the list of what strut wrote.
files() {
  directory=$1
  shift
  expected_files=$(printf '%s\n' "$@" | sort)
  found=$(ls -A "$directory" | grep -vx .strut-files | sort)
  [ "$found" = "$expected_files" ] || fail "$directory holds: $(echo $found)"
}

# small_disk KILOBYTES: mounts a disk of that size on $work/disk; fails where that is not allowed.
small_disk() {
  mkdir -p "$work/disk"
  [ "$(id -u)" -eq 0 ] && mount -t tmpfs -o "size=${1}k" none "$work/disk" 2>/dev/null || return 1
  mounted=$work/disk
}
no_disk() {
  umount "$work/disk"
  mounted=
}
