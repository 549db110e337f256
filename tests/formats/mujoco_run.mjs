// SPDX-License-Identifier: GPL-3.0-or-later
// As mujoco_run.c, with the WebAssembly module of npm's mujoco-js, whose file STRUT_MUJOCO_JS names.
//
//   node mujoco_run.mjs FILE.xml STEP SECONDS
import fs from "node:fs";
import { pathToFileURL } from "node:url";

const [file, step, seconds] = process.argv.slice(2);
const load = (await import(pathToFileURL(process.env.STRUT_MUJOCO_JS))).default;
const mujoco = await load();
mujoco.FS.writeFile("/model.xml", fs.readFileSync(file, "utf8"));
const model = mujoco.MjModel.loadFromXML("/model.xml");
const data = new mujoco.MjData(model);
model.opt.timestep = Number(step);
if (model.nkey > 0) mujoco.mj_resetDataKeyframe(model, data, 0);
const names = [...Array(model.njnt).keys()].map((i) => mujoco.mj_id2name(model, 3, i));
const lines = [["time", ...names].join(",")];
for (let left = Math.round(Number(seconds) / Number(step)); left > 0; left--) {
  mujoco.mj_step(model, data);
  lines.push([data.time, ...data.qpos].join(","));
}
fs.writeSync(1, lines.join("\n") + "\n");
