#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# strut for browsers and node, from a bare Debian: installs what it needs, builds the preset web and tests it.
#
#   sh tests/web.sh            all of it
#   sh tests/web.sh install    only the packages
#   sh tests/web.sh build      and the build
set -eu
cd "$(dirname "$0")/.."
upto=${1:-test}
case $upto in install | build | test) ;; *) echo "usage: sh tests/web.sh [install|build|test]" >&2; exit 1 ;; esac

sh tests/install.sh web
[ "$upto" != install ] || exit 0

# Debian's emscripten finds its acorn there.
NODE_PATH=/usr/share/nodejs
export NODE_PATH
cmake --preset web
cmake --build --preset web -j "$(nproc)"
[ "$upto" != build ] || exit 0

# The program whose bits the module must have, and what the tests have from npm.
cmake --preset release
cmake --build --preset release -j "$(nproc)" --target strut
cmake --preset web -DSTRUT_WEB_PROGRAM="$PWD/build/release/strut"
npm install --prefix tests/web --no-package-lock --before=2026-11-20 --ignore-scripts --no-audit --no-fund
ctest --preset web
