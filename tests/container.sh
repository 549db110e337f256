#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The container image is built and runs the crawler, where podman or buildah is there, and Debian's image can be had.
# Within a container or a sandbox BUILDAH_ISOLATION=chroot may be needed.
#
#   sh tests/container.sh ROOT
set -eu
cd "$1"
base=$(sed -n 's/^FROM \(.*\) AS build$/\1/p' docs/Containerfile)
crawler=/usr/share/strut/models/crawler/crawler.yaml
there() { "$1" inspect --type image "$base" >/dev/null 2>&1 || "$1" pull -q "$base" >/dev/null; }
if command -v podman >/dev/null; then
  there podman || { echo "skipped: podman cannot get $base"; exit 77; }
  podman build -q -t localhost/strut-test -f docs/Containerfile . >/dev/null
  said=$(podman run --rm localhost/strut-test run $crawler --accuracy 0.5%)
  podman rmi localhost/strut-test >/dev/null
elif command -v buildah >/dev/null; then
  there buildah || { echo "skipped: buildah cannot get $base"; exit 77; }
  buildah build -q --pull=false -t localhost/strut-test -f docs/Containerfile . >/dev/null
  box=$(buildah from --pull=false localhost/strut-test)
  said=$(buildah run "$box" -- strut run $crawler --accuracy 0.5%)
  buildah rm "$box" >/dev/null
  buildah rmi localhost/strut-test >/dev/null
else
  echo "skipped: needs podman or buildah"
  exit 77
fi
echo "$said" | grep -F '10.03 mm/s'
