#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Draws every picture of docs/gallery.md, by the commands that stand there, into DIRECTORY:
#
#   sh docs/gallery.sh build/release/strut docs/gallery
set -eu
[ $# -eq 2 ] || { echo "usage: docs/gallery.sh STRUT DIRECTORY" >&2; exit 1; }
here=$(cd "$(dirname "$0")" && pwd)
PATH=$(cd "$(dirname "$1")" && pwd):$PATH
mkdir -p "$2"
output=$(cd "$2" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp -R "$here/../models" "$work/models"
awk '/^```sh$/ { inside = 1; next } /^```/ { inside = 0 } inside' "$here/gallery.md" \
  >"$work/commands"
(cd "$work" && sh -eu commands >/dev/null)
for picture in "$work"/*.svg; do
  awk -f "$here/smaller.awk" "$picture" >"$picture.small"
  mv "$picture.small" "$output/$(basename "$picture")"
done
