// tools/studio/setup.js - drawings of board, lamps and eyes from above and from the side; draggable in Place.
import {el, t} from "./page.js";

const kWidth = 640, kHeight = 460, kMargin = 46;

/** The setup of bench.json and board.json as plain points in the board's frame, mm. */
export function setupOf(bench, board) {
  const [w, h] = board.size_mm;
  const setup = {w, h, carve: board.carve_mm, tags: board.tags?.list || [], eyes: {}, lamps: {}, posed: []};
  for (const view of bench.views || []) {
    if (Array.isArray(view.eye_mm))
      setup.eyes[view.view] = [...view.eye_mm];
    else if (Array.isArray(view.T_camera_board)) {
      setup.eyes[view.view] = eyeOf(view.T_camera_board);
      setup.posed.push(view.view);
    }
  }
  for (const light of bench.lights || [])
    if (Array.isArray(light.position_mm)) setup.lamps[light.id] = [...light.position_mm];
  return setup;
}

// The camera's center, -R' t of its pose.
const eyeOf = (pose) => [0, 1, 2].map((axis) => -[0, 1, 2].reduce((sum, row) => sum + pose[row][axis] * pose[row][3], 0));

const minus = (a, b) => a.map((v, i) => v - b[i]);
const length = (a) => Math.hypot(...a);
const unit = (a) => a.map((v) => v / (length(a) || 1));
const angle = (a, b) =>
    (Math.acos(Math.min(1, Math.max(-1, unit(a).reduce((s, v, i) => s + v * unit(b)[i], 0)))) * 180) / Math.PI;

/** Rough figures at the board's middle: distance, angle off the mirror direction, angle to the nearest other view. */
export function roughFigures(setup, name) {
  const middle = [setup.w / 2, setup.h / 2, 0], eye = minus(setup.eyes[name], middle),
        figures = {away: length(eye), mirror: 180, neighbour: 180};
  for (const lamp of Object.values(setup.lamps)) {
    const toLamp = minus(lamp, middle);
    figures.mirror = Math.min(figures.mirror, angle(eye, [-toLamp[0], -toLamp[1], toLamp[2]]));
  }
  for (const [other, at] of Object.entries(setup.eyes))
    if (other !== name) figures.neighbour = Math.min(figures.neighbour, angle(eye, minus(at, middle)));
  return figures;
}

