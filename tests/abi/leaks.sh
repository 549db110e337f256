#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Rounds of everything under valgrind: no byte is lost, none is read before it was written. 77: no valgrind,
# or a program that sanitizers watch already.
#
#   sh tests/abi/leaks.sh PROGRAM ROUNDS
set -eu
command -v valgrind >/dev/null || { echo "no valgrind"; exit 77; }
! nm "$1" 2>/dev/null | grep -q __asan_init || { echo "a sanitizer watches"; exit 77; }
# One thread: what OpenMP keeps for its threads until the end would look lost.
OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 valgrind -q --error-exitcode=9 --leak-check=full \
  --errors-for-leak-kinds=definite,indirect "$1" "$2"
echo "$2 rounds"
