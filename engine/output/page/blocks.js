/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The recorded numbers: from base64, deflate and second differences back to what was written. */
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
    for (const name of ["time", "position", "length", "force", "contact", "energy"])
      decoded[name] = await page.decodeBlock(motion[name], motion.frames);
    return decoded;
  };
})(window.strutPage);
