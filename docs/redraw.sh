#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Redraws the pictures of docs: the gallery, those of README.md, the comparison and the tutorial, and the
# figures of the paper, all or those with the NUMBERs given (5 6 7 9 11 take minutes, 8 and 10 longer).
# docs/tradeoff.sh, which measures, is apart.
#
#   sh docs/redraw.sh build/release/strut [NUMBER]...
set -eu
[ $# -ge 1 ] || { echo "usage: docs/redraw.sh STRUT [NUMBER]..." >&2; exit 1; }
docs=$(cd "$(dirname "$0")" && pwd)
strut=$1
shift
sh "$docs/gallery.sh" "$strut" "$docs/gallery"
sh "$docs/pictures.sh" "$strut" "$docs"
sh "$docs/tutorial.sh" "$strut" "$docs/tutorial"
sh "$docs/paper.sh" "$strut" "$docs/paper" "$@"
