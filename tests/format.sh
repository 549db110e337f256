#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Every C file is laid out as .clang-format says. Versions of clang-format differ in details, so the
# test speaks for version 14 (Debian 12) only and is skipped (exit code 77) elsewhere.
#
#   sh tests/format.sh [ROOT]
set -eu
cd "${1:-$(dirname "$0")/..}"
formatter=$(command -v clang-format-14 || command -v clang-format || true)
case $([ -n "$formatter" ] && "$formatter" --version) in
  *"version 14."*) ;;
  *) echo "clang-format 14 is not installed"; exit 77 ;;
esac
# It notices a line that is laid out in another way.
if printf 'int  f( void ){return 1;}\n' | "$formatter" --dry-run --Werror >/dev/null 2>&1; then
  echo "self-test: a badly laid out line passes"
  exit 1
fi
find engine parser tests -name node_modules -prune -o \( -name '*.c' -o -name '*.h' \) -print0 |
  xargs -0 "$formatter" --dry-run --Werror
