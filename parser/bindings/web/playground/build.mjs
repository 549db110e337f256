/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Puts the playground together, one HTML file: node build.mjs OUT.html PACKAGE MODULES TOP SCRIPT... STYLE...
 * PACKAGE: folder of the JavaScript package with its module; MODULES: node_modules of this folder's package.json;
 * TOP: the source tree; scripts and style sheets of the page in their order.
 */
import { createHash } from "node:crypto";
import { existsSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { basename, dirname, join, resolve } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { deflateRawSync } from "node:zlib";

const [out, packageFolder, modules, top, ...pageFiles] = process.argv.slice(2).map((path) => resolve(path));
const here = dirname(fileURLToPath(import.meta.url)), read = (path) => readFileSync(path, "utf8");
const esbuild = createRequire(join(modules, "x.js"))("esbuild");

const FIRST = "crawler.yaml"; /* the model that the page begins with */

/* ---- bundles ---- */

const packageOfBuild = {
  name: "package-of-build", /* the sources name ../package; the module is only in the build's copy */
  setup(build) {
    build.onResolve({ filter: /\/package\/index\.js$/ }, () => ({ path: join(packageFolder, "index.js") }));
  }
};

async function bundle(entry) {
  const made = await esbuild.build({
    entryPoints: [entry], bundle: true, format: "iife", minify: true, write: false, metafile: true,
    target: "es2022", charset: "utf8", legalComments: "none", nodePaths: [modules], plugins: [packageOfBuild],
    external: ["node:*"], define: { "import.meta.url": "\"about:blank\"" }, logLevel: "warning"
  });
  return { text: made.outputFiles[0].text, inputs: Object.keys(made.metafile.inputs) };
}

/* The licences of the npm packages in a bundle. */
function licencesOf(inputs) {
  const names = new Set(inputs.map((path) => /node_modules\/((?:@[^/]+\/)?[^/]+)/.exec(path)?.[1])
    .filter(Boolean));
  return [...names].sort().map((name) => {
    const file = ["LICENSE", "LICENSE.md", "LICENCE"].map((f) => join(modules, name, f)).find(existsSync);
    const about = JSON.parse(read(join(modules, name, "package.json")));
    return name + " " + about.version + " (" + about.license + ")\n\n" + (file ? read(file) : "");
  }).join("\n----\n\n");
}

/* ---- models ---- */

/* Files of the same folder that a text names. */
function namedFiles(folder, text) {
  return Object.fromEntries(readdirSync(folder)
    .filter((name) => text.includes(name)).map((name) => [name, read(join(folder, name))]));
}

function openAlone(open, text, name, folder) {
  return open(text, { name }).catch(async () => open(text, { name, files: namedFiles(folder, text) }));
}

async function readModel(open, group, name) {
  const folder = join(top, "models", group), text = read(join(folder, name));
  let scene;
  try {
    scene = await openAlone(open, text, name, folder);
  } catch {
    return null; /* a study */
  }
  const { yaml, ...data } = JSON.parse(scene.pageData()), files = namedFiles(folder, text);
  delete files[name];
  scene.close();
  return { group, name, text, files, data };
}

async function readModels() {
  const { open } = await import(pathToFileURL(join(packageFolder, "index.js")));
  const found = [];
  for (const group of ["crawler", "basics", "gallery", "topologies", "parts"])
    for (const name of readdirSync(join(top, "models", group)).filter((f) => f.endsWith(".yaml")).sort())
      found.push(await readModel(open, group, name));
  return found.filter(Boolean);
}

/* ---- the page ---- */

const packed = (bytes) => deflateRawSync(bytes, { level: 9 }).toString("base64");
const hashOf = (text) => "'sha256-" + createHash("sha256").update(text).digest("base64") + "'";
const fill = (text, from, to) => {
  if (!text.includes(from)) throw new Error("page.html lacks " + from);
  return text.replace(from, () => to);
};

function policyOf(scripts) {
  return ["default-src 'none'", "script-src " + scripts.map(hashOf).join(" ") + " 'wasm-unsafe-eval'",
    "worker-src blob:", "style-src 'unsafe-inline'", "img-src data: blob:", "base-uri 'none'", "form-action 'none'"]
    .join("; ");
}

async function build() {
  const client = await bundle(join(here, "main.js"));
  const worker = await bundle(join(here, "../client/worker.js"));
  const page = join(top, "engine/output/page");
  const licences = licencesOf(client.inputs) + "\n----\n\n" + read(join(page, "dygraphs_notice.txt"));
  const models = await readModels(), first = models.find((model) => model.name === FIRST);
  const assets = packed(JSON.stringify({ worker: worker.text, models, licences }));
  const wasm = packed(readFileSync(join(packageFolder, "strut.wasm")));
  const scripts = [...pageFiles.filter((f) => f.endsWith(".js")).map(read), client.text].map((t) => "\n" + t);
  const styles = [...pageFiles.filter((f) => f.endsWith(".css")), join(here, "playground.css")].map(read);
  const block = (id, text) => `<script type="text/plain" id="${id}">${text}</script>\n`;
  let html = read(join(page, "page.html"));
  html = html.replace(/(http-equiv="Content-Security-Policy" content=")[^"]*/, (_, head) => head + policyOf(scripts));
  html = fill(html, "<!--strut:title-->", "strut playground");
  html = fill(html, "<!--strut:style-->", styles.map((t) => `<style>\n${t}</style>`).join("\n"));
  html = fill(html, "<body>", "<body class=\"playground\">\n" + read(join(here, "parts.html")));
  html = fill(html, "<!--strut:data-->", block("strut-data", JSON.stringify(first.data)
    .replace(/[<>&]/g, (c) => "\\u00" + c.charCodeAt(0).toString(16))));
  /* The first picture, which has no charts, is drawn before the rest is read. */
  const [charts, ...others] = scripts.map((t) => `<script>${t}</script>\n`), own = others.pop();
  html = fill(html, "<!--strut:scripts-->", others.join("") + charts + block("strut-assets", assets) +
    block("strut-wasm", wasm) + own);
  writeFileSync(out, html);
  console.log(basename(out) + ": " + Math.round(html.length / 1000) + " kB");
}

await build();
