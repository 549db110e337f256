#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Completion: what strut offers for a command line, and the script in bash itself.
models=$(realpath "$2")
script=$(realpath "$3")
. "$(dirname "$0")/lib.sh"
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

# The model's own names.
offers "frequency= friction= :" run "$crawler" --set fr
offers "friction= :" run --json --set seconds=2 "$crawler" --set fri
offers "friction=0.1 :" run "$crawler" --set friction=
offers "--set=friction= :" run "$crawler" --set=fri
offers ":" run missing.yaml --set ""
offers ":" run --set ""
offers "I II III :" modes "$crawler" --at ""
offers "I II III :" modes "$crawler" --at I
offers ":" modes --at ""
offers "n1,n2 :" equilibria "$crawler" --supports n1,n2
offers "n1.x n1.y :" path "$crawler" --over n1
offers "rk4 rk4-events :" run --integrator rk
offers "rk4,verlet rk4,verlet-events :" tradeoff --integrator rk4,ver
# Copies of parts, by the names that they have.
expect 0 complete path models/parts/x-chain.yaml --over c
grep -q '^[a-z]*\.0\.[a-z0-9]*\.x' out || fail "no node of a copy"
printf 'strut: 1\nparameters: {length: 3 mm\n' >torn.yaml
offers ":" run torn.yaml --set ""
printf 'frequency [Hz],velocity [m/s],mode\n1,2,3\n' >table.csv
offers "frequency :" plot table.csv --x fr
offers "frequency,velocity :" plot table.csv --y frequency,v
offers "mode= :" plot table.csv --only m

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
try strut run models/crawler/crawler.yaml --set fri
try strut run models/crawler/crawler.yaml --set friction =
try strut run models/crawler/crawler.yaml --set friction = 0
try strut run models/crawler/crawler.yaml --set friction = 0.3 --set fri
try strut run models/crawler/crawler.yaml --integrator = rk4-
try strut modes models/crawler/crawler.yaml --at I
try strut run models/crawler/cr
try strut run models/cra
try strut plot tab
complete -p strut
END
  bash --norc try.bash "$script" >out 2>err
  err_empty
  cat >wanted <<'END'
check
--stuck
friction=
0.1
0.1
friction=
rk4-events
I II III
models/crawler/crawler.yaml
models/crawler
table.csv
complete -F _strut strut
END
  same wanted out
else
  echo "no bash"
fi
