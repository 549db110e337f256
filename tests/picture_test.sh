#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# README's picture is what the program draws today, byte for byte. Usage: picture_test.sh ROOT STRUT
set -eu
root=$1 strut=$2
drawn=$(mktemp)
trap 'rm -f "$drawn"' EXIT
sh "$root/docs/picture.sh" "$strut" "$drawn"
cmp "$drawn" "$root/docs/crawler.svg"
