#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# A locale with a decimal comma changes nothing. $2: the test program of the JSON writer.
. "$(dirname "$0")/lib.sh"
json_test=$2

mkdir locales
if ! command -v localedef >/dev/null ||
  ! localedef -i de_DE -f UTF-8 locales/de_DE.UTF-8 >/dev/null 2>&1; then
  echo "skipped: a German locale cannot be made here"
  exit 0
fi
# The C library itself leaks under LOCPATH.
german() { ASAN_OPTIONS=detect_leaks=0 LOCPATH=$work/locales LC_ALL=de_DE.UTF-8 LANG=de_DE.UTF-8 "$@"; }
[ "$(german locale decimal_point 2>/dev/null)" = , ] || fail "the locale is not in use"

for words in "check $hopper" "check $hopper --json" "write $hopper" "keys"; do
  "$strut" $words >first 2>&1
  german "$strut" $words >second 2>&1
  same first second
done
"$strut" run "$hopper" -o one -q || fail "a run"
german "$strut" run "$hopper" -o two -q || fail "a German run"
same_directory one two

# A host program that has chosen the locale.
german "$json_test" >out 2>err || fail "the JSON writer"
cat out err >both
! grep -q SKIPPED both || fail "the locale was not tried"
