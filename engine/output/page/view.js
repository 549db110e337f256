/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws a structure to scale on a surface {context, width, height}: stage, card or file. */
"use strict";
(function (page) {
  const SIGNED = [[10, 31, 102], [47, 74, 158], [125, 131, 144], [201, 139, 69], [245, 163, 26]];
  const SEQUENCE = [[42, 15, 84], [51, 80, 140], [31, 138, 140], [85, 181, 103], [211, 203, 47]];
  const KINDS = { bar: 0, spring: 1, cable: 2 };
  const WIDTHS = [4.2, 2.4, 1.5], DASHES = [[], [7, 2.5], []]; /* dashes where no force is known */
  const KIND_NAMES = ["bar", "spring", "cable"], FONT = "11px system-ui, 'DejaVu Sans', sans-serif";
  const SLACK_DASH = [4, 3], PALE = 0.4;

  page.MOST_NAMES = 60; /* of nodes that are written */

  function between(anchors, part) {
    const place = Math.min(Math.max(part, 0), 1) * (anchors.length - 1);
    const i = Math.min(Math.floor(place), anchors.length - 2), t = place - i;
    const mix = anchors[i].map((v, k) => Math.round(v + t * (anchors[i + 1][k] - v)));
    return "rgb(" + mix.join(",") + ")";
  }
  page.signedColour = (value) => between(SIGNED, 0.5 + 0.5 * value);
  page.sequenceColour = (value) => between(SEQUENCE, value);

  /* Colours of the style sheet, read once for each scheme. */
  page.theme = function () {
    const style = getComputedStyle(document.documentElement), theme = {};
    for (const name of ["paper", "ink", "soft", "line", "bar", "spring", "cable", "slack", "casing",
      "warm", "accent"]) theme[name] = style.getPropertyValue("--" + name).trim();
    return theme;
  };

  /* The context of a canvas, its pixels those of the screen; size in CSS pixels. */
  page.prepareCanvas = function (canvas) {
    const ratio = window.devicePixelRatio || 1;
    const width = canvas.clientWidth, height = canvas.clientHeight;
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    const context = canvas.getContext("2d");
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    return { context, width, height };
  };

  /* Data that do not change between frames. */
  page.structureOf = function (data) {
    const count = data.members.length, guides = data.members.map((m) => m.guides || []);
    const shades = count > 500 ? 9 : 33; /* strokes cost more than members */
    const from = new Int32Array(count), to = new Int32Array(count), kind = new Uint8Array(count);
    data.members.forEach((m, j) => {
      from[j] = m.from;
      to[j] = m.to;
      kind[j] = KINDS[m.kind];
    });
    const buckets = 3 * shades + 1; /* the last: slack cables */
    return { data, count, from, to, kind, guides, shades, buckets, bucket: new Int32Array(count),
      start: new Int32Array(buckets + 1), order: new Int32Array(count) };
  };

  /* A camera {x, y, scale} that shows the bounds in a picture of this size. */
  page.fit = function (bounds, width, height, margin, size) {
    const wide = Math.max(bounds[2] - bounds[0], 0), high = Math.max(bounds[3] - bounds[1], 0);
    const scale = Math.min((width - 2 * margin) / (wide || size * 1e-3),
      (height - 2 * margin) / (high || size * 1e-3));
    const largest = Math.min(width, height) / (0.05 * size);
    return { x: 0.5 * (bounds[0] + bounds[2]), y: 0.5 * (bounds[1] + bounds[3]),
      scale: Math.min(scale, largest) };
  };

  function thinness(s, position, camera) {
    let sum = 0, step = Math.max(1, Math.floor(s.count / 200)), n = 0;
    for (let j = 0; j < s.count; j += step, n++)
      sum += Math.hypot(position[2 * s.to[j]] - position[2 * s.from[j]],
        position[2 * s.to[j] + 1] - position[2 * s.from[j] + 1]);
    return n ? Math.min(1, Math.max(0.16, sum / n * camera.scale / 45)) : 1;
  }

  /* Sorts members into buckets of one pen each. */
  function sortMembers(s, shape, limit) {
    const middle = (s.shades - 1) / 2, last = s.buckets - 1;
    s.start.fill(0);
    for (let j = 0; j < s.count; j++) {
      let b;
      const force = shape.force ? shape.force[j] : 0;
      if (s.kind[j] === 2 && shape.force && force === 0) b = last;
      else {
        const part = limit > 0 ? Math.max(-1, Math.min(1, force / limit)) : 0;
        b = s.kind[j] * s.shades + Math.round(middle * (part + 1));
      }
      s.bucket[j] = b;
      s.start[b + 1]++;
    }
    for (let b = 0; b < s.buckets; b++) s.start[b + 1] += s.start[b];
    const next = s.start.slice();
    for (let j = 0; j < s.count; j++) s.order[next[s.bucket[j]]++] = j;
  }

  /* The path through points [[x, y], ...]. */
  function outline(c, points, closed = false) {
    c.beginPath();
    points.forEach(([x, y], k) => c[k ? "lineTo" : "moveTo"](x, y));
    if (closed) c.closePath();
  }
  function circle(c, x, y, radius) {
    c.beginPath();
    c.arc(x, y, radius, 0, 2 * Math.PI);
  }

  function trace(c, s, first, last, px, py) {
    c.beginPath();
    for (let k = first; k < last; k++) {
      const j = s.order[k];
      c.moveTo(px[s.from[j]], py[s.from[j]]);
      for (const g of s.guides[j]) c.lineTo(px[g], py[g]);
      c.lineTo(px[s.to[j]], py[s.to[j]]);
    }
  }

  /* Hinges: an arc around the node, from the first arm to the second by the angle nearest to rest. */
  function drawHinges(c, data, px, py, options) {
    c.strokeStyle = options.theme.accent;
    c.lineWidth = 1.4;
    for (const h of data.hinges) {
      const [a, b, o] = [h.nodes[0], h.nodes[2], h.nodes[1]];
      const first = Math.atan2(py[a] - py[o], px[a] - px[o]);
      const arm = Math.min(Math.hypot(px[a] - px[o], py[a] - py[o]),
        Math.hypot(px[b] - px[o], py[b] - py[o]));
      let angle = first - Math.atan2(py[b] - py[o], px[b] - px[o]); /* counter-clockwise */
      angle += 2 * Math.PI * Math.round((h.rest_angle - angle) / (2 * Math.PI));
      c.beginPath();
      c.arc(px[o], py[o], Math.min(options.small ? 5 : 12, 0.4 * arm), first, first - angle, angle > 0);
      c.stroke();
    }
  }

  /* Cells: filled polygons below the members. */
  function drawCells(c, data, px, py, options) {
    c.fillStyle = options.theme.accent;
    c.globalAlpha = 0.15;
    for (const cell of data.cells) {
      outline(c, cell.nodes.map((n) => [px[n], py[n]]));
      c.fill();
    }
    c.globalAlpha = 1;
  }

  /* Bodies that may collide, as thick as they are. */
  function drawCollisions(c, s, px, py, scale, options) {
    c.strokeStyle = c.fillStyle = options.theme.accent;
    c.globalAlpha = 0.15;
    c.lineCap = "round";
    for (const collision of s.data.collisions) {
      c.lineWidth = collision.thickness * scale;
      for (const n of collision.nodes) {
        circle(c, px[n], py[n], 0.5 * c.lineWidth);
        c.fill();
      }
      for (const m of collision.members) {
        outline(c, [s.from[m], s.to[m]].map((n) => [px[n], py[n]]));
        c.stroke();
      }
    }
    c.globalAlpha = 1;
  }

  function drawMembers(c, s, shape, options, px, py, thin) {
    const theme = options.theme, coloured = options.colour && shape.force;
    const slack = s.buckets - 1;
    sortMembers(s, shape, coloured ? options.limit : 0);
    c.lineCap = s.count > 500 ? "butt" : "round";
    if (coloured && s.count <= 500) { /* an edge separates light colours from the paper */
      c.strokeStyle = theme.casing;
      for (let kind = 0; kind < 2; kind++) {
        c.lineWidth = (WIDTHS[kind] + 1.4) * thin;
        trace(c, s, s.start[kind * s.shades], s.start[(kind + 1) * s.shades], px, py);
        c.stroke();
      }
    }
    for (let b = 0; b < s.buckets; b++) {
      if (s.start[b] === s.start[b + 1]) continue;
      const kind = b === slack ? 2 : Math.floor(b / s.shades);
      c.lineWidth = Math.max(0.5, WIDTHS[kind] * thin * (b === slack ? 0.7 : 1));
      c.strokeStyle = b === slack ? theme.slack : coloured
        ? page.signedColour((b % s.shades) / (s.shades - 1) * 2 - 1) : theme[KIND_NAMES[kind]];
      c.setLineDash(b === slack ? SLACK_DASH : coloured || options.small ? [] : DASHES[kind]);
      trace(c, s, s.start[b], s.start[b + 1], px, py);
      c.stroke();
    }
    c.setLineDash([]);
  }

  function drawSupports(c, data, px, py, theme) {
    c.strokeStyle = theme.soft;
    c.fillStyle = theme.paper;
    c.lineWidth = 1.2;
    data.nodes.forEach((node, i) => {
      if (!node.fixed[0] && !node.fixed[1]) return;
      const turn = node.fixed[1] ? 0 : Math.PI / 2, both = node.fixed[0] && node.fixed[1];
      c.save();
      c.translate(px[i], py[i]);
      c.rotate(turn);
      outline(c, [[0, 0], [6.5, 11], [-6.5, 11]], true);
      c.fill();
      c.stroke();
      outline(c, [-9, 9].map((x) => [x, both ? 11 : 14.5]));
      c.stroke();
      c.restore();
    });
  }

  function drawNodes(c, s, px, py, options) {
    const data = s.data;
    const theme = options.theme, count = data.nodes.length;
    if (count > 400) return;
    c.fillStyle = theme.paper;
    c.strokeStyle = theme.ink;
    c.lineWidth = 1.2;
    const radius = options.small ? 1.8 : 3.2;
    for (let i = 0; i < count; i++) {
      circle(c, px[i], py[i], radius);
      c.fill();
      c.stroke();
    }
    if (!options.names || count > page.MOST_NAMES) return;
    const taken = [14, 30].map((y) => [0, options.clock || 0, y]); /* by the time */
    const middle = (p) => p.reduce((a, b) => a + b, 0) / count;
    const [mx, my] = [middle(px), middle(py)]; /* names stand outside of a structure */
    c.font = "italic 13px system-ui, 'DejaVu Sans', sans-serif";
    c.textBaseline = "middle";
    c.lineWidth = 3;
    for (let i = 0; i < count; i++) {
      const far = Math.hypot(px[i] - mx, py[i] - my), on = data.ground && data.contacts.includes(i);
      const dx = far > 6 ? (px[i] - mx) / far : 0.7; /* but above their contacts' forces */
      const dy = on ? -0.7 : far > 6 ? (py[i] - my) / far : -0.7;
      const full = data.nodes[i].name, name = full.length > 24 ? full.slice(0, 23) + "\u2026" : full;
      c.textAlign = dx > 0.3 ? "left" : dx < -0.3 ? "right" : "center";
      const x = px[i] + 9 * dx, y = py[i] + 14 * dy;
      const wide = c.measureText(name).width;
      const left = x - (dx > 0.3 ? 0 : dx < -0.3 ? wide : wide / 2);
      if (taken.some((t) => left < t[1] && t[0] < left + wide && Math.abs(y - t[2]) < 12)) continue;
      taken.push([left, left + wide, y]);
      c.strokeStyle = theme.paper;
      c.strokeText(name, x, y);
      c.fillStyle = theme.ink;
      c.fillText(name, x, y);
    }
  }

  function roundLength(rough) {
    const power = Math.pow(10, Math.floor(Math.log10(rough))), part = rough / power;
    return power * (part < 1.5 ? 1 : part < 3.5 ? 2 : part < 7.5 ? 5 : 10);
  }

  /* The ground's line, body, and marks that scroll with it. */
  function drawGround(c, ground, camera, width, height, options) {
    if (!ground) return;
    const theme = options.theme, slope = Math.tan(ground.slope);
    const yAt = (x) => ground.height + slope * x;
    const sx = (x) => width / 2 + (x - camera.x) * camera.scale;
    const sy = (y) => height / 2 - (y - camera.y) * camera.scale;
    const left = camera.x - width / 2 / camera.scale, right = camera.x + width / 2 / camera.scale;
    const ends = [[sx(left), sy(yAt(left))], [sx(right), sy(yAt(right))]];
    c.fillStyle = theme.line;
    c.globalAlpha = 0.35;
    outline(c, [...ends, ...[ends[1], ends[0]].map(([x, y]) => [x, y + 4 * height])]);
    c.fill();
    c.globalAlpha = 1;
    c.strokeStyle = theme.soft;
    c.lineWidth = 1.2;
    outline(c, ends);
    c.stroke();
    if (options.small) return;
    const step = roundLength(110 / camera.scale);
    const into = [Math.sin(ground.slope), Math.cos(ground.slope)];
    c.font = FONT;
    c.fillStyle = theme.soft;
    c.textAlign = "center";
    c.textBaseline = "middle";
    for (let k = Math.ceil(left / step); k * step <= right; k++) {
      const x = sx(k * step), y = sy(yAt(k * step));
      outline(c, [[x, y], [x + 6 * into[0], y + 6 * into[1]]]);
      c.stroke();
      if (x < 26 || x > width - 26) continue; /* no half words at the edges */
      c.fillText(page.quantity(k * step, "m", 4), x + 26 * into[0], y + 14 * into[1]);
    }
  }

  /* Outlines of several grounds and the solid beside them. */
  function drawSurfaces(c, surfaces, place, theme) {
    for (const points of surfaces || []) {
      c.strokeStyle = theme.line;
      c.globalAlpha = 0.5;
      c.lineWidth = 7;
      c.lineCap = "butt";
      c.beginPath();
      for (let k = 0; k + 1 < points.length; k++) {
        const [ax, ay] = place(...points[k]), [bx, by] = place(...points[k + 1]);
        const length = Math.hypot(bx - ax, by - ay) || 1;
        const ox = -(by - ay) / length * 4, oy = (bx - ax) / length * 4;
        c.moveTo(ax + ox, ay + oy);
        c.lineTo(bx + ox, by + oy);
      }
      c.stroke();
      c.globalAlpha = 1;
      c.strokeStyle = theme.soft;
      c.lineWidth = 1.2;
      outline(c, points.map((p) => place(...p)));
      c.stroke();
    }
  }

  /* Direction of the segment of an outline that is nearest to a point. */
  function tangentNear(points, x, y) {
    let best = Infinity, tangent = [1, 0];
    for (let k = 0; k + 1 < points.length; k++) {
      const [ax, ay] = points[k], dx = points[k + 1][0] - ax, dy = points[k + 1][1] - ay;
      const length = Math.hypot(dx, dy);
      const t = Math.max(0, Math.min(1, ((x - ax) * dx + (y - ay) * dy) / (length * length)));
      const away = Math.hypot(x - ax - t * dx, y - ay - t * dy);
      if (away < best) best = away, tangent = [dx / length, dy / length];
    }
    return tangent;
  }

  function drawArrow(c, x1, y1, x2, y2) {
    const length = Math.hypot(x2 - x1, y2 - y1);
    if (length < 2) return;
    const ux = (x2 - x1) / length, uy = (y2 - y1) / length, head = Math.min(9, length);
    outline(c, [[x1, y1], [x2 - 0.8 * head * ux, y2 - 0.8 * head * uy]]);
    c.stroke();
    outline(c, [[x2, y2], ...[0.4, -0.4].map((side) =>
      [x2 - head * (ux + side * uy), y2 - head * (uy - side * ux)])]);
    c.fill();
  }

  /* Contact forces: the normal force ends at its node, friction starts there. */
  function drawForces(c, data, shape, options, px, py) {
    if (!shape.contact || !options.arrows || !(options.contactLimit > 0)) return;
    const slope = data.ground ? data.ground.slope : 0, longest = options.small ? 16 : 46;
    const level = [Math.cos(slope), Math.sin(slope)];
    c.strokeStyle = c.fillStyle = options.theme.warm;
    c.lineWidth = 2;
    data.contacts.forEach((node, i) => {
      const tangent = data.surfaces ? tangentNear(data.surfaces[data.contact_surfaces[i]],
        shape.position[2 * node], shape.position[2 * node + 1]) : level;
      const normal = Math.min(1.6, shape.contact[2 * i] / options.contactLimit) * longest;
      const along = Math.max(-1.6, Math.min(1.6, shape.contact[2 * i + 1] / options.contactLimit)) *
        longest;
      drawArrow(c, px[node] + normal * tangent[1], py[node] + normal * tangent[0], px[node],
        py[node]);
      drawArrow(c, px[node], py[node], px[node] + along * tangent[0], py[node] - along * tangent[1]);
    });
  }

  function drawTrails(c, trails, place) {
    c.lineWidth = 1.6;
    c.lineCap = "round";
    for (const trail of trails || []) {
      const pieces = Math.min(12, trail.length / 2 - 1);
      for (let k = 0; k < pieces; k++) {
        const first = Math.floor(k * (trail.length / 2 - 1) / pieces);
        const last = Math.floor((k + 1) * (trail.length / 2 - 1) / pieces);
        c.strokeStyle = page.sequenceColour((k + 0.5) / pieces);
        c.beginPath();
        for (let i = first; i <= last; i++) c.lineTo(...place(trail[2 * i], trail[2 * i + 1]));
        c.stroke();
      }
    }
  }

  /* Positions on the picture, [px, py]. */
  function placeAll(position, place) {
    const px = new Float64Array(position.length / 2), py = new Float64Array(position.length / 2);
    for (let i = 0; i < px.length; i++)
      [px[i], py[i]] = place(position[2 * i], position[2 * i + 1]);
    return [px, py];
  }

  /* Another structure {structure, position}, pale and without its forces. */
  function drawGhost(c, ghost, camera, place, options) {
    const [px, py] = placeAll(ghost.position, place);
    c.globalAlpha = PALE;
    drawMembers(c, ghost.structure, { force: null }, options, px, py,
      thinness(ghost.structure, ghost.position, camera));
    c.globalAlpha = 1;
  }

  /* Draws a shape {position, force, contact, trails, ghost} as the camera sees it. */
  page.drawStructure = function (surface, s, shape, camera, options) {
    const { context: c, width, height } = surface, data = s.data, count = data.nodes.length;
    const place = (x, y) => [width / 2 + (x - camera.x) * camera.scale,
      height / 2 - (y - camera.y) * camera.scale];
    const [px, py] = placeAll(shape.position, place);
    drawGround(c, data.ground, camera, width, height, options);
    drawSurfaces(c, data.surfaces, place, options.theme);
    if (shape.ghost) drawGhost(c, shape.ghost, camera, place, options);
    if (!options.small || count <= 60) drawSupports(c, data, px, py, options.theme);
    drawTrails(c, shape.trails, place);
    drawCells(c, data, px, py, options);
    drawCollisions(c, s, px, py, camera.scale, options);
    drawMembers(c, s, shape, options, px, py,
      thinness(s, shape.position, camera) * (options.small ? 0.6 : 1));
    if (data.hinges.length <= 400) drawHinges(c, data, px, py, options);
    drawNodes(c, s, px, py, options);
    drawForces(c, data, shape, options, px, py);
    if (options.key) drawKey(surface, s, shape, options);
  };

  /* The prefix for numbers up to a size: its text and what it stands for. */
  page.prefixOf = function (size) {
    const group = size > 0 ? Math.min(Math.max(Math.floor(Math.log10(size) / 3 + 1e-12), -5), 4) : 0;
    return { factor: Math.pow(1000, group),
      text: ["f", "p", "n", "\u00b5", "m", "", "k", "M", "G", "T"][group + 5] };
  };

  /* A number with a prefix: "9.78 mm/s". */
  page.quantity = function (value, unit, digits) {
    if (value === null || value === undefined || !isFinite(value)) return "\u2013";
    if (value === 0) return "0 " + unit;
    const { factor, text } = page.prefixOf(Math.abs(Number(value.toPrecision(digits))));
    const number = Number((value / factor).toPrecision(digits));
    return String(number).replace("-", "\u2212") + " " + text + unit;
  };

  /* Digits after the point that tell neighbouring times apart, at most six. */
  page.decimalsOf = function (time) {
    let least = Infinity;
    for (let f = 1; f < time.length; f++) least = Math.min(least, time[f] - time[f - 1]);
    return Math.min(6, Math.max(0, Math.ceil(-Math.log10(least) - 1e-6)));
  };

  /* A time with so many digits, as wide as the last one. */
  page.timeText = function (t, decimals, last) {
    return t.toFixed(decimals).padStart(last.toFixed(decimals).length, "\u2007");
  };

  /* strut's texts are ASCII; the page has the letter of micro. */
  page.micro = (text) =>
    text.replace(/(\d) u(?=(?:m|s|g|N|J|W|Pa|Hz|rad)(?![A-Za-z]))/g, "$1 \u00b5");

  /* At the right of the picture: the scale of forces, low values at the bottom, or the pens of the
     kinds of members. */
  function drawKey(surface, s, shape, options) {
    const coloured = options.colour && shape.force && options.limit > 0;
    surface.context.font = FONT;
    if (coloured) drawColourScale(surface, options);
    else drawKinds(surface, s, options.theme);
  }

  function drawColourScale({ context: c, width, height }, { limit, theme }) {
    const right = width - 12, top = 32, bottom = Math.min(170, height - 60), parts = 44;
    const part = (bottom - top) / parts;
    c.fillStyle = theme.soft;
    c.textBaseline = "top";
    c.textAlign = "right";
    c.fillText("force", right, 12);
    for (let k = 0; k < parts; k++) {
      c.fillStyle = page.signedColour(1 - 2 * (k + 0.5) / parts);
      c.fillRect(right - 12, top + k * part, 12, part + (k + 1 < parts ? 0.5 : 0));
    }
    c.fillStyle = theme.soft;
    c.textBaseline = "middle";
    for (const value of [1, 0, -1])
      c.fillText(page.quantity(value * limit, "N", 3), right - 18,
        top + (1 - value) / 2 * (bottom - top) + 5 * value);
  }

  function drawKinds({ context: c, width }, s, theme) {
    const right = width - 12;
    c.textBaseline = "middle";
    c.textAlign = "right";
    c.lineCap = "butt";
    KIND_NAMES.filter((_, kind) => s.kind.includes(kind)).forEach((name, row) => {
      const kind = KINDS[name], y = 20 + 18 * row;
      c.strokeStyle = theme[name];
      c.lineWidth = WIDTHS[kind];
      c.setLineDash(DASHES[kind]);
      outline(c, [[right - 26, y], [right, y]]);
      c.stroke();
      c.setLineDash([]);
      c.fillStyle = theme.soft;
      c.fillText(name, right - 33, y);
    });
  }
})(window.strutPage);
