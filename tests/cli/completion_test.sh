#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Completion: what strut offers for a command line, and the script in bash itself.
. "$(dirname "$0")/lib.sh"
script=$root/parser/program/strut.bash
cp -R "$models" models
crawler=models/crawler/crawler.yaml

# offers TEXT WORD...: the words that strut offers for a command line, in order, and its directive.
offers() {
  expected=$1
  shift
  expect 0 complete "$@"
  err_empty
  got=$(tr '\n' ' ' <out)
  [ "$got" = "$expected " ] || fail "'$*' completes to '$got', expected '$expected '"
}

expect 0 help
grep '^  [a-z]' out | awk '{print $1}' >commands
offers "$(tr '\n' ' ' <commands):" ""
offers "run rigidity :" r
offers ":" rum ""
offers ":" nothing
expect 0 complete
offers "--stuck :" modes --st
offers "--quiet :" keys --q
# Every option of every command is offered.
while read -r command; do
  expect 0 $command --help
  grep STRUT_ out && fail "the help of $command has the name of a constant"
  sed -n '1,/^Options:/d; s/^ *\(-., \)\{0,1\}\(--[a-z-]*\).*/\2/p' out >listed
  sed -n "s/^'strut $command \(--[a-z]*\)' .*/\1/p" out >>listed
  sort listed -o listed
  expect 0 complete $command --
  grep -v '^:' out | sort >offered
  same listed offered
done <commands

# Files.
offers ":files yaml yml" run ""
offers ":files yaml yml" sweep ""
offers ":files csv" plot ""
offers ":folders" sweep --merge ""
offers ":files" view ""
offers ":folders" run "$crawler" -o ""
offers ":files" run "$crawler" --plot ""
offers ":files" form "$crawler" -o ""
offers ":" run "$crawler" --step ""

# Methods, also behind a comma.
offers "rk4 rk4-events :" run --integrator rk
offers "snapshots :" run --draw sn
offers "rk4,verlet rk4,verlet-events :" tradeoff --integrator rk4,ver
offers ":" run "$crawler" --set fr

mkdir bin
ln -s "$strut" bin/strut
PATH=$work/bin:$PATH
export PATH

# bash: the function as readline calls it. '=' is a word of its own there.
if command -v bash >/dev/null; then
  cat >try.bash <<'END'
source "$1"
try() {
  COMP_WORDS=("$@") COMP_CWORD=$(($# - 1)) COMP_LINE="$*" COMP_POINT=${#COMP_LINE}
  COMPREPLY=()
  _strut
  echo "${COMPREPLY[@]}"
}
COMP_WORDBREAKS=$' \t\n"\'><=;|&(:'
try strut che
try strut modes --st
try strut run models/crawler/crawler.yaml --integrator = rk4-
try strut run models/crawler/cr
try strut run models/cra
complete -p strut
END
  bash --norc try.bash "$script" >out 2>err
  err_empty
  cat >wanted <<'END'
check
--stuck
rk4-events
models/crawler/crawler.yaml
models/crawler
complete -F _strut strut
END
  same wanted out
else
  echo "no bash"
fi
