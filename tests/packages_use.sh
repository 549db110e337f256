#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs the packages beside this script in the bare Debian it runs in, as root, uses what each brings, and
# removes them. A run's bits are left in ~/bits. Called by packages.sh.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
fail() { echo "$*" >&2; exit 1; }
apt() { apt-get -qq -o Dpkg::Use-Pty=0 "$@" >/root/apt.log 2>&1 || { cat /root/apt.log; exit 1; }; }
has() { dpkg-query -W -f '${db:Status-Status}\n' "$1" 2>/dev/null | grep -q '^installed$'; }
work=$(mktemp -d)
cd "$work"
find /usr /etc -xdev | sort >before

# The program, alone: with nothing recommended, it computes and draws.
apt update
apt install -y --no-install-recommends "$here"/strut_*.deb "$here"/strut-doc_*.deb
strut --version
strut examples | grep -q '^crawler/crawler.yaml ' || fail "strut examples does not list the crawler"
model=/usr/share/strut/models/crawler/crawler.yaml
strut run "$model" --accuracy 0.5% >said
grep -q '10\.03 mm/s' said || { cat said; fail "the crawler has another velocity"; }
strut run "$model" -o run --quiet --plot crawler.pdf >/dev/null
[ "$(head -c 5 crawler.pdf)" = %PDF- ] || fail "no figure"
strut view run -o page.html >/dev/null
grep -q Dygraph page.html || fail "no charts on the page"
[ -s /usr/share/strut/matlab/strut.m ] || fail "no strut.m"
(cd run && sha256sum nodes.csv members.csv contacts.csv) >/root/bits

# The pages: every link to a file leads to one.
cd /usr/share/doc/strut
links=0
for page in README.md docs/*.md docs/*/*.md models/*/*.md; do
  [ -e "$page" ] || fail "there is no $page"
  for link in $(awk '/^ *```/ { inside = !inside } !inside' "$page" | grep -o ']([^) ]*)' |
    sed 's/^](//; s/)$//; s/#.*//' | grep -v '^[a-z]*:' | sort -u); do
    links=$((links + 1))
    [ -e "$(dirname "$page")/$link" ] || fail "$page: no file for the link $link"
  done
done
[ "$links" -gt 100 ] || fail "only $links links"
for package in /usr/share/doc/*strut*; do
  [ "$package" = /usr/share/doc/strut ] || [ -s "$package/copyright" ] || fail "no copyright in $package"
done
zcat changelog.gz | grep -q '^# Changelog' || fail "no changelog"
cd "$work"

# Everything else.
apt install -y --no-install-recommends "$here"/*.deb gcc libc6-dev cmake make pkg-config man-db python3-numpy
ldconfig -p | grep -q 'libstrut\.so\.0' || fail "the loader does not know libstrut.so.0"

# C, by pkg-config and by CMake, with the headers of the same release.
cp "$here/install_user.c" user.c
sed -n 's/^ *"\(.*\)\\n".*/\1/p' user.c >model.yaml
gcc -std=c17 user.c -o user $(pkg-config --cflags --libs strut)
./user >by-pkg-config
grep -q '"status":[[:space:]]*"completed"' by-pkg-config || { cat by-pkg-config; fail "the C program failed"; }
cat >CMakeLists.txt <<'LIST'
cmake_minimum_required(VERSION 3.25)
project(user C)
find_package(strut 0.1 REQUIRED)
find_package(strut-abi 0.1 REQUIRED)
add_executable(user user.c)
target_link_libraries(user PRIVATE strut::parser strut::output strut::engine)
add_executable(stable stable.c)
target_link_libraries(stable PRIVATE strut::abi)
LIST
# And with the shared library.
cat >stable.c <<'PROGRAM'
#include <stdio.h>
#include <strut/abi.h>
int main(void) {
  printf("%s\n", strutlib_version());
  return 0;
}
PROGRAM
gcc -std=c17 stable.c -o stable $(pkg-config --cflags --libs strut-abi)
./stable >version
grep -q '^0\.1' version || { cat version; fail "no version from the shared library"; }
(cmake -S . -B build && cmake --build build) >cmake.log 2>&1 || { cat cmake.log; exit 1; }
build/user | cmp - by-pkg-config
build/stable | cmp - version

if [ -e /usr/share/man/man1/strut.1.gz ]; then
  man strut >manual 2>&1
  grep -q equilibria manual || { cat manual; fail "man strut says nothing"; }
fi

if has python3-strut; then
  find /usr/lib/python3/dist-packages/strut -name '*.pyc' | grep -q . || fail "Python's files are not compiled"
  python3 -c "
import strut
print(strut.__version__, strut.load(strut.models / 'crawler/crawler.yaml').run())" >said
  grep -q '^0\.1' said || { cat said; fail "Python says something else"; }
  python3 -m strut.formats build "$model" -o parts >said || { cat said; fail "no formats of other programs"; }
fi

apt purge -y '*strut*'
apt autoremove -y --purge
! find /usr /etc -xdev -name '*strut*' | grep . || fail "files that stay behind"
echo "installed, used and removed: $(cd "$here" && echo *.deb)"
