/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files that are dropped, chosen, saved; links and commands to copy; elements of the page. */

/** Makes an element of a tag, properties and children. */
export const { make } = window.strutPage;

const MOST_BYTES = 2e7;
const isScene = (name) => /\.(ya?ml|json)$/i.test(name);

/** Of files {name: text} the scene: the first YAML or JSON file that no other names; null where there is none. */
export function sceneAmong(files) {
  const names = Object.keys(files).filter(isScene);
  const free = names.filter((name) => !names.some((other) => other !== name && files[other].includes(name)));
  return free[0] || names[0] || null;
}

async function readAll(list) {
  const files = {};
  for (const file of list) {
    if (file.size > MOST_BYTES) throw new Error(file.name + " is larger than 20 MB");
    files[file.name] = await file.text();
  }
  return files;
}

/** Files from the button or dropped anywhere: onFiles({name: text}) or onTrouble(error). */
export function wireOpening(onFiles, onTrouble) {
  const chosen = document.getElementById("chosen-files"), body = document.body;
  const take = (list) => readAll([...list]).then(onFiles).catch(onTrouble);
  document.getElementById("open").addEventListener("click", () => chosen.click());
  chosen.addEventListener("change", () => {
    take(chosen.files);
    chosen.value = "";
  });
  const hasFiles = (event) => event.dataTransfer && [...event.dataTransfer.types].includes("Files");
  window.addEventListener("dragover", (event) => {
    if (!hasFiles(event)) return;
    event.preventDefault();
    body.classList.add("dropping");
  }, true);
  window.addEventListener("dragleave", (event) => {
    if (!event.relatedTarget) body.classList.remove("dropping");
  });
  window.addEventListener("drop", (event) => {
    if (!hasFiles(event)) return;
    event.preventDefault();
    event.stopPropagation();
    body.classList.remove("dropping");
    take(event.dataTransfer.files);
  }, true);
}

const shell = (text) => (/^[\w@%+=:,./-]+$/.test(text) ? text : "'" + text.replaceAll("'", "'\\''") + "'");

/** The program's command for a call {call, options} on a scene with settings. */
export function commandFor(name, settings, { call, options }) {
  const words = ["strut", call, shell(name)];
  for (const [key, value] of Object.entries(settings)) words.push("--set", shell(key + "=" + value));
  for (const [key, value] of Object.entries(options || {})) words.push("--" + key, shell(value.replace(/ %$/, "%")));
  return words.join(" ");
}

/** Copies a text, and says so on the button for a moment. */
export async function copyText(text, button) {
  const said = button.textContent;
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    copyBySelection(text);
  }
  button.textContent = "Copied";
  setTimeout(() => { button.textContent = said; }, 1500);
}

/* Where pages from files may not use the clipboard. */
function copyBySelection(text) {
  const area = make("textarea", { value: text });
  area.style.position = "fixed";
  area.style.opacity = "0";
  document.body.append(area);
  area.select();
  document.execCommand("copy");
  area.remove();
}
