/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The recorded motion: decoded from its blocks (base64, deflate, second differences), and played. */
"use strict";
window.strutPage = {};
(function (page) {
  async function inflate(base64) {
    const text = atob(base64);
    const bytes = new Uint8Array(text.length);
    for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  }

  /* One block as a Float64Array, (frames, columns). Products and sums keep integers exact up to 2^53,
     which shifts would not. */
  page.decodeBlock = async function (block, frames) {
    if (!block) return null;
    const bytes = await inflate(block.bytes);
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
      if (block && block.bytes) decoded[name] = await page.decodeBlock(block, motion.frames);
    return decoded;
  };
})(window.strutPage);

/* Playing, pausing, scrubbing, speed. Frames are shown as recorded, never interpolated. */
(function (page) {
  const SPEEDS = [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10];
  const WATCHED = 12; /* approximate playing time [s], if not faster than real time */

  page.createPlayer = function (time, onFrame) {
    const last = time.length - 1, begin = time[0], span = time[last] - begin;
    const element = (id) => document.getElementById(id);
    const button = element("play"), scrub = element("scrub"), speed = element("speed");
    let now = begin, before = null;
    const player = { frame: 0, playing: false, last };

    function frameAt(t) {
      let low = 0, high = last;
      while (low < high) {
        const middle = (low + high + 1) >> 1;
        if (time[middle] <= t) low = middle;
        else high = middle - 1;
      }
      return low;
    }

    function show(frame) {
      player.frame = frame;
      scrub.value = String(frame);
      onFrame(frame);
    }

    player.seek = function (frame) {
      frame = Math.min(Math.max(Math.round(frame), 0), last);
      now = time[frame];
      show(frame);
    };
    player.seekTime = (t) => { /* the nearest frame */
      const frame = frameAt(t);
      const next = frame < last && time[frame + 1] - t < t - time[frame];
      player.seek(frame + (next ? 1 : 0));
    };

    function tick(stamp) {
      if (!player.playing) return;
      if (before !== null) now += (stamp - before) / 1000 * Number(speed.value);
      before = stamp;
      if (now > time[last]) now = span > 0 ? begin + (now - begin) % span : begin;
      const frame = frameAt(now);
      if (frame !== player.frame) show(frame);
      requestAnimationFrame(tick);
    }

    player.play = function () {
      if (player.playing || last === 0) return;
      if (player.frame === last) player.seek(0);
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

    for (const value of SPEEDS) {
      const option = document.createElement("option");
      option.value = String(value);
      option.textContent = value >= 1 ? value + "\u00d7" : "1/" + Math.round(1 / value);
      speed.append(option);
    }
    const wanted = Math.min(1, span / WATCHED);
    speed.value = String(SPEEDS.reduce((a, b) =>
      Math.abs(Math.log(b / wanted)) < Math.abs(Math.log(a / wanted)) ? b : a));
    scrub.max = String(last);
    scrub.addEventListener("input", () => player.seek(Number(scrub.value)));
    button.addEventListener("click", player.toggle);
    document.addEventListener("keydown", (event) => {
      const tag = event.target.tagName;
      if (event.ctrlKey || event.metaKey || event.altKey || tag === "SELECT" || tag === "PRE") return;
      const far = event.shiftKey ? 10 : 1;
      const own = tag === "BUTTON" || tag === "SUMMARY" || (tag === "INPUT" && event.target !== scrub);
      if (event.key === " " && !own) player.toggle();
      else if (event.key === "ArrowRight") player.seek(player.frame + far);
      else if (event.key === "ArrowLeft") player.seek(player.frame - far);
      else if (event.key === "Home") player.seek(0);
      else if (event.key === "End") player.seek(last);
      else return;
      event.preventDefault();
    });
    return player;
  };
})(window.strutPage);
