// bench_scene.js - three-dimensional view of the bench on a canvas: board, cameras, lamps, uncertainty ellipsoids, and
// tolerance rings on the floor. It needs no WebGL and can be printed. Frame: board, mm (docs/model.md 1).
//
//   const scene = burinBenchScene(element, data, options)      data: bench_scene_json() of tools/view/bench_scene.h
//   options: { alt, eye, lamp: places to drag, [x, y, z]; onEye(p), onLamp(p): called during dragging }
//   scene.update({ data, eye, lamp }): replaces the contents.
//
// The script finds elements <div class="bench-scene"> with their data in a <script type="application/json">.
'use strict';

function burinBenchScene(element, data, options = {}) {
  const add = (a, b, k = 1) => [a[0] + k * b[0], a[1] + k * b[1], a[2] + k * b[2]];
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const scale = (a, k) => [a[0] * k, a[1] * k, a[2] * k];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const unit = (a) => scale(a, 1 / (Math.hypot(...a) || 1));

  const canvas = document.createElement('canvas');
  canvas.tabIndex = 0;
  canvas.setAttribute('role', 'img');
  canvas.setAttribute('aria-label', (options.alt || 'The bench') + '. Turn it with the arrow keys, plus and minus.');
  const words = document.createElement('p');
  words.className = 'bench-scene-words';
  const buttons = document.createElement('div');
  buttons.className = 'bench-scene-buttons';
  const hang = document.createElement('button');
  hang.type = 'button';
  buttons.append(hang);
  element.prepend(canvas, buttons, words);
  const places = element.querySelector('.bench-scene-places');
  if (places) places.open = false;

  const state = { eye: options.eye, lamp: options.lamp, turn: 0.5, tilt: 0.42, zoom: 1, hung: false };
  let center, radius, floor, factor, view, queued = false;

  // Magnification of invisibly small ellipsoids: 1, 2, 5, 10, ...; the largest one becomes a twelfth of the scene.
  function magnification() {
    const sigmas = [...data.eyes, ...data.lamps].flatMap((p) => p.sigma_mm || []);
    const most = Math.max(0, ...sigmas);
    if (!(most > 0)) return 1;
    const wanted = radius / 12 / most, power = 10 ** Math.floor(Math.log10(wanted));
    return Math.max(1, wanted >= 5 * power ? 5 * power : wanted >= 2 * power ? 2 * power : power);
  }

  function measure() {
    const [w, h] = data.size_mm;
    const points = [[0, 0, 0], [w, 0, 0], [0, h, 0], [w, h, 0], ...data.eyes.map((e) => e.at_mm),
      ...data.lamps.map((l) => l.at_mm)];
    if (state.eye) points.push(state.eye);
    if (state.lamp) points.push(state.lamp);
    const extent = () => {
      const low = [0, 1, 2].map((i) => Math.min(...points.map((p) => p[i])));
      const high = [0, 1, 2].map((i) => Math.max(...points.map((p) => p[i])));
      center = scale(add(low, high), 0.5);
      radius = Math.max(1, ...points.map((p) => Math.hypot(...add(p, center, -1))));
      return low;
    };
    // The board is on a table (its face is up) or on a wall (its y is up). The floor is slightly below all objects.
    const low = extent();
    floor = state.hung ? low[1] - 0.12 * radius : 0;
    points.push(...points.map(on_floor));
    extent();
    factor = magnification();
  }
  const up = () => (state.hung ? [0, 1, 0] : [0, 0, 1]);
  const on_floor = (p) => (state.hung ? [p[0], floor, p[2]] : [p[0], p[1], floor]);

  // Orthographic projection: right, upward, towards the viewer.
  function look() {
    const n = up(), front = state.hung ? [0, 0, 1] : [0, -1, 0], side = cross(n, front);
    const level = add(scale(front, Math.cos(state.turn)), side, Math.sin(state.turn));
    const towards = add(scale(level, Math.cos(state.tilt)), n, Math.sin(state.tilt));
    const right = unit(cross(n, towards)), upward = cross(towards, right);
    const box = canvas.getBoundingClientRect();
    const unit_px = 0.55 * Math.min(box.width, box.height) / radius * state.zoom;
    view = { right, upward, towards, unit_px, x: box.width / 2, y: box.height / 2 };
  }
  const to_px = (p) => {
    const d = add(p, center, -1);
    return [view.x + view.unit_px * dot(d, view.right), view.y - view.unit_px * dot(d, view.upward)];
  };

  function draw() {
    queued = false;
    if (!canvas.isConnected) return;
    const dpr = window.devicePixelRatio || 1, box = canvas.getBoundingClientRect();
    if (!(box.width > 0)) return;
    canvas.width = Math.round(box.width * dpr);
    canvas.height = Math.round(box.height * dpr);
    const g = canvas.getContext('2d');
    g.setTransform(dpr, 0, 0, dpr, 0, 0);
    const style = getComputedStyle(canvas), ink = style.color, accent = style.accentColor === 'auto' ? ink : style.accentColor;
    look();
    const line = (points, close) => {
      g.beginPath();
      points.map(to_px).forEach(([x, y], i) => (i ? g.lineTo(x, y) : g.moveTo(x, y)));
      if (close) g.closePath();
    };
    const stroke = (points, color, width, alpha, dash = []) => {
      g.globalAlpha = alpha; g.strokeStyle = color; g.lineWidth = width; g.setLineDash(dash);
      line(points, false); g.stroke(); g.setLineDash([]); g.globalAlpha = 1;
    };
    const fill = (points, color, alpha) => {
      g.globalAlpha = alpha; g.fillStyle = color; line(points, true); g.fill(); g.globalAlpha = 1;
    };
    const say = (text, p, dx = 8, dy = 4) => {
      const [x, y] = to_px(p);
      g.font = '13px system-ui, sans-serif';
      const width = g.measureText(text).width, left = x + dx + width > box.width - 4 ? x - dx - width : x + dx;
      g.lineWidth = 3; g.strokeStyle = style.backgroundColor; g.strokeText(text, left, y + dy);
      g.fillStyle = ink; g.fillText(text, left, y + dy);
    };
    // The silhouette of an ellipsoid with these half axes is the ellipse of its axes' projections.
    const ellipsoid = (at, axes, color, alpha) => {
      const [x, y] = to_px(at);
      let xx = 0, xy = 0, yy = 0;
      for (const axis of axes) {
        const a = view.unit_px * dot(axis, view.right), b = -view.unit_px * dot(axis, view.upward);
        xx += a * a; xy += a * b; yy += b * b;
      }
      const mean = (xx + yy) / 2, half = Math.hypot((xx - yy) / 2, xy);
      g.beginPath();
      g.ellipse(x, y, Math.sqrt(mean + half), Math.sqrt(Math.max(0, mean - half)), Math.atan2(2 * xy, xx - yy) / 2, 0, 7);
      g.globalAlpha = alpha; g.fillStyle = color; g.fill();
      g.globalAlpha = 0.8; g.lineWidth = 1; g.strokeStyle = color; g.stroke(); g.globalAlpha = 1;
    };
    draw_floor(stroke);
    draw_board(stroke, fill);
    for (const eye of data.eyes) draw_eye(eye, { stroke, fill, say, ellipsoid, ink, accent });
    for (const lamp of data.lamps) draw_lamp(g, lamp, { stroke, say, ellipsoid, ink, accent });
    draw_handles(g, say, ink, accent);
  }

  function draw_floor(stroke) {
    const step = 10 ** Math.floor(Math.log10(radius)) / (radius / 10 ** Math.floor(Math.log10(radius)) < 3 ? 2 : 1);
    const n = Math.ceil(1.2 * radius / step), middle = on_floor(center);
    const axes = state.hung ? [[1, 0, 0], [0, 0, 1]] : [[1, 0, 0], [0, 1, 0]];
    for (let i = -n; i <= n; ++i)
      for (const [a, b] of [axes, [axes[1], axes[0]]])
        stroke([add(add(middle, a, i * step), b, -n * step), add(add(middle, a, i * step), b, n * step)], '#888', 1, 0.18);
  }

  function draw_board(stroke, fill) {
    const quad = (a, b) => [[a[0], a[1], 0], [b[0], a[1], 0], [b[0], b[1], 0], [a[0], b[1], 0]];
    const face = quad([0, 0], data.size_mm), carve = quad(...data.carve_mm);
    fill(face, '#8a8f98', dot([0, 0, 1], view.towards) > 0 ? 0.75 : 0.3);
    stroke([...face, face[0]], '#555b66', 1.5, 1);
    stroke([...carve, carve[0]], '#fff', 1, 0.6, [4, 3]);
    for (const tag of data.tags) fill(tag.corners_mm.map((c) => [...c, 0]), '#fff', 0.85);
  }

  function draw_eye(eye, { stroke, fill, say, ellipsoid, ink, accent }) {
    if (eye.tolerance_mm) draw_ring(eye, stroke, fill, accent);
    const size = 0.09 * radius, [right, down, forward] = eye.camera;
    const corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([a, b]) =>
      add(add(add(eye.at_mm, forward, size), right, a * size * Math.min(0.8, data.field_of_view[0])), down,
        b * size * Math.min(0.8, data.field_of_view[1])));
    for (const corner of corners) stroke([eye.at_mm, corner], ink, 1.2, 0.9);
    stroke([...corners, corners[0]], ink, 1.2, 0.9);
    stroke([corners[0], add(scale(add(corners[0], corners[1]), 0.5), down, -0.2 * size), corners[1]], ink, 1.2, 0.9);
    stroke([eye.at_mm, on_floor(eye.at_mm)], '#888', 1, 0.7, [2, 3]);
    if (eye.sigma_mm)
      ellipsoid(eye.at_mm, eye.sigma_mm.map((s, i) => [0, 1, 2].map((j) => (i === j ? factor * s : 0))), '#2a6fd6', 0.3);
    // With many photos, only the designed views have names.
    if (data.eyes.length <= 8 || eye.tolerance_mm || !data.eyes.some((e) => e.tolerance_mm)) say(eye.name, eye.at_mm);
  }

  // Shadow of the eye's tolerance on the floor: the ellipse of the half axes' projections.
  function draw_ring(eye, stroke, fill, accent) {
    const axes = state.hung ? [0, 2] : [0, 1], foot = on_floor(eye.at_mm);
    let xx = 0, xy = 0, yy = 0;
    for (const t of eye.tolerance_mm) {
      xx += t[axes[0]] ** 2; xy += t[axes[0]] * t[axes[1]]; yy += t[axes[1]] ** 2;
    }
    const mean = (xx + yy) / 2, half = Math.hypot((xx - yy) / 2, xy), turn = Math.atan2(2 * xy, xx - yy) / 2;
    const a = Math.sqrt(mean + half), b = Math.sqrt(Math.max(0, mean - half)), ring = [];
    for (let i = 0; i <= 48; ++i) {
      const u = a * Math.cos(i * Math.PI / 24), v = b * Math.sin(i * Math.PI / 24), p = [...foot];
      p[axes[0]] += u * Math.cos(turn) - v * Math.sin(turn);
      p[axes[1]] += u * Math.sin(turn) + v * Math.cos(turn);
      ring.push(p);
    }
    fill(ring, accent, 0.18);
    stroke(ring, accent, 2, 0.9);
  }

  function draw_lamp(g, lamp, { stroke, say, ellipsoid, accent }) {
    stroke([lamp.at_mm, on_floor(lamp.at_mm)], '#888', 1, 0.7, [2, 3]);
    if (lamp.axis) stroke([lamp.at_mm, add(lamp.at_mm, lamp.axis, 0.25 * radius)], accent, 2, 0.9);
    if (lamp.sigma_mm)
      ellipsoid(lamp.at_mm, lamp.sigma_mm.map((s, i) => [0, 1, 2].map((j) => (i === j ? factor * s : 0))), accent, 0.3);
    const [x, y] = to_px(lamp.at_mm);
    g.strokeStyle = accent; g.lineWidth = 2;
    for (let i = 0; i < 8; ++i) {
      const c = Math.cos(i * Math.PI / 4), s = Math.sin(i * Math.PI / 4);
      g.beginPath(); g.moveTo(x + 6 * c, y + 6 * s); g.lineTo(x + 10 * c, y + 10 * s); g.stroke();
    }
    g.beginPath(); g.arc(x, y, 4, 0, 7); g.fillStyle = accent; g.fill();
    say(lamp.name, lamp.at_mm, 13);
  }

  // Draggable objects: the present eye and the present lamp.
  function draw_handles(g, say, ink, accent) {
    for (const [p, color] of [[state.eye, '#2a6fd6'], [state.lamp, accent]]) {
      if (!p) continue;
      const [x, y] = to_px(p), [fx, fy] = to_px(on_floor(p));
      g.setLineDash([2, 3]); g.strokeStyle = color; g.lineWidth = 1.5;
      g.beginPath(); g.moveTo(x, y); g.lineTo(fx, fy); g.stroke(); g.setLineDash([]);
      g.beginPath(); g.arc(x, y, 8, 0, 7); g.globalAlpha = 0.85; g.fillStyle = color; g.fill(); g.globalAlpha = 1;
      g.lineWidth = 2; g.strokeStyle = '#fff'; g.stroke();
    }
    if (state.eye) say('you', state.eye, 13, -6);
  }

  function tell() {
    const known = [...data.eyes, ...data.lamps].some((p) => p.sigma_mm);
    const parts = [];
    if (known) parts.push(factor > 1 ? `Ellipsoids: one sigma of each place, drawn ${factor} times as large.`
      : 'Ellipsoids: one sigma of each place.');
    if (data.eyes.some((e) => e.tolerance_mm)) parts.push('Rings on the floor: where a picture holds.');
    words.textContent = parts.join(' ');
    hang.textContent = state.hung ? 'Lay the board down' : 'Hang the board up';
  }
  function refresh() {
    if (!queued) { queued = true; requestAnimationFrame(draw); }
  }
  function again() { measure(); tell(); refresh(); }

  function turn_by(dx, dy) {
    state.turn -= dx;
    state.tilt = Math.min(1.55, Math.max(-0.3, state.tilt + dy));
    refresh();
  }
  // A dragged place moves in the plane parallel to the screen.
  function move(p, dx, dy) {
    return add(add(p, view.right, dx / view.unit_px), view.upward, -dy / view.unit_px);
  }
  const fingers = new Map();
  let held = null;
  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, [event.offsetX, event.offsetY]);
    look();
    held = null;
    for (const name of ['lamp', 'eye']) {
      const p = state[name];
      if (!p || !options[name === 'eye' ? 'onEye' : 'onLamp']) continue;
      const [x, y] = to_px(p);
      if (Math.hypot(event.offsetX - x, event.offsetY - y) < 22) held = name;
    }
    canvas.focus();
    event.preventDefault();
  });
  canvas.addEventListener('pointermove', (event) => {
    const before = fingers.get(event.pointerId);
    if (!before) return;
    const now = [event.offsetX, event.offsetY], dx = now[0] - before[0], dy = now[1] - before[1];
    if (fingers.size > 1) {
      const other = [...fingers].find(([id]) => id !== event.pointerId)[1];
      zoom_by(Math.hypot(now[0] - other[0], now[1] - other[1]) /
        Math.max(1, Math.hypot(before[0] - other[0], before[1] - other[1])));
    } else if (held) {
      state[held] = move(state[held], dx, dy);
      (held === 'eye' ? options.onEye : options.onLamp)(state[held]);
      refresh();
    } else {
      turn_by(dx / 150, dy / 150);
    }
    fingers.set(event.pointerId, now);
  });
  for (const end of ['pointerup', 'pointercancel'])
    canvas.addEventListener(end, (event) => { fingers.delete(event.pointerId); if (held) { held = null; again(); } });
  function zoom_by(k) { state.zoom = Math.min(8, Math.max(0.3, state.zoom * k)); refresh(); }
  canvas.addEventListener('wheel', (event) => { zoom_by(Math.exp(-event.deltaY / 600)); event.preventDefault(); }, { passive: false });
  canvas.addEventListener('keydown', (event) => {
    const step = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.08], ArrowDown: [0, -0.08] }[event.key];
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (step) turn_by(...step);
    else if (event.key === '+' || event.key === '=') zoom_by(1.15);
    else if (event.key === '-') zoom_by(1 / 1.15);
    else return;
    event.preventDefault();
    event.stopPropagation();
  });
  hang.addEventListener('click', () => { state.hung = !state.hung; again(); });
  new ResizeObserver(refresh).observe(canvas);
  window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', refresh);
  window.addEventListener('beforeprint', draw);
  again();
  return {
    canvas,
    update(change) {
      const whole = 'data' in change;
      if (whole) data = change.data;
      if ('eye' in change && held !== 'eye') state.eye = change.eye;
      if ('lamp' in change && held !== 'lamp') state.lamp = change.lamp;
      if (whole) again(); else refresh();
    },
  };
}

for (const element of document.querySelectorAll('.bench-scene')) {
  const data = element.querySelector('script[type="application/json"]');
  if (data) burinBenchScene(element, JSON.parse(data.textContent), { alt: element.dataset.alt });
}
