#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The container image is built and runs the crawler, where podman or buildah is there.
#
#   sh tests/container.sh ROOT
set -eu
cd "$1"
if command -v podman >/dev/null; then
  podman build -q -t localhost/strut-test -f docs/Containerfile . >/dev/null
  said=$(podman run --rm localhost/strut-test run /usr/share/strut/models/crawler/crawler.yaml --accuracy 0.5%)
elif command -v buildah >/dev/null; then
  buildah build -q -t localhost/strut-test -f docs/Containerfile . >/dev/null
  box=$(buildah from localhost/strut-test)
  said=$(buildah run "$box" -- strut run /usr/share/strut/models/crawler/crawler.yaml --accuracy 0.5%)
  buildah rm "$box" >/dev/null
else
  echo "skipped: needs podman or buildah"
  exit 77
fi
echo "$said" | grep -F '10.03 mm/s'