/** One drawing. `side`: the axes are y and z, else x and y. `moved(kind, name, at, done)` makes it draggable. */
export function drawSetup(setup, side, {moved, took, wanted} = {}) {
  const axes = side ? [1, 2] : [0, 1];
  const points =
      [...Object.values(setup.eyes), ...Object.values(setup.lamps), [0, 0, 0], [setup.w, setup.h, 0], ...(took ? [took] : [])];
  const low = axes.map((a) => Math.min(...points.map((p) => p[a]))), high = axes.map((a) => Math.max(...points.map((p) => p[a])));
  const reach = Math.max(high[0] - low[0], ((high[1] - low[1]) * kWidth) / kHeight, 1) * 1.12;
  const scale = (kWidth - 2 * kMargin) / reach, middle = axes.map((_, i) => (low[i] + high[i]) / 2);
  const x = (p) => kWidth / 2 + (p[axes[0]] - middle[0]) * scale, y = (p) => kHeight / 2 - (p[axes[1]] - middle[1]) * scale;
  const svg = el("svg", {
    class: "setup",
    viewBox: `0 0 ${kWidth} ${kHeight}`,
    role: moved ? "group" : "img",
    "aria-label": t(side ? "fromSide" : "fromAbove")
  });
  svg.append(el("text", {x: 18, y: 28, class: "soft-text"}, t(side ? "fromSide" : "fromAbove")));
  const center = [setup.w / 2, setup.h / 2, 0], corner = (px, py) => `${x([px, py, 0])},${y([px, py, 0])}`;
  if (side) {
    svg.append(el("line", {x1: 0, x2: kWidth, y1: y(center), y2: y(center), class: "grid"}));
    svg.append(
        el("line", {x1: x([0, 0, 0]), x2: x([0, setup.h, 0]), y1: y(center), y2: y(center), class: "board", "stroke-width": 7}));
  } else {
    svg.append(
        el("polygon",
           {class: "board", points: [corner(0, 0), corner(setup.w, 0), corner(setup.w, setup.h), corner(0, setup.h)].join(" ")}));
    for (const tag of setup.tags) {
      const s = Math.max(2, tag.size_mm * scale);
      svg.append(el(
          "rect",
          {class: "tag", x: x([tag.center_mm[0], 0, 0]) - s / 2, y: y([0, tag.center_mm[1], 0]) - s / 2, width: s, height: s}));
    }
  }
  const labelled = [];  // places of labels: two that would lie on each other are put below each other
  const title = (kind, name) => (kind === "lamp" && name === "lamp" ? t("lampPlace") : t(kind, {name}));
  const handle = (kind, name, at) => {
    const moves = moved && !setup.posed.includes(name);
    const ray = el("line", {class: "ray", x1: x(center), y1: y(center)});
    const dot = el("circle", {class: kind, r: 12}), label = el("text", {"text-anchor": "middle"}, name);
    const group =
        el("g", {
          class: moves ? "handle" : "",
          tabindex: moves ? 0 : undefined,
          role: moves ? "button" : undefined,
          "aria-label": moves ? title(kind, name) + ", " + t("position") : undefined
        },
           dot, label);
    if (wanted === name) group.prepend(el("circle", {class: "wanted", r: 20}));
    const put = () => {
      ray.setAttribute("x2", x(at)), ray.setAttribute("y2", y(at));
      for (const circle of group.querySelectorAll("circle")) circle.setAttribute("cx", x(at)), circle.setAttribute("cy", y(at));
      label.setAttribute("x", Math.min(kWidth - 30, Math.max(30, x(at))));
      label.setAttribute("y", (y(at) > kHeight - 40 ? y(at) - 22 : y(at) + 32) + lower);
    };
    const lower = 19 * labelled.filter(([px, py]) => Math.hypot(px - x(at), py - y(at)) < 40).length;
    labelled.push([x(at), y(at)]);
    put();
    svg.append(ray, group);
    if (!moves) return;
    const move = (dx, dy, done) => {
      at[axes[0]] = Math.round(at[axes[0]] + dx), at[axes[1]] = Math.round(at[axes[1]] + dy);
      at[2] = Math.max(10, at[2]);
      put();
      moved(kind, name, at, done);
    };
    let last = null;
    group.addEventListener("pointerdown", (event) => {
      last = [event.clientX, event.clientY];
      group.setPointerCapture(event.pointerId);
      event.preventDefault();
      group.focus();
    });
    group.addEventListener("pointermove", (event) => {
      if (!last) return;
      const perPixel = kWidth / svg.getBoundingClientRect().width / scale;
      const dx = (event.clientX - last[0]) * perPixel, dy = -(event.clientY - last[1]) * perPixel;
      if (Math.hypot(dx, dy) < 1) return;
      last = [event.clientX, event.clientY];
      move(dx, dy, false);
    });
    const end = () => {
      if (last) {
        last = null;
        moved(kind, name, at, true);
      }
    };
    group.addEventListener("pointerup", end);
    group.addEventListener("pointercancel", end);
    const steps = {ArrowLeft: [-10, 0], ArrowRight: [10, 0], ArrowUp: [0, 10], ArrowDown: [0, -10]};
    group.addEventListener("keydown", (event) => {
      const step = steps[event.key];
      if (!step) return;
      event.preventDefault();
      move(step[0] * (event.shiftKey ? 0.1 : 1), step[1] * (event.shiftKey ? 0.1 : 1), false);
    });
    group.addEventListener("keyup", (event) => {
      if (steps[event.key]) moved(kind, name, at, true);
    });
  };
  for (const [name, at] of Object.entries(setup.lamps)) handle("lamp", name, at);
  for (const [name, at] of Object.entries(setup.eyes)) handle("eye", name, at);
  if (took) svg.append(el("circle", {class: "took", r: 8, cx: x(took), cy: y(took)}, el("title", {}, "photo")));
  return svg;
}
