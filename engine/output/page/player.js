/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The recorded motion: decoded from its blocks (base64, deflate, second differences), and played. */
"use strict";
window.strutPage = {};
(function (page) {
  /* An element with children and with properties, or attributes where their names have a dash. */
  page.make = function (tag, properties = {}, ...children) {
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(properties))
      if (name.includes("-") || name === "role") element.setAttribute(name, value);
      else element[name] = value;
    element.append(...children);
    return element;
  };

  /* The bytes of a text in base64, deflated (raw). */
  page.inflate = async function (base64) {
    const text = atob(base64);
    const bytes = new Uint8Array(text.length);
    for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  };

  /* One block as a Float64Array, (frames, columns); of plain numbers as they are. Products and sums
     keep integers exact up to 2^53, which shifts would not. */
  page.decodeBlock = async function (block, frames) {
    if (!block) return null;
    if (block.values) return Float64Array.from(block.values);
    const bytes = await page.inflate(block.bytes);
    const columns = block.columns, values = new Float64Array(frames * columns);
    let at = 0;
    for (let c = 0; c < columns; c++) {
      let value = 0, step = 0;
      for (let f = 0; f < frames; f++) {
        let zigzag = 0, scale = 1, byte;
        do {
          byte = bytes[at++];
          zigzag += (byte & 127) * scale;
          scale *= 128;
        } while (byte & 128);
        const number = zigzag % 2 ? -(zigzag + 1) / 2 : zigzag / 2;
        if (f === 0) value = number;
        else {
          step = f === 1 ? number : step + number;
          value += step;
        }
        values[f * columns + c] = value * block.quantum;
      }
    }
    if (at !== bytes.length) throw new Error("a block of the page is damaged");
    return values;
  };

  page.decodeMotion = async function (motion) {
    if (!motion) return null;
    const decoded = { frames: motion.frames };
    for (const [name, block] of Object.entries(motion))
      if (block && (block.bytes || block.values)) decoded[name] = await page.decodeBlock(block, motion.frames);
    return decoded;
  };

  /* The last frame that is not after a time; the first if there is none. */
  page.frameAt = function (time, t) {
    let low = 0, high = time.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (time[middle] <= t) low = middle;
      else high = middle - 1;
    }
    return low;
  };
  page.nearestFrame = function (time, t) {
    const frame = page.frameAt(time, t);
    const next = frame + 1 < time.length && time[frame + 1] - t < t - time[frame];
    return frame + (next ? 1 : 0);
  };
})(window.strutPage);

/* Playing, pausing, scrubbing, speed. Frames are shown as recorded, never interpolated. */
(function (page) {
  const SPEEDS = [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10];
  const WATCHED = 12; /* approximate playing time [s], if not faster than real time */

  page.createPlayer = function (onFrame) {
    const element = (id) => document.getElementById(id);
    const button = element("play"), scrub = element("scrub"), speed = element("speed");
    let time = null, now = 0, before = null, speedChosen = false;
    const player = { frame: 0, playing: false, last: 0 };

    function show(frame) {
      player.frame = frame;
      scrub.value = String(frame);
      onFrame(frame);
    }

    player.seek = function (frame) {
      if (!time) return;
      frame = Math.min(Math.max(Math.round(frame), 0), player.last);
      now = time[frame];
      show(frame);
    };
    player.seekTime = (t) => player.seek(page.nearestFrame(time, t));

    function tick(stamp) {
      if (!player.playing) return;
      const begin = time[0], end = time[player.last];
      if (before !== null) now += (stamp - before) / 1000 * Number(speed.value);
      before = stamp;
      if (now > end) now = begin + (now - begin) % (end - begin);
      const frame = page.frameAt(time, now);
      if (frame !== player.frame) show(frame);
      requestAnimationFrame(tick);
    }

    player.play = function () {
      if (player.playing || player.last === 0) return;
      if (player.frame === player.last) player.seek(0);
      player.playing = true;
      before = null;
      button.classList.add("playing");
      button.setAttribute("aria-label", "Pause");
      requestAnimationFrame(tick);
    };
    player.pause = function () {
      player.playing = false;
      button.classList.remove("playing");
      button.setAttribute("aria-label", "Play");
    };
    player.toggle = () => (player.playing ? player.pause() : player.play());

    function suggestSpeed(span) {
      const wanted = Math.min(1, span / WATCHED);
      speed.value = String(SPEEDS.reduce((a, b) =>
        Math.abs(Math.log(b / wanted)) < Math.abs(Math.log(a / wanted)) ? b : a));
    }

    /* Plays another motion, or none; at the same time where it has that. */
    player.load = function (times) {
      const kept = time && times && now >= times[0] && now <= times[times.length - 1];
      time = times;
      player.frame = 0;
      player.last = time && time[time.length - 1] > time[0] ? time.length - 1 : 0;
      if (player.last === 0) player.pause();
      if (!time) return;
      if (!speedChosen) suggestSpeed(time[player.last] - time[0]);
      scrub.max = String(player.last);
      if (!kept) now = time[0];
      show(page.nearestFrame(time, now));
    };

    function onKey(event) {
      const tag = event.target.tagName, input = tag === "INPUT" && event.target !== scrub;
      const box = input && event.target.type === "checkbox";
      if (event.ctrlKey || event.metaKey || event.altKey || !time) return;
      if (event.defaultPrevented || event.target.isContentEditable) return;
      if (tag === "SELECT" || tag === "PRE" || tag === "TEXTAREA" || (input && !box)) return;
      const far = event.shiftKey ? 10 : 1;
      const own = tag === "BUTTON" || tag === "SUMMARY" || box;
      if (event.key === " " && !own) player.toggle();
      else if (event.key === "ArrowRight") player.seek(player.frame + far);
      else if (event.key === "ArrowLeft") player.seek(player.frame - far);
      else if (event.key === "Home") player.seek(0);
      else if (event.key === "End") player.seek(player.last);
      else return;
      event.preventDefault();
    }

    speed.append(...SPEEDS.map((value) => page.make("option", { value,
      textContent: value >= 1 ? value + "\u00d7" : "1/" + Math.round(1 / value) })));
    speed.addEventListener("change", () => { speedChosen = true; });
    scrub.addEventListener("input", () => player.seek(Number(scrub.value)));
    button.addEventListener("click", player.toggle);
    document.addEventListener("keydown", onKey);
    return player;
  };
})(window.strutPage);
