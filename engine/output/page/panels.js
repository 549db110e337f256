/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parameters, summary, sampling and the scene's text; and the equilibria as cards. */
"use strict";
(function (page) {
  /* Rows of both runs by their labels, [label, value, value]; of equal labels the n-th with the n-th. */
  function joinRows(rows, others) {
    const left = (others || []).slice();
    const joined = (rows || []).map((row) => {
      const at = left.findIndex((other) => other.label === row.label);
      return [row.label, row.value, at < 0 ? null : left.splice(at, 1)[0].value];
    });
    return [...joined, ...left.map((row) => [row.label, null, row.value])];
  }

  function makeRow(kind, texts) {
    return page.make("tr", {}, ...texts.map((text) => page.make(kind,
      { dir: "auto", textContent: text === null ? "\u2013" : page.micro(text) })));
  }

  /* A table of rows {label, value}; with a second run a second column, and a mark where they differ. */
  function fillTable(id, data, beside) {
    const body = document.querySelector("#" + id + " tbody");
    const rows = joinRows(data[id], beside && beside[id]).map(([label, one, two]) => {
      if (!beside) return makeRow("td", [label, one]);
      const row = makeRow("td", [label, one, one === two ? "" : "\u2260", two]);
      row.classList.toggle("differs", one !== two);
      return row;
    });
    if (beside)
      rows.unshift(makeRow("th", ["", data.label || "first", "", beside.label || "second"]));
    body.replaceChildren(...rows);
    document.getElementById(id + "-section").hidden = !body.querySelector("td");
  }

  function ordinal(n) {
    if (n % 100 > 10 && n % 100 < 14) return "th";
    return ["th", "st", "nd", "rd"][n % 10] || "th";
  }

  function samplingText(data) {
    const motion = data.motion;
    const made = "Written by strut " + data.strut + "; nothing on it comes from a network.";
    if (!motion) return "A model at rest: no motion is on this page. " + made;
    if (motion.made) return motion.made.note + " " + made;
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

  function besideText(ghost) {
    const { data } = ghost.run, notes = [];
    if (ghost.delay) notes.push("the recordings hardly overlap in time and begin together here");
    if (ghost.shift)
      notes.push("moved by " + page.quantity(ghost.shift, "m", 4) + " to the same start");
    return "Pale, with dashed curves: " + (data.label || data.name || "a second run") +
      (notes.length ? " (" + notes.join("; ") + ")" : "") + ".";
  }

  /* Texts and tables of a run, and of the ghost beside it or null. */
  page.fillPanels = function (run, ghost) {
    const { data } = run, beside = ghost && ghost.run.data;
    const element = (id) => document.getElementById(id);
    const label = data.label ? data.label + ": " : "";
    document.title = data.name || "strut";
    element("name").textContent = data.name || "Unnamed";
    element("source").textContent =
      label + [data.description, data.source].filter(Boolean).join(" \u2014 ");
    element("beside").hidden = !ghost;
    element("beside").textContent = ghost ? besideText(ghost) : "";
    fillTable("parameters", data, beside);
    fillTable("summary", data, beside);
    element("sampling").textContent = samplingText(data);
    element("yaml").textContent = data.yaml || "";
    element("scene").hidden = !data.yaml;
    element("copy").textContent = "Copy";
    const more = data.equilibria_left_out
      ? data.equilibria_left_out + " further equilibria are left out for size. " : "";
    element("remark").textContent = more + page.micro(data.equilibria_remark || "");
    element("cards-section").hidden = !(data.equilibria || []).length && !data.equilibria_remark;
  };

  page.wireCopy = function () {
    const copy = document.getElementById("copy");
    copy.hidden = !(navigator.clipboard && navigator.clipboard.writeText);
    copy.addEventListener("click", async () => {
      try {
        await navigator.clipboard.writeText(document.getElementById("yaml").textContent);
        copy.textContent = "Copied";
      } catch {
        copy.textContent = "Select the text to copy it";
      }
    });
  };
})(window.strutPage);

/* A card with its shape for each equilibrium. */
(function (page) {
  const MOST_PASSES = 3;

  function passesOf(data, index) {
    return (data.barriers || []).filter((b) => b.from === index)
      .sort((a, b) => a.height - b.height).slice(0, MOST_PASSES);
  }

  function createCard(data, equilibrium, index) {
    const { name, label, verdict } = equilibrium, canvas = page.make("canvas");
    const energy = page.quantity(equilibrium.energy, "J", 7) + ", " + label;
    const passes = passesOf(data, index).map((pass) => page.make("span", {}, "\u2192 ",
      page.make("bdi", { textContent: data.equilibria[pass.to].name }),
      ": " + page.quantity(pass.height, "J", 4)));
    const card = page.make("button", { type: "button", className: "card", "aria-pressed": "false" },
      canvas, page.make("b", { dir: "auto", textContent: name }),
      page.make("span", { textContent: energy }),
      page.make("span", { dir: "auto", textContent: page.micro(verdict || "") }), ...passes);
    return { card, canvas, equilibrium };
  }

  page.createCards = function (onPick) {
    const host = document.getElementById("cards"), more = document.getElementById("more");
    let run = null, cards = [], all = false; /* those that do not stand, too */

    function draw() {
      const theme = page.theme();
      for (const { card, canvas, equilibrium } of cards) {
        if (card.hidden) continue;
        const shape = page.shapeOf(run.data, equilibrium), limits = page.limitsOf(shape);
        const camera = page.fit(page.boundsOf(shape.position), canvas.clientWidth,
          canvas.clientHeight, 14, run.data.size);
        page.drawStructure(page.prepareCanvas(canvas), run.structure, shape, camera, { theme,
          colour: true, arrows: true, limit: limits.force, contactLimit: limits.contact,
          small: true });
      }
    }

    function hideSome() {
      const standing = cards.filter((c) => c.equilibrium.stands).length;
      const hidden = standing > 0 && !all ? cards.length - standing : 0;
      for (const { card, equilibrium } of cards) card.hidden = hidden > 0 && !equilibrium.stands;
      more.hidden = hidden === 0;
      more.textContent = "Show " + hidden + " that do not stand";
    }

    more.addEventListener("click", () => {
      all = true;
      hideSome();
      draw();
    });

    return { draw,
      load(shown) {
        run = shown;
        cards = (run.data.equilibria || []).map((e, index) => createCard(run.data, e, index));
        cards.forEach(({ card }, index) => card.addEventListener("click", () => onPick(index)));
        host.replaceChildren(...cards.map((c) => c.card));
        hideSome();
        draw();
      },
      mark(index) {
        cards.forEach((c, i) => c.card.setAttribute("aria-pressed", String(i === index)));
      } };
  };
})(window.strutPage);
