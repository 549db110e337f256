#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The wheel in bare systems of Debian 12 and 13 that have python3-venv and nothing else: no compiler, no numpy,
# no fonts. A user who is not root installs it by pip without network, computes and draws. Both get the same bits.
# Needs root, debootstrap and the network (bare_systems.sh).
#
#   sh tests/python/wheel_bare.sh FOLDER [SUITE...]
#
# FOLDER: where strut-*.whl is.
set -eu
source=$(cd "$(dirname "$0")/../.." && pwd)
wheel=$(ls "$1"/strut-*.whl)
shift
[ $# -gt 0 ] || set -- bookworm trixie
. "$source/tests/bare_systems.sh"

cat >"$scratch/use.sh" <<'USE'
set -eu
[ "$(id -u)" -ne 0 ]
! command -v cc gcc clang || exit 1
cd "$HOME"
python3 -m venv env
start=$(date +%s%N)
env/bin/pip install --quiet --no-index --disable-pip-version-check /wheel/*.whl
echo "installed in $((($(date +%s%N) - start) / 1000000)) ms, $(du -sm env/lib/python3*/site-packages/strut | cut -f 1) MB"
env/bin/python -X dev -W error - <<'PROGRAM'
import hashlib, strut, sys
crawler = strut.load(strut.models / "crawler/crawler.yaml")
run = crawler.run(accuracy="0.5 %")
assert abs(run.velocity - 0.01003) < 1e-5, run.velocity
assert len(crawler.equilibria().standing) > 3
assert run.svg().count("<path") > 100 and "<use" in run.svg()  # lines, and letters
assert "Dygraph" in run.html()
assert set(crawler.sweep(frequency=[9, 10], keep="velocity").status) == {"completed"}
sim = crawler.simulation()
sim.advance(1000)
try:
    run["position"]
except ImportError as error:
    assert "numpy" in str(error)
try:
    run.plot()
except ImportError as error:
    print(error)
print("python", sys.version.split()[0], "motion", hashlib.sha256(bytes(run._raw.array("position"))).hexdigest())
PROGRAM
USE

for suite; do
  bare "$suite"
  open_box use "$roots/$suite"
  echo "== $suite"
  within use 'apt-get -qq update
    apt-get -qq -o Dpkg::Use-Pty=0 install -y --no-install-recommends python3-venv
    useradd --create-home user' >"$scratch/log" 2>&1 || { tail -n 20 "$scratch/log"; exit 1; }
  mkdir "$scratch/use/root/wheel"
  cp "$wheel" "$scratch/use.sh" "$scratch/use/root/wheel"
  within use 'su user -c "sh /wheel/use.sh"' | tee "$scratch/said"
  sed -n 's/.* motion //p' "$scratch/said" >"$scratch/bits.$suite"
  [ -s "$scratch/bits.$suite" ]
  for other in "$scratch"/bits.*; do cmp "$other" "$scratch/bits.$suite"; done
  close_box use
done
echo "$(basename "$wheel"), $(stat -c %s "$wheel") bytes: installed and used in $*"
