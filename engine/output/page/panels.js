/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Words around the drawings: summary, sampling, the scene's text. */
"use strict";
(function (page) {
  function fillTable(id, rows) {
    const body = document.querySelector("#" + id + " tbody");
    for (const row of rows || []) {
      const line = document.createElement("tr");
      for (const text of [row.label, row.value]) {
        const cell = document.createElement("td");
        cell.dir = "auto";
        cell.textContent = text;
        line.append(cell);
      }
      body.append(line);
    }
    document.getElementById(id + "-section").hidden = !(rows || []).length;
  }

  function ordinal(n) {
    if (n % 100 > 10 && n % 100 < 14) return "th";
    return ["th", "st", "nd", "rd"][n % 10] || "th";
  }

  function samplingText(data) {
    const motion = data.motion;
    const made = "Written by strut " + data.strut + "; nothing on it comes from a network.";
    if (!motion) return "A model at rest: no motion is on this page. " + made;
    const kept = motion.frames === motion.recorded ? "All " + motion.frames + " recorded frames"
      : motion.frames + " of " + motion.recorded + " recorded frames (every " + motion.every +
        ordinal(motion.every) + ")";
    const rounded = [["positions", "position", "m"], ["forces", "force", "N"],
      ["contact forces", "contact", "N"]]
      .filter(([, key]) => motion[key])
      .map(([name, key, unit]) => name + " to " + page.quantity(motion[key].quantum, unit, 3));
    const ended = motion.status === "completed" ? "" : " The run did not complete: it " +
      (motion.status === "diverged" ? "diverged." : "was interrupted.");
    return kept + " are on this page, rounded: " + rounded.join(", ") + "." + ended + " " + made;
  }

  page.fillPanels = function (data) {
    document.getElementById("name").textContent = data.name || "Unnamed";
    document.getElementById("source").textContent =
      [data.description, data.source].filter(Boolean).join(" \u2014 ");
    fillTable("parameters", data.parameters);
    fillTable("summary", data.summary);
    document.getElementById("sampling").textContent = samplingText(data);
    document.getElementById("yaml").textContent = data.yaml || "";
    document.getElementById("scene").hidden = !data.yaml;
    const copy = document.getElementById("copy");
    copy.hidden = !(navigator.clipboard && navigator.clipboard.writeText);
    copy.addEventListener("click", async () => {
      try {
        await navigator.clipboard.writeText(data.yaml);
        copy.textContent = "Copied";
      } catch {
        copy.textContent = "Select the text to copy it";
      }
    });
    const more = data.equilibria_left_out
      ? data.equilibria_left_out + " further equilibria are left out for size. " : "";
    document.getElementById("remark").textContent = more + (data.equilibria_remark || "");
    document.getElementById("cards-section").hidden =
      !(data.equilibria || []).length && !data.equilibria_remark;
  };
})(window.strutPage);
