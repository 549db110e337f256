/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files of what is shown: the stage as SVG and PNG, the curves as CSV, the numbers as JSON. */
"use strict";
(function (page) {
  /* Records what view.js draws as SVG: the methods of CanvasRenderingContext2D that it uses. */

  const number = (value) => String(Math.round(value * 100) / 100);

  /* A text as XML allows it, markup escaped. */
  page.xmlText = (text) => String(text)
    .replace(/[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\u{10000}-\u{10ffff}]/gu, "\ufffd")
    .replace(/[&<>"]/g, (c) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", "\"": "&quot;" })[c]);

  const BASELINES = { middle: 0.35, top: 0.85, alphabetic: 0 }; /* of the font's size */
  const ANCHORS = { left: "start", center: "middle", right: "end" };
  const KEPT = ["strokeStyle", "fillStyle", "lineWidth", "lineCap", "globalAlpha", "font",
    "textAlign", "textBaseline"];

  /* svg(title, paper) of the context is the document so far. */
  page.svgContext = function (width, height) {
    const context = { strokeStyle: "#000", fillStyle: "#000", lineWidth: 1, lineCap: "butt",
      globalAlpha: 1, font: "10px sans-serif", textAlign: "left", textBaseline: "alphabetic" };
    const ruler = document.createElement("canvas").getContext("2d"), stack = [], written = [];
    let matrix = [1, 0, 0, 1, 0, 0], dash = [], path = "";
    const scale = () => Math.hypot(matrix[0], matrix[1]);

    function at(x, y) {
      const [a, b, c, d, e, f] = matrix;
      return number(a * x + c * y + e) + " " + number(b * x + d * y + f);
    }
    function write(element, attributes, text) {
      const list = Object.entries(attributes)
        .map(([name, value]) => " " + name + "=\"" + page.xmlText(value) + "\"").join("");
      const content = text === undefined ? "/>" : ">" + page.xmlText(text) + "</" + element + ">";
      written.push("<" + element + list + content);
    }
    const opacity = (name) => (context.globalAlpha < 1 ? { [name]: context.globalAlpha } : {});
    const pen = () => ({ stroke: context.strokeStyle,
      "stroke-width": number(context.lineWidth * scale()), ...opacity("stroke-opacity") });
    const brush = () => ({ fill: context.fillStyle, ...opacity("fill-opacity") });

    function text(said, x, y, paint) {
      const [, italic, size, family] = /^(italic )?([\d.]+)px (.*)$/.exec(context.font);
      const place = at(x, y + BASELINES[context.textBaseline] * size).split(" ");
      write("text", { x: place[0], y: place[1], "font-size": size, "font-family": family,
        ...(italic ? { "font-style": "italic" } : {}),
        "text-anchor": ANCHORS[context.textAlign], ...paint }, said);
    }

    return Object.assign(context, {
      save() {
        stack.push([matrix, dash, KEPT.map((name) => context[name])]);
      },
      restore() {
        const [m, d, values] = stack.pop();
        matrix = m;
        dash = d;
        KEPT.forEach((name, i) => { context[name] = values[i]; });
      },
      transform(a, b, c, d, e, f) {
        const m = matrix;
        matrix = [m[0] * a + m[2] * b, m[1] * a + m[3] * b, m[0] * c + m[2] * d,
          m[1] * c + m[3] * d, m[0] * e + m[2] * f + m[4], m[1] * e + m[3] * f + m[5]];
      },
      translate(x, y) { context.transform(1, 0, 0, 1, x, y); },
      rotate(t) { context.transform(Math.cos(t), Math.sin(t), -Math.sin(t), Math.cos(t), 0, 0); },
      setLineDash(list) { dash = list; },
      measureText(said) {
        ruler.font = context.font;
        return ruler.measureText(said);
      },
      beginPath() { path = ""; },
      moveTo(x, y) { path += "M" + at(x, y); },
      lineTo(x, y) { path += (path ? "L" : "M") + at(x, y); },
      closePath() { path += "Z"; },
      arc(x, y, radius, from, to, backwards) {
        const turn = 2 * Math.PI, sign = backwards ? -1 : 1, ahead = sign * (to - from);
        const angle = sign * (ahead >= turn ? turn : ((ahead % turn) + turn) % turn);
        const r = number(radius * scale());
        context.lineTo(x + radius * Math.cos(from), y + radius * Math.sin(from));
        for (let k = 1; k <= 2; k++) { /* halves: one arc cannot be a whole circle */
          const t = from + angle * k / 2;
          path += "A" + r + " " + r + " 0 0 " + (backwards ? 0 : 1) + " " +
            at(x + radius * Math.cos(t), y + radius * Math.sin(t));
        }
      },
      stroke() {
        if (!path) return;
        write("path", { d: path, fill: "none", ...pen(),
          ...(context.lineCap === "butt" ? {} : { "stroke-linecap": context.lineCap }),
          ...(dash.length ? { "stroke-dasharray": dash.map(number).join(" ") } : {}) });
      },
      fill() {
        if (path) write("path", { d: path, ...brush() });
      },
      fillRect(x, y, wide, high) {
        context.beginPath();
        path = "M" + at(x, y) + "L" + at(x + wide, y) + "L" + at(x + wide, y + high) + "L" +
          at(x, y + high) + "Z";
        context.fill();
      },
      fillText(said, x, y) { text(said, x, y, brush()); },
      strokeText(said, x, y) {
        text(said, x, y, { fill: "none", ...pen(), "stroke-linejoin": "round" });
      },
      svg(title, paper) {
        const size = number(width) + "\" height=\"" + number(height);
        return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" +
          "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + size + "\" viewBox=\"0 0 " +
          number(width) + " " + number(height) + "\">\n<title>" + page.xmlText(title) +
          "</title>\n<rect width=\"" + size + "\" fill=\"" + page.xmlText(paper) + "\"/>\n" +
          "<g stroke-miterlimit=\"10\">\n" + written.join("\n") + "\n</g>\n</svg>\n";
      }
    });
  };

  /* ---- the files ---- */

  const SHARPNESS = 2, LONGEST = 60;

  /* A scene's name as that of a file: letters and digits of any language, with single dashes. */
  page.fileName = function (name, ending) {
    const safe = (name || "").normalize("NFC").replace(/[^\p{L}\p{N}._-]+/gu, "-")
      .replace(/-{2,}/g, "-").replace(/^[-.]+|[-.]+$/g, "");
    return (Array.from(safe).slice(0, LONGEST).join("") || "strut") + ending;
  };

  page.save = function (blob, name) {
    const url = URL.createObjectURL(blob), link = page.make("a", { href: url, download: name });
    document.body.append(link);
    link.click();
    link.remove();
    setTimeout(() => URL.revokeObjectURL(url), 60000);
  };

  /* A cell as RFC 4180 has it. */
  const cell = (text) =>
    (/[",\r\n]/.test(text) ? "\"" + text.replaceAll("\"", "\"\"") + "\"" : text);
  page.csvText = (rows) => rows.map((row) =>
    row.map((value) => (value === null ? "" : cell(String(value)))).join(",")).join("\n") + "\n";

  function numbersOf(data) {
    const { name, label, description, source, parameters, summary, barriers } = data;
    const equilibria = (data.equilibria || []).map((e) => (
      { name: e.name, label: e.label, verdict: e.verdict, stands: e.stands, energy: e.energy }));
    return { name, label, description, source, strut: data.strut, parameters, summary, equilibria,
      barriers };
  }

  /* shown: {stage: {width, height, title, paint(surface)}, runs: [data, ...], csv: [rows]}, as
     functions that are called when a button is pressed. */
  page.wireDownloads = function (shown) {
    const nameOf = (ending) => page.fileName(shown.runs()[0].name, ending);
    const on = (id, action) => document.getElementById(id).addEventListener("click", () => {
      if (shown.runs().length) action();
    });
    on("save-svg", () => {
      const { width, height, title, paint } = shown.stage();
      const context = page.svgContext(width, height);
      paint({ context, width, height });
      page.save(new Blob([context.svg(title, page.theme().paper)], { type: "image/svg+xml" }),
        nameOf(".svg"));
    });
    on("save-png", () => {
      const { width, height, paint } = shown.stage(), canvas = document.createElement("canvas");
      canvas.width = Math.round(SHARPNESS * width);
      canvas.height = Math.round(SHARPNESS * height);
      const context = canvas.getContext("2d");
      context.scale(SHARPNESS, SHARPNESS);
      context.fillStyle = page.theme().paper;
      context.fillRect(0, 0, width, height);
      paint({ context, width, height });
      canvas.toBlob((blob) => page.save(blob, nameOf(".png")), "image/png");
    });
    on("save-csv", () =>
      page.save(new Blob([page.csvText(shown.csv())], { type: "text/csv" }), nameOf(".csv")));
    on("save-json", () => {
      const [run, beside] = shown.runs().map(numbersOf);
      const text = JSON.stringify(beside ? { ...run, beside } : run, null, 1);
      page.save(new Blob([text + "\n"], { type: "application/json" }), nameOf(".json"));
    });
  };
})(window.strutPage);
