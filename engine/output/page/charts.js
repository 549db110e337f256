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

  /* Chooses the curves that vary most, but first those with data. */
  function liveliest(curves, frames) {
    const ranges = curves.map((curve, index) => ({ index, range: curve.dots ? Infinity : rangeOf(curve, frames) }));
    ranges.sort((a, b) => (b.range > a.range) - (a.range > b.range));
    const chosen = ranges.slice(0, MOST_CURVES).filter((r) => r.range > 0).map((r) => r.index);
    return chosen.sort((a, b) => a - b).map((index) => curves[index]);
  }

  /* What is measured of a column of a channel, [[time, number], ...] in the unit of its curve; null: nothing. */
  function dotsOf(block, index, convert) {
    const rows = block.data ? block.data[index] : [];
    return rows.length ? rows.map(([t, v]) => [t, convert(v)]).sort((a, b) => a[0] - b[0]) : null;
  }

  /* Displacements of the measured point along x and of all nodes. */
  function displacements({ data, motion, track }) {
    const count = data.nodes.length, node = data.motion.track, first = track(0);
    const point = { name: (node === null ? "centre of mass" : data.nodes[node].name) + " x",
      at: (frame) => track(frame) - first };
    return [point, ...data.nodes.flatMap((n, i) => ["x", "y"].map((axis, d) => {
      const at = column(motion.position, 2 * count, 2 * i + d), start = at(0);
      return { name: n.name + " " + axis, at: (frame) => at(frame) - start,
        dots: dotsOf(data.motion.position, 2 * i + d, (v) => v - start) };
    }))];
  }

  /* The measured point, unless nodes move much more: then the coordinates that move most; and those with data. */
  function mostMoved([point, ...others], frames) {
    const dotted = others.filter((curve) => curve.dots).slice(0, MOST_CURVES - 1);
    if (dotted.length) return [point, ...dotted];
    const all = others.map((curve) => ({ curve, range: rangeOf(curve, frames) }))
      .sort((a, b) => b.range - a.range);
    if (rangeOf(point, frames) >= LARGE * all[0].range) return [point];
    return all.slice(0, MOST_MOVING).filter((c) => c.range > LARGE * all[0].range)
      .map((c) => c.curve);
  }

  /* Channels with a chart in this order, then all others: another name or unit, only the first component. */
  const CHANNELS = { contact: { name: "contact force", first: true }, force: { name: "member force" },
    angle: { unit: "deg", factor: 180 / Math.PI }, moment: {}, pressure: {}, area: {}, energy: {} };

  /* A channel as the table of channels describes it: columns of each name, the last of which may be the total. */
  function kindOf(name, block, values) {
    const { unit, factor = 1, first, name: said = name.replaceAll("_", " ") } = CHANNELS[name] || {};
    const names = block.names || [""], parts = block.components;
    const curves = Array.from({ length: block.columns }, (_, i) => {
      const at = column(values, block.columns, i), part = first ? "" : parts[i % parts.length];
      return { name: (names[Math.floor(i / parts.length)] + " " + part).trim(),
        at: factor === 1 ? at : (frame) => factor * at(frame),
        dots: dotsOf(block, i, (v) => factor * v) };
    });
    return { name: said, unit: unit || block.unit,
      curves: first ? curves.filter((_, i) => i % parts.length === 0) : curves };
  }

  function heights({ data, motion }) {
    const slope = Math.tan(data.ground.slope), cosine = Math.cos(data.ground.slope);
    const count = data.nodes.length, p = motion.position;
    return { name: "height above the ground", unit: "m", curves: data.contacts.map((n) => ({
      name: data.nodes[n].name, at: (frame) => cosine *
        (p[2 * (frame * count + n) + 1] - data.ground.height - slope * p[2 * (frame * count + n)]) })) };
  }

  /* The possible charts of a run: {name, unit, curves: [{name, at(frame)}]}, all curves of each. */
  function kindsOf(run) {
    const { data, motion } = run, kinds = [{ name: "displacement", unit: "m", curves: displacements(run) }];
    const names = new Set([...Object.keys(CHANNELS), ...Object.keys(data.motion)]);
    for (const name of names) {
      const block = data.motion[name];
      if (name === "energy" && data.ground && data.contacts.length) kinds.push(heights(run));
      if (name !== "position" && motion[name] && block.components)
        kinds.push(kindOf(name, block, motion[name]));
    }
    return kinds;
  }

  /* Of each kind the curves to show, each with that of the same name of the other run, or null. */
  function chooseCurves(run, other) {
    const others = new Map(other ? kindsOf(other).map((kind) => [kind.name, kind.curves]) : []);
    const frames = run.motion.frames;
    return kindsOf(run).map((kind) => {
      const moved = kind.name === "displacement";
      const curves = moved ? mostMoved(kind.curves, frames) : liveliest(kind.curves, frames);
      const beside = others.get(kind.name) || [];
      return { ...kind, curves, all: moved ? curves.length : kind.curves.length,
        beside: curves.map((c) => beside.find((b) => b.name === c.name) || null) };
    }).filter((kind) => kind.curves.length);
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

  /* Rows of the first run's curves and then of the second's; null where one has no such time. */
  function merge(first, second, counts) {
    const rows = [], gap = (n) => new Array(n).fill(null);
    let i = 0, k = 0;
    while (i < first.length || k < second.length) {
      const a = i < first.length ? first[i][0] : Infinity;
      const b = k < second.length ? second[k][0] : Infinity;
      const near = Math.abs(a - b) <= 1e-9 * Math.abs(a) && a < Infinity || a === b;
      const one = near || a < b ? first[i++].slice(1) : gap(counts[0]);
      const two = near || b < a ? second[k++].slice(1) : gap(counts[1]);
      rows.push([Math.min(a, b), ...one, ...two]);
    }
    return rows;
  }

  /* Rows with columns of dots behind the others. */
  function addDots(rows, all) {
    return all.reduce((sum, dots) => merge(sum, dots, [sum[0].length - 1, 1]), rows);
  }

  /* Without a prefix: units that take none. */
  function prefixOf(kind, frames) {
    if (/^kg|\^2$|deg/.test(kind.unit)) return { text: "", factor: 1 };
    let most = 0;
    const step = Math.max(1, Math.floor(frames / 2000));
    for (const curve of kind.curves)
      for (let f = 0; f < frames; f += step) most = Math.max(most, Math.abs(curve.at(f)));
    return page.prefixOf(most);
  }

  page.createCharts = function (onTime) {
    const element = (id) => document.getElementById(id);
    const host = element("charts"), choices = element("chart-choices");
    const charts = new Map(), chosen = new Map(); /* by name of their kind; what the user chose */
    let kinds = [], time = null, ghost = null, window_ = null, frame = 0, busy = false;

    function placeCursor(chart) {
      chart.cursor.style.left = chart.graph.toDomXCoord(time[frame]) + "px";
      const [low, high] = chart.graph.xAxisRange();
      chart.cursor.hidden = !(time[frame] >= low && time[frame] <= high);
    }

    /* Rows of a chart; curves(kind) are those of the first run, then those of the other. */
    function rowsOf(own, beside, low, high, rows) {
      const first = rows(time, own, low, high);
      return beside.length
        ? merge(first, rows(ghost.time, beside, low, high), [own.length, beside.length]) : first;
    }
    function scaled(kind) {
      const scale = (c) => ({ at: (f) => c.at(f) / kind.prefix.factor });
      return [kind.curves.map(scale), kind.beside.filter(Boolean).map(scale)];
    }
    function shownRows(chart) {
      const [low, high] = window_ || [time[0], time[time.length - 1]];
      const seen = chart.kind.curves.filter((c) => c.dots).map(({ dots }) => dots.filter(([t]) =>
        t >= low && t <= high).map(([t, v]) => [t, v / chart.kind.prefix.factor]));
      return addDots(rowsOf(...scaled(chart.kind), low, high, thin), seen);
    }

    function zoomTo(range) { /* all charts alike */
      if (busy) return;
      busy = true;
      window_ = range;
      for (const chart of charts.values()) {
        chart.graph.updateOptions({ file: shownRows(chart), dateWindow: range });
        placeCursor(chart);
      }
      busy = false;
    }

    /* Drag: time. */
    function seekByDragging(chart) {
      const seek = (event) => {
        const x = event.clientX - chart.plot.getBoundingClientRect().left;
        onTime(chart.graph.toDataXCoord(x));
      };
      chart.plot.addEventListener("pointerdown", (event) => {
        if (event.shiftKey || event.button) return;
        seek(event);
        window.addEventListener("pointermove", seek);
        window.addEventListener("pointerup", () => window.removeEventListener("pointermove", seek),
          { once: true });
      });
    }

    /* With Shift: zoom. Double-click: all. */
    const interaction = {
      mousedown: (event, g, context) => {
        if (!event.shiftKey) return;
        context.initializeMouseDown(event, g, context);
        Dygraph.startZoom(event, g, context);
      },
      mousemove: (...given) => Dygraph.defaultInteractionModel.mousemove(...given),
      mouseup: (...given) => Dygraph.defaultInteractionModel.mouseup(...given),
      dblclick: () => zoomTo(null)
    };

    function createBox() {
      const part = (className, ...children) => page.make("div", { className }, ...children);
      const title = part("chart-title"), plot = part("plot"), cursor = part("cursor");
      const chart = { box: part("", title, part("chart", plot, cursor)), title, plot, cursor,
        graph: null, kind: null };
      seekByDragging(chart);
      return chart;
    }

    function fillTitle(chart) {
      const kind = chart.kind, few = kind.all > kind.curves.length;
      chart.title.replaceChildren(kind.name + " in " + kind.prefix.text + kind.unit + (few
        ? " (the " + kind.curves.length + " of " + kind.all + " that vary most)" : ""));
      kind.curves.forEach((curve, i) => {
        const swatch = page.make("i"), name = curve.name + (curve.dots ? " (dots: measured)" : "");
        swatch.style.background = COLOURS[i % COLOURS.length];
        chart.title.append(page.make("span", {}, swatch, page.make("bdi", { textContent: name })));
      });
    }

    /* Draws a kind into its box, which stays in place. Names are in the title: dygraphs has numbers. */
    function fill(chart) {
      const { kind, plot } = chart, line = page.theme().line, series = {};
      const beside = kind.curves.map((_, i) => i).filter((i) => kind.beside[i]);
      const dotted = kind.curves.map((_, i) => i).filter((i) => kind.curves[i].dots);
      const colour = (i) => COLOURS[i % COLOURS.length];
      const labels = ["time", ...kind.curves.map((_, i) => String(i)),
        ...beside.map((i) => "beside " + i), ...dotted.map((i) => "dots " + i)];
      const data = { file: shownRows(chart), dateWindow: window_ };
      fillTitle(chart);
      if (chart.graph && chart.graph.getLabels().join() === labels.join()) {
        chart.graph.updateOptions(data); /* much faster than another one */
        placeCursor(chart);
        return;
      }
      for (const i of beside) series["beside " + i] = { strokePattern: [6, 3] };
      for (const i of dotted) series["dots " + i] = { strokeWidth: 0, drawPoints: true, pointSize: 2.4 };
      if (chart.graph) chart.graph.destroy();
      chart.graph = null;
      chart.graph = new Dygraph(plot, data.file, {
        labels, series, connectSeparatedPoints: true,
        colors: [...kind.curves.map((_, i) => colour(i)), ...[...beside, ...dotted].map(colour)],
        strokePattern: null, strokeWidth: 1.3, highlightCircleSize: 0, legend: "never",
        axes: { y: { axisLabelWidth: 52 }, x: { drawGrid: true } },
        axisLineColor: line, gridLineColor: line, gridLineWidth: 0.6,
        yRangePad: 5, dateWindow: window_, interactionModel: interaction, animatedZooms: false,
        drawCallback: () => chart.graph && placeCursor(chart),
        zoomCallback: (from, to) => zoomTo([from, to]),
        underlayCallback: null });
      placeCursor(chart);
    }

    function remove(name) {
      const chart = charts.get(name);
      if (!chart) return;
      chart.graph.destroy();
      chart.box.remove();
      charts.delete(name);
    }

    const isShown = (kind, i) => (chosen.has(kind.name) ? chosen.get(kind.name) : i < SHOWN);

    /* Draws the charts that are chosen, in the order of their kinds, and removes others. */
    function update() {
      const shown = kinds.filter(isShown), names = shown.map((kind) => kind.name);
      for (const name of [...charts.keys()]) if (!names.includes(name)) remove(name);
      shown.forEach((kind, place) => {
        const chart = charts.get(kind.name) || createBox();
        charts.set(kind.name, chart);
        if (host.children[place] !== chart.box)
          host.insertBefore(chart.box, host.children[place] || null);
        if (chart.kind === kind) return;
        chart.kind = kind;
        fill(chart);
      });
      element("save-csv").hidden = shown.length === 0;
    }

    function offerKinds() {
      choices.replaceChildren(...kinds.map((kind, i) => {
        const box = page.make("input", { type: "checkbox", checked: isShown(kind, i) });
        box.addEventListener("change", () => {
          chosen.set(kind.name, box.checked);
          update();
        });
        return page.make("label", {}, box, " " + kind.name);
      }));
    }

    /* Replaces what is shown: by the curves of a run with motion, or of none (null). */
    function load(run, besideRun) {
      const names = kinds.map((kind) => kind.name).join();
      const moves = run && !run.still;
      ghost = moves && besideRun && besideRun.run.motion ? besideRun : null;
      time = moves ? run.time : null;
      frame = 0;
      kinds = moves ? chooseCurves(run, ghost && ghost.run) : [];
      for (const kind of kinds) kind.prefix = prefixOf(kind, time.length);
      if (window_ && !(time && window_[0] < time[time.length - 1] && window_[1] > time[0]))
        window_ = null;
      if (kinds.map((kind) => kind.name).join() !== names) offerKinds();
      element("charts-section").hidden = kinds.length === 0; /* before charts look at its width */
      update();
    }

    /* Time and all shown curves of all frames, as rows of a table. */
    function table() {
      const all = kinds.filter(isShown), label = ghost ? ghost.run.data.label || "beside" : "";
      const heads = (kind, curves, more) => curves.map((c) =>
        kind.name + ": " + c.name + more + " [" + kind.unit + "]");
      const own = all.flatMap((kind) => kind.curves);
      const beside = all.flatMap((kind) => kind.beside.filter(Boolean));
      const dotted = (curves) => curves.filter((c) => c.dots);
      const frames = (times, curves) =>
        Array.from(times, (t, f) => [t, ...curves.map((c) => c.at(f))]);
      return [["time [s]", ...all.flatMap((kind) => heads(kind, kind.curves, "")),
        ...all.flatMap((kind) => heads(kind, kind.beside.filter(Boolean), " of " + label)),
        ...all.flatMap((kind) => heads(kind, dotted(kind.curves), " measured"))],
      ...addDots(rowsOf(own, beside, 0, 0, frames), dotted(own).map((c) => c.dots))];
    }

    return { load, table,
      get charts() { return [...charts.values()]; },
      restyle() {
        const line = page.theme().line;
        for (const chart of charts.values())
          chart.graph.updateOptions({ axisLineColor: line, gridLineColor: line });
      },
      show(at) {
        frame = at;
        for (const chart of charts.values()) placeCursor(chart);
      } };
  };
})(window.strutPage);
