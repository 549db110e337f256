/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A scene in a link: #s=TEXT, where TEXT is {text, name, settings, files} as JSON in UTF-8, deflated (raw, RFC 1951),
 * in base64url without padding. Further pairs may follow, such as &embed=1.
 */

const MOST_BYTES = 4e6; /* of a scene that a link may unpack to */

const through = (bytes, stream) => new Blob([bytes]).stream().pipeThrough(stream);

function toBase64(bytes) {
  return btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join("")).replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "");
}

function fromBase64(text) {
  const whole = atob(text.replaceAll("-", "+").replaceAll("_", "/"));
  return Uint8Array.from(whole, (letter) => letter.charCodeAt(0));
}

/** The fragment of a link to a state {text, name, settings, files}: "#s=...". */
export async function encodeLink({ text, name, settings, files }) {
  const bytes = new TextEncoder().encode(JSON.stringify({ text, name, settings, files }));
  const packed = through(bytes, new CompressionStream("deflate-raw"));
  return "#s=" + toBase64(new Uint8Array(await new Response(packed).arrayBuffer()));
}

/* The text that bytes unpack to; an error where that is longer than a link may be. */
async function unpack(bytes) {
  const reader = through(bytes, new DecompressionStream("deflate-raw")).getReader(), decoder = new TextDecoder();
  let text = "", size = 0;
  for (;;) {
    const { done, value } = await reader.read();
    if (done) return text + decoder.decode();
    size += value.length;
    if (size > MOST_BYTES) {
      reader.cancel();
      throw new Error("the scene in the link is too large");
    }
    text += decoder.decode(value, { stream: true });
  }
}

const texts = (given) => Object.fromEntries(Object.entries(given || {})
  .filter(([, value]) => typeof value === "string" || typeof value === "number")
  .map(([name, value]) => [name, String(value)]));

/** The state of a fragment {text, name, settings, files}, or null where it has none; an error where it is damaged. */
export async function decodeLink(fragment) {
  const packed = new URLSearchParams(fragment.replace(/^#/, "")).get("s");
  if (!packed) return null;
  let state;
  try {
    state = JSON.parse(await unpack(fromBase64(packed)));
  } catch (error) {
    throw new Error("the link is damaged: " + error.message, { cause: error });
  }
  if (typeof state.text !== "string") throw new Error("the link is damaged: it has no scene");
  return { text: state.text, name: String(state.name || "scene.yaml"),
    settings: texts(state.settings), files: texts(state.files) };
}
