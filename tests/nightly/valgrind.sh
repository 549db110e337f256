#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# valgrind.sh STRUT FOLDER...: run, equilibria, modes, rigidity and path of each model in the folders under valgrind.
# Its exit code is 1 where one reads memory that nothing has written, or that is not its own.
set -eu
strut=$1
shift
seen=0 wrong=0
log=$(mktemp) spared=$(mktemp)
trap 'rm -f "$log" "$spared"' EXIT
# glibc's loader compares words beyond the end of a short path
cat >"$spared" <<'END'
{
   loader
   Memcheck:Addr8
   fun:strncmp
   fun:is_dst
   ...
}
END
for model in $(find "$@" -name '*.yaml' | sort); do
  for command in run equilibria modes rigidity path; do
    seen=$((seen + 1))
    timeout 900 valgrind --quiet --suppressions="$spared" --error-exitcode=99 "$strut" "$command" "$model" --json >/dev/null 2>"$log" || code=$?
    case ${code:-0} in
      99 | 124) wrong=$((wrong + 1)); echo "$command $model: exit code $code"; cat "$log" ;;
    esac
    code=0
  done
done
echo "$seen commands, $wrong with errors"
[ "$wrong" -eq 0 ]
