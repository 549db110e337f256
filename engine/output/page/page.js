/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The page: puts data, drawing, player, charts and cards together. */
"use strict";
(function (page) {
  const element = (id) => document.getElementById(id);
  const data = JSON.parse(element("strut-data").textContent);
  const structure = page.structureOf(data);
  const MARGIN = 46, TRAIL_FRAMES = 400, TRAIL_NODES = 60, TRAIL_PART = 0.1;
  const MEASURED = 3e5;
  let motion = null, player = null, charts = null, cards = null, theme = page.theme();
  let picked = -1, limits = { force: 0, contact: 0 }, whole = null, extent = null, track = null;
  let camera = { x: 0, y: 0, scale: 1 }, waiting = false;
  let elsewhere = false; /* another shape is shown: even a free camera moves to it */
  const drawTimes = [];
  let decimals = 0;

  /* Finds the ranges that all frames share. Of many values a sample suffices, at uneven steps:
     even ones would meet a periodic motion always in the same phase. */
  function measure() {
    const count = data.nodes.length, normals = [];
    const step = Math.max(1, motion.frames * (count + data.members.length) / MEASURED);
    let wide = 0, high = [Infinity, -Infinity];
    whole = [Infinity, Infinity, -Infinity, -Infinity];
    for (let k = 0; k * step < motion.frames; k++) {
      const uneven = step > 1 ? k * 0.618034 % 1 : 0;
      const shape = shapeAt(Math.min(motion.frames - 1, Math.floor((k + uneven) * step)));
      const b = page.boundsOf(shape.position);
      wide = Math.max(wide, b[2] - b[0]);
      high = [Math.min(high[0], b[1]), Math.max(high[1], b[3])];
      whole = [Math.min(whole[0], b[0]), Math.min(whole[1], b[1]), Math.max(whole[2], b[2]),
        Math.max(whole[3], b[3])];
      const own = page.limitsOf({ force: shape.force });
      limits.force = Math.max(limits.force, own.force);
      if (shape.contact) normals.push(page.limitsOf({ contact: shape.contact }).contact);
    }
    normals.sort((a, b) => a - b); /* impacts are short: the scale suits most frames */
    limits.contact = normals.length ? normals[Math.floor(0.9 * (normals.length - 1))] : 0;
    extent = [0, high[0], wide, high[1]];
    if (count === 1) extent[2] = data.size;
  }

  function shapeAt(frame) {
    const nodes = 2 * data.nodes.length, members = data.members.length;
    const touching = 2 * data.contacts.length;
    const part = (values, size) =>
      values ? values.subarray(frame * size, (frame + 1) * size) : null;
    return { position: part(motion.position, nodes), force: part(motion.force, members),
      contact: part(motion.contact, touching) };
  }

  function trailsAt(frame) {
    const count = data.nodes.length;
    if (!element("trails").checked || count > TRAIL_NODES) return [];
    const length = Math.max(2, Math.min(Math.round(TRAIL_PART * motion.frames), TRAIL_FRAMES));
    const first = Math.max(0, frame - length), used = frame - first;
    if (used < 1) return [];
    const trails = [];
    for (let i = 0; i < count; i++) {
      const path = new Float64Array(2 * (used + 1));
      for (let k = 0; k <= used; k++) {
        path[2 * k] = motion.position[2 * ((first + k) * count + i)];
        path[2 * k + 1] = motion.position[2 * ((first + k) * count + i) + 1];
      }
      trails.push(path);
    }
    return trails;
  }

  function currentShape() {
    if (picked >= 0) return page.shapeOf(data, data.equilibria[picked]);
    if (!motion) return { position: data.start, force: null, contact: null };
    const shape = shapeAt(player.frame);
    shape.trails = trailsAt(player.frame);
    return shape;
  }

  function aim(shape, coloured) {
    const canvas = element("canvas"), height = canvas.clientHeight, mode = element("camera").value;
    const scale = coloured ? (canvas.clientWidth > 600 ? 72 : 48) : 0; /* width of the colour bar */
    const width = canvas.clientWidth - scale;
    canvas.classList.toggle("free", mode === "free");
    if (mode === "free" && !elsewhere) return;
    elsewhere = false;
    if (picked >= 0 || !motion)
      camera = page.fit(page.boundsOf(shape.position), width, height, MARGIN, data.size);
    else if (mode === "whole") camera = page.fit(whole, width, height, MARGIN, data.size);
    else {
      const b = page.boundsOf(shape.position);
      camera = page.fit(extent, width, height, MARGIN, data.size);
      camera.x = data.nodes.length > 1 ? track(player.frame) + offset : 0.5 * (b[0] + b[2]);
    }
    camera.x += 0.5 * scale / camera.scale;
  }
  let offset = 0; /* mean distance of the structure's middle from the tracked point */

  function draw() {
    waiting = false;
    const begin = performance.now(), shape = currentShape();
    const own = picked >= 0 ? page.limitsOf(shape) : limits;
    const coloured = element("colour").checked && Boolean(shape.force) && own.force > 0;
    aim(shape, coloured);
    page.drawStructure(element("canvas"), structure, shape, camera, {
      theme, colour: element("colour").checked, arrows: element("arrows").checked,
      names: element("names").checked, limit: own.force, contactLimit: own.contact });
    element("colours").hidden = !coloured;
    if (coloured && own.force !== draw.scale) {
      page.drawColourScale(element("colours"), own.force, theme);
      draw.scale = own.force;
    }
    drawTimes.push(performance.now() - begin);
    if (drawTimes.length > 600) drawTimes.shift();
  }
  function redraw() {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(draw);
  }

  const decimal = (time) => String(Number(time.toPrecision(12)));
  function decimalsOf(times) {
    let most = 0;
    for (let f = 0; f < Math.min(times.length, 20); f++)
      most = Math.max(most, (decimal(times[f]).split(".")[1] || "").length);
    return Math.min(most, 9);
  }

  function showTime(frame) {
    const clock = element("clock"), time = document.createElement("b");
    const count = document.createElement("span"), text = decimal(motion.time[frame]);
    const fixed = motion.time[frame].toFixed(decimals); /* so that digits do not jump */
    time.textContent = (Number(fixed) === Number(text) ? fixed : text) + " s";
    count.textContent = "frame " + (frame + 1) + " of " + motion.frames;
    clock.replaceChildren(time, count);
  }

  function onFrame(frame) {
    if (picked >= 0) pick(-1);
    showTime(frame);
    if (charts) charts.show(frame);
    redraw();
  }

  function pick(index) {
    picked = index === picked ? -1 : index;
    elsewhere = true;
    if (picked >= 0 && player) player.pause();
    element("shown").hidden = picked < 0;
    element("clock").hidden = picked >= 0 || !motion;
    if (picked >= 0) element("shown-name").textContent = data.equilibria[picked].name;
    if (cards) cards.mark(picked);
    redraw();
  }

  /* The free camera: drag to move, wheel to zoom at the pointer. */
  function freeCamera() {
    const canvas = element("canvas");
    let from = null;
    canvas.addEventListener("pointerdown", (event) => {
      from = [event.clientX, event.clientY];
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (!from) return;
      element("camera").value = "free";
      camera.x -= (event.clientX - from[0]) / camera.scale;
      camera.y += (event.clientY - from[1]) / camera.scale;
      from = [event.clientX, event.clientY];
      redraw();
    });
    for (const name of ["pointerup", "pointercancel"])
      canvas.addEventListener(name, () => { from = null; });
    canvas.addEventListener("wheel", (event) => {
      if (element("camera").value !== "free") return; /* the page scrolls on */
      event.preventDefault();
      const box = canvas.getBoundingClientRect(), factor = Math.exp(-event.deltaY * 0.0015);
      const dx = event.clientX - box.left - box.width / 2;
      const dy = event.clientY - box.top - box.height / 2;
      camera.x += dx / camera.scale * (1 - 1 / factor);
      camera.y -= dy / camera.scale * (1 - 1 / factor);
      camera.scale *= factor;
      redraw();
    }, { passive: false });
  }

  function wire() {
    for (const id of ["trails", "colour", "arrows", "names", "camera"])
      element(id).addEventListener("change", redraw);
    element("back").addEventListener("click", () => pick(-1));
    element("back").textContent = motion ? "Back to the motion" : "Back to the start";
    const again = () => {
      theme = page.theme();
      draw.scale = null;
      if (cards) cards.draw();
      if (charts) charts.restyle();
      redraw();
    };
    window.addEventListener("resize", again);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", again);
    freeCamera();
  }

  /* Hides choices without effect. */
  function offerChoices() {
    const still = !motion || motion.frames < 2, coloured = (motion && motion.force) ||
      (data.equilibria || []).some((e) => e.force);
    element("trails").parentElement.hidden = still || data.nodes.length > TRAIL_NODES;
    element("arrows").parentElement.hidden = data.contacts.length === 0;
    element("colour").parentElement.hidden = !coloured;
    if (!still) return;
    element("camera").querySelector("[value=whole]").remove();
    element("camera").options[0].textContent = "fits";
    element("back").textContent = "Back to the start";
  }

  async function start() {
    page.fillPanels(data);
    motion = await page.decodeMotion(data.motion);
    element("transport").hidden = !motion || motion.frames < 2;
    if (motion) {
      track = page.trackedX(data, motion);
      decimals = decimalsOf(motion.time);
      measure();
      for (let k = 0; k <= 20; k++) {
        const frame = Math.round(k / 20 * (motion.frames - 1));
        const b = page.boundsOf(shapeAt(frame).position);
        offset += (0.5 * (b[0] + b[2]) - track(frame)) / 21;
      }
      player = page.createPlayer(motion.time, onFrame);
      element("charts-section").hidden = motion.frames < 2;
      if (motion.frames > 1)
        charts = page.createCharts(data, motion, (time) => {
          player.pause();
          player.seekTime(time);
        });
      if (charts && charts.empty) element("charts-section").hidden = true;
    }
    offerChoices();
    if ((data.equilibria || []).length) {
      cards = page.createCards(data, structure, pick);
      cards.draw();
    }
    wire();
    if (player) player.seek(0);
    redraw();
  }

  const ready = start();
  ready.catch((error) => {
    element("trouble").hidden = false;
    element("trouble").textContent = typeof DecompressionStream === "function"
      ? "This page is damaged: " + error.message
      : "This browser is too old for this page: it cannot unpack data (DecompressionStream).";
  });

  /* For tests: the state shown, and the actions of the buttons. */
  window.strut = {
    ready,
    data,
    get frame() { return player ? player.frame : 0; },
    get frames() { return motion ? motion.frames : 0; },
    get time() { return motion ? motion.time[player.frame] : 0; },
    get playing() { return Boolean(player && player.playing); },
    get picked() { return picked; },
    positions: () => Array.from(currentShape().position),
    onStage() { /* positions of the nodes on the canvas [pixels] */
      const canvas = element("canvas"), shape = currentShape(), at = [];
      aim(shape, !element("colours").hidden);
      for (let i = 0; i < shape.position.length; i += 2)
        at.push(canvas.clientWidth / 2 + (shape.position[i] - camera.x) * camera.scale,
          canvas.clientHeight / 2 - (shape.position[i + 1] - camera.y) * camera.scale);
      return at;
    },
    seek: (frame) => player.seek(frame),
    play: () => player.play(),
    pause: () => player.pause(),
    charts: () => (charts ? charts.charts.map((c) => ({ name: c.kind.name,
      cursor: parseFloat(c.cursor.style.left), x: c.graph.toDomXCoord(motion.time[player.frame]) }))
      : []),
    drawTimes
  };
})(window.strutPage);
