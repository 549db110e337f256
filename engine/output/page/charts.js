/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Charts over time by dygraphs, linked to each other and to the player. */
"use strict";
(function (page) {
  const COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#b8860b", "#56b4e9", "#7a7a7a"];
  const MOST_CURVES = 7, POINTS = 1500, SHOWN = 3;
  const MOST_MOVING = 3, LARGE = 0.3; /* coordinates in the first chart; of the largest motion */

  /* A column of the motion as a function of the frame. */
  function column(values, columns, index) {
    return (frame) => values[frame * columns + index];
  }

  function rangeOf(curve, frames) {
    const step = Math.max(1, Math.floor(frames / 2000));
    let low = Infinity, high = -Infinity;
    for (let f = 0; f < frames; f += step) {
      const value = curve.at(f);
      if (value < low) low = value;
      if (value > high) high = value;
    }
    return high > low ? high - low : 0;
  }

  /* Chooses the curves that vary most. */
  function liveliest(curves, frames) {
    const ranges = curves.map((curve, index) => ({ index, range: rangeOf(curve, frames) }));
    ranges.sort((a, b) => b.range - a.range);
    const chosen = ranges.slice(0, MOST_CURVES).filter((r) => r.range > 0).map((r) => r.index);
    return chosen.sort((a, b) => a - b).map((index) => curves[index]);
  }

  page.trackedX = function (data, motion) {
    const count = data.nodes.length, node = data.motion.track, weights = data.motion.weights;
    if (node !== null || !weights) return column(motion.position, 2 * count, 2 * (node || 0));
    const total = weights.reduce((a, b) => a + b, 0) || 1;
    return (frame) => {
      let sum = 0;
      for (let i = 0; i < count; i++) sum += weights[i] * motion.position[2 * (frame * count + i)];
      return sum / total;
    };
  };

  /* The measured point's displacement along x, unless nodes move much more: then the coordinates that
     move most. */
  function displacements(data, motion, track) {
    const count = data.nodes.length, node = data.motion.track, first = track(0);
    const point = { name: (node === null ? "centre of mass" : data.nodes[node].name) + " x",
      at: (frame) => track(frame) - first };
    const all = data.nodes.flatMap((n, i) => ["x", "y"].map((axis, d) => {
      const at = column(motion.position, 2 * count, 2 * i + d), start = at(0);
      return { name: n.name + " " + axis, at: (frame) => at(frame) - start };
    })).map((curve) => ({ curve, range: rangeOf(curve, motion.frames) }))
      .sort((a, b) => b.range - a.range);
    if (rangeOf(point, motion.frames) >= LARGE * all[0].range) return [point];
    return all.slice(0, MOST_MOVING).filter((c) => c.range > LARGE * all[0].range)
      .map((c) => c.curve);
  }

  /* A channel as the table of channels describes it: columns of each thing, then of their total. */
  function plainKind(data, name, block, values) {
    const things = data[block.things] || [], components = block.components;
    const nameOf = (k) => k >= things.length ? "total" : things[k].name ||
      (data.contact_names ? data.contact_names[k] : data.nodes[things[k]].name);
    return { name: name.replaceAll("_", " "), unit: block.unit,
      curves: Array.from({ length: block.columns }, (_, i) => ({
        name: (nameOf(Math.floor(i / components.length)) + " " + components[i % components.length]).trim(),
        at: column(values, block.columns, i) })) };
  }

  /* The possible charts: {name, unit, curves: [{name, at(frame)}]}. */
  function kindsOf(data, motion) {
    const count = data.nodes.length, kinds = [], track = page.trackedX(data, motion);
    kinds.push({ name: "displacement", unit: "m", curves: displacements(data, motion, track) });
    if (motion.contact)
      kinds.push({ name: "contact force", unit: "N", curves: data.contacts.map((n, i) => ({
        name: data.contact_names ? data.contact_names[i] : data.nodes[n].name,
        at: column(motion.contact, 2 * data.contacts.length, 2 * i) })) });
    if (motion.force)
      kinds.push({ name: "member force", unit: "N", curves: data.members.map((m, j) => ({
        name: m.name, at: column(motion.force, data.members.length, j) })) });
    if (motion.angle)
      kinds.push({ name: "angle", unit: "deg", curves: data.hinges.map((h, i) => {
        const radians = column(motion.angle, data.hinges.length, i);
        return { name: h.name, at: (frame) => radians(frame) * (180 / Math.PI) };
      }) });
    if (motion.moment)
      kinds.push({ name: "moment", unit: "N m", curves: data.hinges.map((h, i) => ({
        name: h.name, at: column(motion.moment, data.hinges.length, i) })) });
    if (motion.pressure)
      kinds.push({ name: "pressure", unit: "N/m", curves: data.cells.map((c, i) => ({
        name: c.name, at: column(motion.pressure, data.cells.length, i) })) });
    if (motion.area)
      kinds.push({ name: "area", unit: "m^2", curves: data.cells.map((c, i) => ({
        name: c.name, at: column(motion.area, data.cells.length, i) })) });
    if (data.ground && data.contacts.length) {
      const slope = Math.tan(data.ground.slope), cosine = Math.cos(data.ground.slope);
      kinds.push({ name: "height above the ground", unit: "m", curves: data.contacts.map((n) => ({
        name: data.nodes[n].name,
        at: (frame) => (motion.position[2 * (frame * count + n) + 1] - data.ground.height -
          slope * motion.position[2 * (frame * count + n)]) * cosine })) });
    }
    if (motion.energy)
      kinds.push({ name: "energy", unit: "J", curves: data.motion.energy_names.map((name, i) => ({
        name, at: column(motion.energy, data.motion.energy_names.length, i) })) });
    for (const [name, block] of Object.entries(data.motion))
      if (block && block.unit) kinds.push(plainKind(data, name, block, motion[name]));
    for (const kind of kinds) {
      kind.all = kind.curves.length;
      kind.curves = liveliest(kind.curves, motion.frames);
    }
    return kinds.filter((kind) => kind.curves.length);
  }

  /* Rows for dygraphs: all frames of a time range or, if there are many, the least and largest of
     every curve in each part of it. */
  function thin(time, curves, low, high) {
    let first = 0, last = time.length - 1;
    while (first < last && time[first + 1] < low) first++;
    while (last > first && time[last - 1] > high) last--;
    const count = last - first + 1, rows = [];
    if (count <= 2 * POINTS) {
      for (let f = first; f <= last; f++) rows.push([time[f], ...curves.map((c) => c.at(f))]);
      return rows;
    }
    for (let k = 0; k < POINTS; k++) {
      const from = first + Math.floor(k * count / POINTS);
      const to = Math.max(from + 2, first + Math.floor((k + 1) * count / POINTS));
      const lows = [], highs = [];
      for (const curve of curves) {
        let least = Infinity, most = -Infinity, leastAt = from, mostAt = from;
        for (let f = from; f < to && f <= last; f++) {
          const value = curve.at(f);
          if (value < least) least = value, leastAt = f;
          if (value > most) most = value, mostAt = f;
        }
        const rising = leastAt <= mostAt;
        lows.push(rising ? least : most);
        highs.push(rising ? most : least);
      }
      rows.push([time[from], ...lows], [time[Math.min(to - 1, last)], ...highs]);
    }
    return rows;
  }

  function prefixOf(curves, frames) {
    let most = 0;
    const step = Math.max(1, Math.floor(frames / 2000));
    for (const curve of curves)
      for (let f = 0; f < frames; f += step) most = Math.max(most, Math.abs(curve.at(f)));
    const group = most > 0 ? Math.min(Math.max(Math.floor(Math.log10(most) / 3 + 1e-12), -5), 4) : 0;
    return { factor: Math.pow(1000, group),
      text: ["f", "p", "n", "\u00b5", "m", "", "k", "M", "G", "T"][group + 5] };
  }

  page.createCharts = function (data, motion, onTime) {
    const host = document.getElementById("charts"), choices = document.getElementById("chart-choices");
    const charts = [], kinds = kindsOf(data, motion);
    let window_ = null, frame = 0, busy = false;

    function placeCursor(chart) {
      chart.cursor.style.left = chart.graph.toDomXCoord(motion.time[frame]) + "px";
      const [low, high] = chart.graph.xAxisRange();
      chart.cursor.hidden = !(motion.time[frame] >= low && motion.time[frame] <= high);
    }

    function zoomTo(range) { /* all charts alike */
      if (busy) return;
      busy = true;
      window_ = range;
      const [low, high] = range || [motion.time[0], motion.time[motion.frames - 1]];
      for (const chart of charts) {
        chart.graph.updateOptions({ file: thin(motion.time, chart.scaled, low, high),
          dateWindow: range });
        placeCursor(chart);
      }
      busy = false;
    }

    /* Drag: time. With Shift: zoom. Double-click: all. */
    function interaction(chart) {
      const seek = (event) => {
        const x = event.clientX - chart.plot.getBoundingClientRect().left;
        onTime(chart.graph.toDataXCoord(x));
      };
      chart.plot.addEventListener("pointerdown", (event) => {
        if (event.shiftKey || event.button) return;
        seek(event);
        const move = (e) => seek(e);
        window.addEventListener("pointermove", move);
        window.addEventListener("pointerup", () => window.removeEventListener("pointermove", move),
          { once: true });
      });
      const zoom = Dygraph.defaultInteractionModel;
      return {
        mousedown: (event, g, context) => {
          if (event.shiftKey) {
            context.initializeMouseDown(event, g, context);
            Dygraph.startZoom(event, g, context);
          }
        },
        mousemove: zoom.mousemove,
        mouseup: zoom.mouseup,
        dblclick: () => zoomTo(null)
      };
    }

    function add(kind) {
      const box = document.createElement("div"), title = document.createElement("div");
      const plot = document.createElement("div"), cursor = document.createElement("div");
      const holder = document.createElement("div"), prefix = /^kg|\^2$|deg/.test(kind.unit)
        ? { text: "", factor: 1 } : prefixOf(kind.curves, motion.frames);
      const chart = { kind, box, plot, cursor };
      chart.scaled = kind.curves.map((c) => ({ at: (f) => c.at(f) / prefix.factor }));
      title.className = "chart-title";
      title.append(kind.name + " in " + prefix.text + kind.unit + (kind.all > kind.curves.length
        ? " (the " + kind.curves.length + " of " + kind.all + " that vary most)" : ""));
      kind.curves.forEach((curve, i) => {
        const span = document.createElement("span"), swatch = document.createElement("i");
        const name = document.createElement("bdi");
        swatch.style.background = COLOURS[i % COLOURS.length];
        name.textContent = curve.name;
        span.append(swatch, name);
        title.append(span);
      });
      holder.className = "chart";
      plot.className = "plot";
      cursor.className = "cursor";
      holder.append(plot, cursor);
      box.append(title, holder);
      host.append(box);
      const [low, high] = window_ || [motion.time[0], motion.time[motion.frames - 1]];
      chart.graph = new Dygraph(plot, thin(motion.time, chart.scaled, low, high), {
        labels: ["time", ...kind.curves.map((_, i) => String(i))], /* names are in the title */
        colors: kind.curves.map((_, i) => COLOURS[i % COLOURS.length]),
        strokePattern: null, strokeWidth: 1.3, highlightCircleSize: 0, legend: "never",
        axes: { y: { axisLabelWidth: 52 }, x: { drawGrid: true } },
        axisLineColor: page.theme().line, gridLineColor: page.theme().line, gridLineWidth: 0.6,
        yRangePad: 5, dateWindow: window_, interactionModel: {}, animatedZooms: false,
        drawCallback: () => chart.graph && placeCursor(chart),
        zoomCallback: (from, to) => zoomTo([from, to]),
        underlayCallback: null });
      chart.graph.updateOptions({ interactionModel: interaction(chart) });
      charts.push(chart);
      placeCursor(chart);
    }

    function remove(kind) {
      const at = charts.findIndex((chart) => chart.kind === kind);
      if (at < 0) return;
      charts[at].graph.destroy();
      charts[at].box.remove();
      charts.splice(at, 1);
    }

    kinds.forEach((kind, i) => {
      const label = document.createElement("label"), box = document.createElement("input");
      box.type = "checkbox";
      box.checked = i < SHOWN;
      box.addEventListener("change", () => (box.checked ? add(kind) : remove(kind)));
      label.append(box, " " + kind.name);
      choices.append(label);
      if (box.checked) add(kind);
    });

    return { charts, zoomTo, empty: kinds.length === 0,
      restyle() {
        const line = page.theme().line;
        for (const chart of charts)
          chart.graph.updateOptions({ axisLineColor: line, gridLineColor: line });
      },
      show(at) {
        frame = at;
        for (const chart of charts) placeCursor(chart);
      } };
  };
})(window.strutPage);
