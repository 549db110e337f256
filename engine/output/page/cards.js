/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The equilibria, each as a card with its shape. */
"use strict";
(function (page) {
  const MOST_PASSES = 3;

  function passesOf(data, index) {
    return (data.barriers || []).filter((b) => b.from === index)
      .sort((a, b) => a.height - b.height).slice(0, MOST_PASSES);
  }

  /* The ground's push as the drawing takes it: normal, friction for each contact. */
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
