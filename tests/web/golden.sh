#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# golden.sh NODE GOLDEN: the hashes of golden.c, compiled for WebAssembly, are those of the native compilers.
set -eu
found=$("$1" "$2" tests/golden/crawler.yaml 20000)
[ "$found" = "$(cat tests/golden/crawler.hash)" ] || { printf '%s\n' "$found"; exit 1; }
