/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A run as the page draws it: its motion decoded, its shapes, and the ranges of all frames. */
"use strict";
(function (page) {
  const MEASURED = 3e5; /* values looked at for the ranges */
  const MOST_TRAILS = 60, TRAIL_FRAMES = 400, TRAIL_PART = 0.1;

  page.boundsOf = function (position) {
    const b = [Infinity, Infinity, -Infinity, -Infinity];
    for (let i = 0; i < position.length; i += 2) {
      b[0] = Math.min(b[0], position[i]);
      b[1] = Math.min(b[1], position[i + 1]);
      b[2] = Math.max(b[2], position[i]);
      b[3] = Math.max(b[3], position[i + 1]);
    }
    return b;
  };

  page.union = (a, b) => [Math.min(a[0], b[0]), Math.min(a[1], b[1]), Math.max(a[2], b[2]),
    Math.max(a[3], b[3])];

  /* The largest forces of a shape. */
  page.limitsOf = function (shape) {
    let force = 0, contact = 0;
    for (const value of shape.force || []) force = Math.max(force, Math.abs(value));
    for (const value of shape.contact || []) contact = Math.max(contact, Math.abs(value));
    return { force, contact };
  };

  /* An equilibrium's shape; contact forces as the drawing expects them, normal and friction of each
     contact. */
  page.shapeOf = function (data, equilibrium) {
    const nodes = equilibrium.contacts || [], normal = equilibrium.normal;
    const contact = nodes.length && normal ? new Float64Array(2 * data.contacts.length) : null;
    nodes.forEach((node, k) => {
      const at = data.contacts.indexOf(node);
      if (at >= 0 && contact) contact[2 * at] = normal[k] || 0;
    });
    return { position: equilibrium.position, force: equilibrium.force || null, contact };
  };

  /* The x coordinate of the point that the run measures, over frames. */
  function trackedX(data, motion) {
    const count = data.nodes.length, node = data.motion.track, weights = data.motion.weights;
    if (node !== null || !weights)
      return (frame) => motion.position[2 * (frame * count + (node || 0))];
    const total = weights.reduce((a, b) => a + b, 0) || 1;
    return (frame) => {
      let sum = 0;
      for (let i = 0; i < count; i++) sum += weights[i] * motion.position[2 * (frame * count + i)];
      return sum / total;
    };
  }

  /* Finds the ranges that all frames share. Of many values a sample suffices, at uneven steps:
     even ones would meet a periodic motion always in the same phase. */
  function measure(run) {
    const { data, motion } = run, count = data.nodes.length, normals = [];
    const step = Math.max(1, motion.frames * (count + data.members.length) / MEASURED);
    let wide = 0, sum = 0, n = 0;
    for (let k = 0; k * step < motion.frames; k++, n++) {
      const uneven = step > 1 ? k * 0.618034 % 1 : 0;
      const frame = Math.min(motion.frames - 1, Math.floor((k + uneven) * step));
      const shape = run.shapeAt(frame), b = page.boundsOf(shape.position);
      wide = Math.max(wide, b[2] - b[0]);
      run.whole = page.union(run.whole, b);
      run.limits.force = Math.max(run.limits.force, page.limitsOf({ force: shape.force }).force);
      if (shape.contact) normals.push(page.limitsOf({ contact: shape.contact }).contact);
      sum += 0.5 * (b[0] + b[2]) - run.track(frame);
    }
    normals.sort((a, b) => a - b); /* impacts are short: the scale suits most frames */
    run.limits.contact = normals.length ? normals[Math.floor(0.9 * (normals.length - 1))] : 0;
    run.extent = [0, run.whole[1], count === 1 ? data.size : wide, run.whole[3]];
    run.offset = sum / n; /* of the structure's middle from the tracked point */
  }

  function trailsAt(run, frame) {
    const { motion } = run, count = run.data.nodes.length;
    const length = Math.max(2, Math.min(Math.round(TRAIL_PART * motion.frames), TRAIL_FRAMES));
    const first = Math.max(0, frame - length), used = frame - first;
    if (!run.hasTrails || used < 1) return [];
    return run.data.nodes.map((_, i) => {
      const path = new Float64Array(2 * (used + 1));
      for (let k = 0; k <= used; k++) {
        path[2 * k] = motion.position[2 * ((first + k) * count + i)];
        path[2 * k + 1] = motion.position[2 * ((first + k) * count + i) + 1];
      }
      return path;
    });
  }

  /* Decodes the data of a page. A run without motion has the shape at its start. */
  page.loadRun = async function (data) {
    const motion = await page.decodeMotion(data.motion);
    const nodes = data.nodes.length, still = !motion || motion.frames < 2;
    const part = (values, size, frame) =>
      values ? values.subarray(frame * size, (frame + 1) * size) : null;
    const run = { data, motion, still, structure: page.structureOf(data),
      hasTrails: !still && nodes <= MOST_TRAILS, limits: { force: 0, contact: 0 },
      made: data.motion && data.motion.made || null,
      whole: page.boundsOf(data.start), extent: null, offset: 0,
      time: motion ? motion.time : null, track: motion ? trackedX(data, motion) : null };
    run.shapeAt = (frame) => (motion
      ? { position: part(motion.position, 2 * nodes, frame),
        force: part(motion.force, data.members.length, frame),
        contact: part(motion.contact, 2 * data.contacts.length, frame) }
      : { position: data.start, force: null, contact: null });
    run.trailsAt = (frame) => trailsAt(run, frame);
    if (motion) {
      run.whole = [Infinity, Infinity, -Infinity, -Infinity];
      measure(run);
    }
    return run;
  };

  /*
   * A second run as a ghost behind the first: {run, time, delay, shift}. Recordings that do not
   * overlap begin together: time is the second's on the clock of the first, delayed by `delay`.
   * Structures of the same nodes begin at the same x, moved by `shift`.
   */
  page.createGhost = function (run, other) {
    const ghost = { run: other, time: other.time, delay: 0, shift: 0 };
    if (!run.motion || !other.motion) return ghost;
    const end = (time) => time[time.length - 1], length = (time) => end(time) - time[0];
    const common = Math.min(end(run.time), end(other.time)) - Math.max(run.time[0], other.time[0]);
    if (common < 0 || common < 0.5 * Math.min(length(run.time), length(other.time)))
      ghost.delay = run.time[0] - other.time[0];
    if (ghost.delay) ghost.time = other.time.map((t) => t + ghost.delay);
    const begin = Math.max(run.time[0], ghost.time[0]);
    const names = (r) => JSON.stringify(r.data.nodes.map((node) => node.name));
    if (names(run) === names(other))
      ghost.shift = run.track(page.nearestFrame(run.time, begin)) -
        other.track(page.nearestFrame(ghost.time, begin));
    return ghost;
  };

  /* The ghost's positions at a time of the first run, or null beyond its recording. */
  page.ghostAt = function (ghost, t) {
    const { time, run } = ghost;
    if (!time || t === null) return run.shapeAt(0).position;
    const last = time.length - 1, step = last > 0 ? (time[last] - time[0]) / last : 0;
    if (t < time[0] - step || t > time[last] + step) return null;
    const position = run.shapeAt(page.nearestFrame(time, t)).position;
    return position.map((x, i) => (i % 2 ? x : x + ghost.shift));
  };
})(window.strutPage);
