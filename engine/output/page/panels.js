/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parameters, summary, sampling and the scene's text; and the equilibria as cards. */
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

/* A card with its shape for each equilibrium. */
(function (page) {
  const MOST_PASSES = 3;

  function passesOf(data, index) {
    return (data.barriers || []).filter((b) => b.from === index)
      .sort((a, b) => a.height - b.height).slice(0, MOST_PASSES);
  }

  /* Contact forces as the drawing expects them: normal and friction of each contact. */
  page.shapeOf = function (data, equilibrium) {
    const contact = new Float64Array(2 * data.contacts.length);
    (equilibrium.contacts || []).forEach((node, k) => {
      const at = data.contacts.indexOf(node);
      if (at >= 0 && equilibrium.normal) contact[2 * at] = equilibrium.normal[k] || 0;
    });
    return { position: equilibrium.position, force: equilibrium.force || null, contact };
  };

  page.limitsOf = function (shape) {
    let force = 0, contact = 0;
    for (const value of shape.force || []) force = Math.max(force, Math.abs(value));
    for (const value of shape.contact || []) contact = Math.max(contact, Math.abs(value));
    return { force, contact };
  };

  page.createCards = function (data, structure, onPick) {
    const host = document.getElementById("cards"), list = data.equilibria || [], cards = [];
    const more = document.getElementById("more"), standing = list.filter((e) => e.stands).length;
    const hidden = standing > 0 ? list.length - standing : 0;
    list.forEach((equilibrium, index) => {
      const card = document.createElement("button"), canvas = document.createElement("canvas");
      const name = document.createElement("b"), energy = document.createElement("span");
      const verdict = document.createElement("span");
      card.type = "button";
      card.className = "card";
      card.setAttribute("aria-pressed", "false");
      name.dir = verdict.dir = "auto";
      name.textContent = equilibrium.name;
      energy.textContent = page.quantity(equilibrium.energy, "J", 7) + ", " + equilibrium.label;
      verdict.textContent = equilibrium.verdict;
      card.append(canvas, name, energy, verdict);
      for (const pass of passesOf(data, index)) {
        const line = document.createElement("span"), to = document.createElement("bdi");
        to.textContent = list[pass.to].name;
        line.append("\u2192 ", to, ": " + page.quantity(pass.height, "J", 4));
        card.append(line);
      }
      card.hidden = hidden > 0 && !equilibrium.stands;
      card.addEventListener("click", () => onPick(index));
      host.append(card);
      cards.push({ card, canvas, equilibrium });
    });

    more.hidden = hidden === 0;
    more.textContent = "Show " + hidden + " that do not stand";
    more.addEventListener("click", () => {
      for (const { card } of cards) card.hidden = false;
      more.hidden = true;
      draw();
    });

    function draw() {
      const theme = page.theme();
      for (const { card, canvas, equilibrium } of cards) {
        if (card.hidden) continue;
        const shape = page.shapeOf(data, equilibrium), limits = page.limitsOf(shape);
        const camera = page.fit(page.boundsOf(shape.position), canvas.clientWidth,
          canvas.clientHeight, 14, data.size);
        page.drawStructure(canvas, structure, shape, camera, { theme, colour: true, arrows: true,
          limit: limits.force, contactLimit: limits.contact, small: true });
      }
    }
    return { draw, cards,
      mark(index) {
        cards.forEach((c, i) => c.card.setAttribute("aria-pressed", String(i === index)));
      } };
  };
})(window.strutPage);
