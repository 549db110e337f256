#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Completion: what strut offers for a command line, and the scripts in bash, zsh and fish themselves.
models=$(realpath "$2")
. "$(dirname "$0")/lib.sh"
cp -R "$models" models
crawler=models/crawler/crawler.yaml

# offers TEXT WORD...: the words that strut offers for a command line, in order and without their
# explanations, and its directive.
offers() {
  expected=$1
  shift
  expect 0 complete "$@"
  err_empty
  got=$(cut -f1 out | tr '\n' ' ')
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
  sed -n '1,/^Options:/d; s/^ *\(-., \)\{0,1\}\(--[a-z-]*\).*/\2/p' out >listed
  sed -n "s/^'strut $command \(--[a-z]*\)' .*/\1/p" out >>listed
  sort listed -o listed
  expect 0 complete $command --
  cut -f1 out | grep -v '^:' | sort >offered
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
offers "drawn start I II III :" modes "$crawler" --at ""
offers "I II III :" modes "$crawler" --at I
offers "drawn start :" modes --at ""
offers "n1,n2 :" equilibria "$crawler" --supports n1,n2
offers "n1.x n1.y :" path "$crawler" --over n1
offers "rk4 rk4-events :" run --integrator rk
offers "rk4,verlet rk4,verlet-events :" tradeoff --integrator rk4,ver
offers "none karnopp coulomb smooth stribeck lugre :" run --friction-law ""
grep -q "	0.1$" out && fail "words have no values"
expect 0 complete run "$crawler" --set fri
grep -q "^friction=	0.1$" out || fail "the value of a parameter is not shown"
# Copies of parts, by the names that they have.
expect 0 complete path models/parts/x-chain.yaml --over c
grep -q '^[a-z]*\.0\.[a-z0-9]*\.x' out || fail "no node of a copy"
# A model that is being written has its names, too.
printf 'strut: 1\nparameters: {length: 3 mm\n' >torn.yaml
offers ":" run torn.yaml --set ""
printf 'strut: 1\nparameters: {length: 3 mm}\nnodes: {a: [0, lenth]}\nconfigurations: {high: {}}\n' >bad.yaml
offers "length= :" run bad.yaml --set ""
offers "high :" modes bad.yaml --at h
# Of a study those of its model.
mkdir studies
cp "$crawler" studies/crawler.yaml
printf 'strut: 1\nstudy: s\nmodel: crawler.yaml\naxes: [{friction: [0.1, 0.2]}]\n' >studies/s.yaml
offers "frequency= friction= :" sweep studies/s.yaml --set fr
printf 'strut: 1\nstudy: s\nmodel: s.yaml\naxes: []\n' >studies/own.yaml
offers ":" sweep studies/own.yaml --set ""
printf 'frequency [Hz],velocity [m/s],mode\n1,2,3\n' >table.csv
offers "frequency :" plot table.csv --x fr
offers "frequency,velocity :" plot table.csv --y frequency,v
offers "mode= :" plot table.csv --only m

# Words of options are those that the commands accept.
while read -r command option; do
  expect 0 complete $command $option ""
  cut -f1 out | grep -v '^:' >offered
  expect 1 $command $crawler $option no-such-word
  while read -r word; do err_has "$word"; done <offered
done <<'END'
form --given
form --objective
tradeoff --measure
run --bars
run --mass-model
run --friction-law
run --damping-law
run --integrator
export --format
export --input
END

expect 1 help --completion tcsh
err_has "expected bash, zsh or fish, not 'tcsh'"
expect 1 help --completion bsah
err_has "did you mean 'bash'?"
expect 1 help --completion
err_has "option '--completion' needs a value"
offers "bash zsh fish :" help --completion ""
for shell in bash zsh fish; do
  expect 0 help --completion $shell
  err_empty
  cp out strut.$shell
done

mkdir bin
ln -s "$strut" bin/strut
PATH=$work/bin:$PATH
export PATH

# bash: the function as readline calls it. '=' is a word of its own there.
if command -v bash >/dev/null; then
  cat >try.bash <<'END'
source strut.bash
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
  bash --norc try.bash >out 2>err
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

# fish tells by itself what it would offer.
if command -v fish >/dev/null; then
  in_fish() {
    HOME=$work fish --no-config -c "source strut.fish; complete -C'$1'" 2>err | cut -f1 | tr '\n' ' ' >out
    err_empty
    [ "$(cat out)" = "$2 " ] || fail "fish completes '$1' to '$(cat out)', expected '$2 '"
  }
  in_fish "strut che" check
  in_fish "strut modes --st" --stuck
  in_fish "strut run $crawler --set fri" friction=
  in_fish "strut run $crawler --set friction=" friction=0.1
  in_fish "strut run $crawler --integrator=rk4-" --integrator=rk4-events
  in_fish "strut modes $crawler --at I" "I II III"
  in_fish "strut run models/crawler/crawl" "$crawler"
  in_fish "strut sweep --merge stu" studies/
else
  echo "no fish"
fi

# zsh, with a terminal of its own: what stands on its line after a tabulator.
if command -v zsh >/dev/null; then
  mkdir functions
  cp strut.zsh functions/_strut
  cat >try.zsh <<'END'
zmodload zsh/zpty || exit 77
zpty inner zsh -f -i
see() { # until the text $1 is printed
  local all= part
  repeat 200; do
    zpty -r -t inner part && all+=$part || sleep 0.05
    [[ $all == *$1* ]] && break
  done
  print -r -- "$all"
}
zpty -w inner 'PS1= RPS1= ; unsetopt zle_bracketed_paste 2>/dev/null; TERM=dumb; stty -echo'
zpty -w inner 'fpath=($PWD/functions $fpath); autoload -Uz compinit; compinit -u -d $PWD/dump; zstyle ":completion:*" menu no'
zpty -w inner 'widget() { zle complete-word; print -r -- "<$BUFFER>"; zle kill-whole-line }; zle -N widget; bindkey "^I" widget; print rea""dy'
see ready >/dev/null
for line in "$@"; do
  zpty -w -n inner "$line"$'\t'
  see '>' | tr '\r' '\n' | sed -n 's/.*\(<.*>\).*/\1/p' | tail -n 1
done
zpty -d inner
END
  zsh -f try.zsh "strut che" "strut modes --st" "strut run $crawler --set fri" "strut run $crawler --set friction=" \
    "strut run $crawler --integrator=rk4-" "strut modes $crawler --at II" "strut run models/crawler/crawl" >out 2>err
  code=$?
  cat >wanted <<END
<strut check >
<strut modes --stuck >
<strut run $crawler --set friction=>
<strut run $crawler --set friction=0.1 >
<strut run $crawler --integrator=rk4-events >
<strut modes $crawler --at II>
<strut run $crawler >
END
  [ $code -eq 77 ] || same wanted out
else
  echo "no zsh"
fi
done_testing
