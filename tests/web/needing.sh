#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs a test where the files that it needs are there; otherwise says which is not, and 77 skips it.
# Usage: needing.sh FILE... -- COMMAND [WORD]...
set -eu
while [ "$1" != -- ]; do
  [ -e "$1" ] || { echo "skipped: no $1"; exit 77; }
  shift
done
shift
exec "$@"
