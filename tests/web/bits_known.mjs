/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Of bits_test.mjs: what it leaves out, and what differs by construction. */

/** Takes more than a second by the program. */
export const SLOW = new Set([
  "equilibria crawler/crawler.yaml",
  "equilibria gallery/arm.yaml",
  "equilibria gallery/pressed-pneunet.yaml",
  "equilibria gallery/six-boxes.yaml",
  "equilibria gallery/two-x-manipulator.yaml",
  "equilibria gallery/x-tower-on-slope.yaml",
  "equilibria parts/arch.yaml",
  "equilibria parts/michell-wheel.yaml",
  "equilibria parts/strut-wheel.yaml",
  "equilibria parts/vertebrae.yaml",
  "equilibria parts/wave-crawler-of-cells.yaml",
  "equilibria parts/x-chain.yaml",
  "equilibria topologies/clipper.yaml",
  "equilibria topologies/gull.yaml",
  "equilibria topologies/jib.yaml",
  "equilibria topologies/nine-member-floor.yaml",
  "equilibria topologies/nine-member.yaml",
  "equilibria topologies/prow.yaml",
  "rigidity parts/wave-crawler-of-cells.yaml",
  "run crawler/stops.yaml",
  "run parts/wave-crawler-of-cells.yaml"
]);

/** May differ, and why. */
export const DIFFERENT = new Set([]);
