/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files of what is shown: the stage as SVG and PNG, the curves as CSV, the numbers as JSON. */
"use strict";
(function (page) {
  const SHARPNESS = 2, LONGEST = 60;

  /* A scene's name as that of a file: letters and digits of any language, with single dashes. */
  page.fileName = function (name, ending) {
    const safe = (name || "").normalize("NFC").replace(/[^\p{L}\p{N}._-]+/gu, "-")
      .replace(/-{2,}/g, "-").replace(/^[-.]+|[-.]+$/g, "");
    return (Array.from(safe).slice(0, LONGEST).join("") || "strut") + ending;
  };

  function save(blob, name) {
    const link = document.createElement("a"), url = URL.createObjectURL(blob);
    link.href = url;
    link.download = name;
    document.body.append(link);
    link.click();
    link.remove();
    setTimeout(() => URL.revokeObjectURL(url), 60000);
  }

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
      save(new Blob([context.svg(title, page.theme().paper)], { type: "image/svg+xml" }),
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
      canvas.toBlob((blob) => save(blob, nameOf(".png")), "image/png");
    });
    on("save-csv", () =>
      save(new Blob([page.csvText(shown.csv())], { type: "text/csv" }), nameOf(".csv")));
    on("save-json", () => {
      const [run, beside] = shown.runs().map(numbersOf);
      const text = JSON.stringify(beside ? { ...run, beside } : run, null, 1);
      save(new Blob([text + "\n"], { type: "application/json" }), nameOf(".json"));
    });
  };
})(window.strutPage);
