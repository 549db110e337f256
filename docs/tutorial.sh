#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs the commands of docs/tutorial.md and puts the figures that they make and the page shows into DIRECTORY.
#
#   sh docs/tutorial.sh build/release/strut docs/tutorial
set -eu
[ $# -eq 2 ] || { echo "usage: docs/tutorial.sh STRUT DIRECTORY" >&2; exit 1; }
here=$(cd "$(dirname "$0")" && pwd)
PATH=$(cd "$(dirname "$1")" && pwd):$PATH
mkdir -p "$2"
output=$(cd "$2" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# "! command" is expected to fail, which "sh -e" allows.
awk '/^```sh$/ { inside = 1; next } /^```/ { inside = 0 } inside' "$here/tutorial.md" >"$work/commands"
(cd "$work" && sh -eu commands >log 2>&1) || { cat "$work/log" >&2; exit 1; }
sed -n 's/.*](tutorial\/\(.*\))$/\1/p' "$here/tutorial.md" | while read -r picture; do
  awk -f "$here/smaller.awk" "$work/$picture" >"$output/$picture"
done
