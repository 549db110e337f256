#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Structures at rest that are large enough for sparse algebra: what is known of chains and nets in closed form.
. "$(dirname "$0")/lib.sh"
bench=$here/../bench

# Two diagonals cross in every frame, and no node lies on another.
sh "$bench/xgrid.sh" 1000 >net.yaml
gives '.equilibria[0].crossings' 256 0 equilibria net.yaml
near '.equilibria[0].collapsed == false | if . then 1 else 0 end' 1 0
sh "$bench/xchain.sh" 1000 >chain.yaml
gives '.equilibria[0].crossings' 200 0 equilibria chain.yaml

shows 0 "200 crossings" equilibria chain.yaml
