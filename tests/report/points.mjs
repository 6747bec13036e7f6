// node points.mjs FOLDER > points.json: values of a result folder that the lines of its page must show,
// for page.mjs --points.

import { readFileSync } from "node:fs";
import { join } from "node:path";

const folder = process.argv[2];
const summary = JSON.parse(readFileSync(join(folder, "summary.json"), "utf8"));
const table = (name) => {
  const [head, ...rows] = readFileSync(join(folder, name), "utf8").trim().split("\n").map((line) => line.split(","));
  return Object.fromEntries(head.map((column, k) => [column, rows.map((row) => +row[k])]));
};

const [torque, rigid, hub, tip] = ["torque.csv", "rigid_torque.csv", "hub_angle.csv", "tip.csv"].map(table);
const lines = [
  ["fig-torque", "flexible link", torque.torque_n_m],
  ["fig-torque", "rigid link", rigid.rigid_torque_n_m],
  ["fig-hub-angle", "flexible link", hub.hub_angle_rad],
  ["fig-hub-angle", "rigid link", hub.rigid_hub_angle_rad],
  ["fig-tip-acceleration", "tip", tip.tip_acceleration_m_s2],
  ["fig-tip-displacement", "tip", tip.tip_displacement_m],
  ["fig-tip-under-rigid-torque", "wanted", tip.tip_displacement_m],
  ["fig-waves", "tip displacement", tip.tip_displacement_m],
];
const { moves_from_s: from, moves_until_s: until } = summary.motion;
const shares = [0.03, 0.21, 0.37, 0.5, 0.68, 0.97];
const points = lines.flatMap(([figure, line, values]) => {
  const peak = Math.max(...values.map(Math.abs));
  return shares.map((share) => {
    const at = torque.time_s.findIndex((time) => time >= from + share * (until - from));
    return { figure, line, x: torque.time_s[at], y: values[at], within: 0.004 * peak };
  });
});
console.log(JSON.stringify(points));
