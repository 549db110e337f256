/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The page: puts runs, drawing, player, charts and cards together.
 *
 * strutPage.show(data, beside) shows the data of page.h, and beside them those of a second run or
 * none; any number of times. What the user chose stays. It returns a promise that is kept when they
 * are shown, and broken if they are damaged. strutPage.onPick(index), if set, is called when a card
 * is chosen, strutPage.onFrame(frame) when another frame is shown; strutPage.seek(frame) shows one.
 * The element #live is for controls of later scripts.
 */
"use strict";
(function (page) {
  const element = (id) => document.getElementById(id);
  const MARGIN = 46, CLOCK = 22, DRAW_TIMES = 600; /* CLOCK: its height above the structure */
  let run = null, ghost = null, theme = page.theme();
  let picked = -1, decimals = 0, camera = { x: 0, y: 0, scale: 1 }, waiting = false;
  let elsewhere = true; /* another shape is shown: even a free camera moves to it */
  let asked = 0, shown = 0; /* calls of show */
  const drawTimes = [];
  const player = page.createPlayer(onFrame);
  const cards = page.createCards(pick);
  const charts = page.createCharts((time) => {
    player.pause();
    player.seekTime(time);
  });

  function pickedShape() {
    return page.shapeOf(run.data, run.data.equilibria[picked]);
  }
  function currentShape() {
    if (picked >= 0) return pickedShape();
    const shape = run.shapeAt(player.frame);
    if (run.hasTrails && element("trails").checked) shape.trails = run.trailsAt(player.frame);
    const position = ghost && page.ghostAt(ghost, run.time && run.time[player.frame]);
    if (position) shape.ghost = { structure: ghost.run.structure, position };
    return shape;
  }
  const currentLimits = (shape) => (picked >= 0 ? page.limitsOf(shape) : run.limits);

  function aim(shape) {
    const canvas = element("canvas"), height = canvas.clientHeight, mode = element("camera").value;
    const key = canvas.clientWidth > 600 ? 72 : 48; /* width of the key at the right */
    const width = canvas.clientWidth - key;
    canvas.classList.toggle("free", mode === "free");
    if (mode === "free" && !elsewhere) return;
    elsewhere = false;
    let bounds = page.boundsOf(shape.position);
    const middle = 0.5 * (bounds[0] + bounds[2]);
    const follows = picked < 0 && run.motion && !run.made && (mode !== "whole" || run.still);
    if (picked < 0 && run.motion) bounds = follows ? run.extent : run.whole;
    if (ghost && picked < 0 && !follows) bounds = page.union(bounds, ghostBounds());
    camera = page.fit(bounds, width, height - CLOCK, MARGIN, run.data.size);
    camera.y += 0.5 * CLOCK / camera.scale;
    if (follows)
      camera.x = run.data.nodes.length > 1 ? run.track(player.frame) + run.offset : middle;
    camera.x += 0.5 * key / camera.scale;
  }
  function ghostBounds() {
    const [left, low, right, high] = ghost.run.whole;
    return [left + ghost.shift, low, right + ghost.shift, high];
  }

  function paint(surface, shape) {
    const limits = currentLimits(shape), clock = element("clock");
    page.drawStructure(surface, run.structure, shape, camera, { theme, key: true,
      clock: clock.offsetLeft + clock.offsetWidth,
      colour: element("colour").checked, arrows: element("arrows").checked,
      names: element("names").checked, limit: limits.force, contactLimit: limits.contact });
  }

  function draw() {
    waiting = false;
    if (!run) return;
    if (!drawTimes.length) performance.mark("strut-first-picture");
    const begin = performance.now(), shape = currentShape();
    aim(shape);
    paint(page.prepareCanvas(element("canvas")), shape);
    drawTimes.push(performance.now() - begin);
    if (drawTimes.length > DRAW_TIMES) drawTimes.shift();
  }
  function redraw() {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(draw);
  }

  function showTime(frame) {
    const clock = element("clock");
    if (run.made) {
      clock.textContent = run.made.clock[frame];
      return;
    }
    const last = run.motion.frames - 1, time = page.timeText(run.time[frame], decimals, run.time[last]);
    clock.replaceChildren(page.make("b", { textContent: time + " s" }),
      page.make("span", { textContent: "frame " + (frame + 1) + " of " + (last + 1) }));
  }

  function onFrame(frame) {
    if (picked >= 0) showPicked(-1);
    showTime(frame);
    if (!run.still) charts.show(frame);
    redraw();
    if (page.onFrame) page.onFrame(frame);
  }

  /* Enables the choices that have an effect on the shape shown. */
  function enableChoices() {
    const shape = picked >= 0 ? pickedShape() : run.shapeAt(player.frame);
    const limits = currentLimits(shape), where = picked >= 0 ? "this equilibrium" : run.motion
      ? "this motion" : "the start";
    const enable = (id, good, reason) => {
      element(id).disabled = !good;
      element(id).parentElement.title = good ? "" : reason;
    };
    enable("colour", limits.force > 0, "No member forces are known of " + where);
    enable("arrows", limits.contact > 0, "No contact forces are known of " + where);
    enable("trails", picked < 0, "An equilibrium does not move");
  }

  function showPicked(index) {
    picked = index;
    elsewhere = true;
    element("shown").hidden = picked < 0;
    element("clock").hidden = picked >= 0 || !run.motion;
    if (picked >= 0) element("shown-name").textContent = run.data.equilibria[picked].name;
    cards.mark(picked);
    enableChoices();
    redraw();
  }

  function pick(index) {
    showPicked(index === picked ? -1 : index);
    if (picked < 0) return;
    player.pause();
    if (page.onPick) page.onPick(picked);
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

  function restyle() {
    theme = page.theme();
    if (run) cards.draw();
    charts.restyle();
    redraw();
  }

  function wire() {
    for (const id of ["trails", "colour", "arrows", "names", "camera"])
      element(id).addEventListener("change", redraw);
    element("back").addEventListener("click", () => pick(-1));
    window.addEventListener("resize", restyle);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", restyle);
    freeCamera();
    page.wireCopy();
    page.wireDownloads({ csv: charts.table,
      runs: () => [run, ghost && ghost.run].filter(Boolean).map((r) => r.data),
      stage() {
        const canvas = element("canvas"), shape = currentShape(), name = run.data.name || "strut";
        const at = picked >= 0 ? run.data.equilibria[picked].name : run.motion
          ? run.time[player.frame].toFixed(decimals) + " s" : "start";
        return { width: canvas.clientWidth, height: canvas.clientHeight, title: name + ", " + at,
          paint: (surface) => paint(surface, shape) };
      } });
  }

  /* Hides choices without effect on any shape of the page. */
  function offerChoices() {
    const { data, motion, still } = run;
    const shapes = (data.equilibria || []).map((e) => page.shapeOf(data, e));
    if (motion) shapes.push(run.shapeAt(0));
    const hide = (id, hidden) => { element(id).parentElement.hidden = hidden; };
    hide("trails", !run.hasTrails);
    hide("colour", !shapes.some((shape) => shape.force));
    hide("arrows", !shapes.some((shape) => shape.contact));
    hide("names", data.nodes.length > page.MOST_NAMES);
    element("camera").querySelector("[value=whole]").hidden = still;
    element("camera").options[0].textContent = still ? "fits" : "follows";
    element("back").textContent = still ? "Back to the start" : "Back to the motion";
    element("transport").hidden = still;
    if (still && element("camera").value === "whole") element("camera").value = "follow";
  }

  /* An equilibrium that was chosen stays so where the new data have one of its name. */
  function keptPick(data) {
    if (picked < 0) return -1;
    return (data.equilibria || []).findIndex((e) => e.name === run.data.equilibria[picked].name);
  }

  function replace(newRun, newGhost) {
    const pickedNow = keptPick(newRun.data), first = !run;
    picked = -1;
    run = newRun;
    ghost = newGhost;
    decimals = run.motion ? page.decimalsOf(run.time) : 0;
    page.fillPanels(run, ghost);
    offerChoices();
    charts.load(run.made ? null : run, ghost);
    cards.load(run);
    player.load(run.time);
    showPicked(pickedNow);
    elsewhere = first;
  }

  async function load(call, data, beside) {
    const loaded = await page.loadRun(data), other = beside ? await page.loadRun(beside) : null;
    if (call < shown) return; /* a later call was faster */
    shown = call;
    replace(loaded, other && page.createGhost(loaded, other));
    element("trouble").hidden = true;
  }

  function report(error) {
    element("trouble").hidden = false;
    element("trouble").textContent = typeof DecompressionStream === "function"
      ? "This page is damaged: " + error.message
      : "This browser is too old for this page: it cannot unpack data (DecompressionStream).";
  }

  page.seek = (frame) => {
    player.pause();
    player.seek(frame);
  };

  let ready = Promise.resolve();
  page.show = function (data, beside) {
    ready = load(++asked, data, beside);
    ready.catch(report);
    return ready;
  };

  /* For tests: the state shown, and the actions of the buttons. */
  window.strut = {
    get ready() { return ready; },
    get data() { return run && run.data; },
    get frame() { return player.frame; },
    get frames() { return run && run.motion ? run.motion.frames : 0; },
    get time() { return run && run.motion ? run.time[player.frame] : 0; },
    get playing() { return player.playing; },
    get picked() { return picked; },
    positions: () => Array.from(currentShape().position),
    ghost() {
      const shape = currentShape();
      return shape.ghost ? Array.from(shape.ghost.position) : null;
    },
    onStage() { /* positions of the nodes on the canvas [pixels] */
      const canvas = element("canvas"), shape = currentShape(), at = [];
      aim(shape);
      for (let i = 0; i < shape.position.length; i += 2)
        at.push(canvas.clientWidth / 2 + (shape.position[i] - camera.x) * camera.scale,
          canvas.clientHeight / 2 - (shape.position[i + 1] - camera.y) * camera.scale);
      return at;
    },
    seek: (frame) => player.seek(frame),
    play: () => player.play(),
    pause: () => player.pause(),
    charts: () => charts.charts.map((c) => ({ name: c.kind.name, series: c.graph.numColumns() - 1,
      cursor: parseFloat(c.cursor.style.left), x: c.graph.toDomXCoord(run.time[player.frame]) })),
    drawTimes
  };

  /* Shows the data that are in the page, if there are any. */
  function showOwnData() {
    const read = (id) => {
      const text = element(id) ? element(id).textContent.trim() : "";
      return text ? JSON.parse(text) : null;
    };
    try {
      const data = read("strut-data");
      if (data) page.show(data, read("strut-beside"));
    } catch (error) {
      ready = Promise.reject(error);
      ready.catch(report);
    }
  }

  for (const id of ["transport", "parameters-section", "summary-section", "scene"])
    element(id).hidden = true; /* until there are data */
  wire();
  showOwnData();
})(window.strutPage);
