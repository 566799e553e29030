// viewer.js - the page of `burin view`: a movable eye, a movable lamp, and the resulting picture of the board.
// Frame: board, mm (docs/model.md 1). The address sets the page up, after #:
//   view=NAME, light=ID, board=0 (the first), look=seen|flat|photo, exposure=auto|NUMBER, eye=X,Y,Z, lamp=X,Y,Z,
//   picture (the picture alone), size=WxH (of it, in the screen's own pixels)
'use strict';

(() => {
  const data = JSON.parse(document.getElementById('data').textContent);
  const by_id = (id) => document.getElementById(id);
  const canvas = by_id('board');
  const shaders = {};
  for (const element of document.querySelectorAll('script[type="x-shader"]')) shaders[element.id] = element.textContent;
  const asked = Object.fromEntries(location.hash.slice(1).split('&').filter(Boolean).map((part) => {
    const at = part.indexOf('=');
    const text = part.slice(at + 1);
    try { return at < 0 ? [part, true] : [part.slice(0, at), decodeURIComponent(text)]; } catch (error) { return [part, text]; }
  }));
  const galleries = [...document.querySelectorAll('.gallery')];

  let board = null, why = 'This browser has no WebGL2';
  try { board = burinBoard(canvas, shaders); } catch (error) { why = 'This graphics driver refuses the board\'s shaders'; console.warn(String(error)); }
  if (!board) {
    by_id('without').textContent = why +
      ', so nothing moves here: below is how the board looks from its places. Try a current Firefox, Chrome, Edge or Safari.';
    by_id('without').hidden = false;
    return;
  }

  const add = (a, b, k = 1) => a.map((v, i) => v + k * b[i]);
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const unit = (a) => a.map((v) => v / (Math.hypot(...a) || 1));
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const turned = (M, v) => M.map((row) => dot(row, v));
  const middle = [(data.carve_mm[0][0] + data.carve_mm[1][0]) / 2, (data.carve_mm[0][1] + data.carve_mm[1][1]) / 2, 0];
  const kNearest = 0.25 * Math.hypot(...data.size_mm), kLowest = 8 * Math.PI / 180;

  const state = { board: 0, picture: 0, eye: null, lamp: null, drag: 'eye', look: 'seen', brightness: 0, exposure: null,
    walk: null, tilt: null, tilted: null, quality: 1, picture_only: Boolean(asked.picture) };
  const now = () => data.boards[state.board];
  const place = () => now().pictures[state.picture];
  const light = () => now().lights[place().lights[0]];  // the movable one; the others keep their offsets from it

  // ---- places -------------------------------------------------------------------------------------------------------------
  function kept_above(p) {
    const d = add(p, middle, -1), r = Math.max(kNearest, Math.hypot(...d)), u = unit(d);
    const level = Math.hypot(u[0], u[1]), z = Math.max(u[2], Math.sin(kLowest));
    const k = level > 0 ? Math.sqrt(1 - z * z) / level : 0;
    return add(middle, u[2] < z ? [u[0] * k, u[1] * k, z] : u, Math.min(r, 100 * Math.hypot(...data.size_mm)));
  }
  // On a sphere about the board's center: to the right and up, seen from the place.
  function swung(p, right, up) {
    const d = add(p, middle, -1), r = Math.hypot(...d);
    const longitude = Math.atan2(d[0], d[2]) + right;
    const latitude = Math.asin(Math.max(-1, Math.min(1, d[1] / r))) + up;
    const most = Math.PI / 2 - kLowest, a = Math.max(-most, Math.min(most, longitude)), b = Math.max(-most, Math.min(most, latitude));
    return kept_above(add(middle, [Math.sin(a) * Math.cos(b), Math.sin(b), Math.cos(a) * Math.cos(b)], r));
  }
  const scaled = (p, k) => kept_above(add(middle, add(p, middle, -1), k));
  function between(a, b, t) {  // along the great circle, with evenly changing distance
    const p = add(a, middle, -1), q = add(b, middle, -1), rp = Math.hypot(...p), rq = Math.hypot(...q);
    const angle = Math.acos(Math.max(-1, Math.min(1, dot(p, q) / (rp * rq))));
    const k = angle > 1e-6 ? [Math.sin((1 - t) * angle) / Math.sin(angle), Math.sin(t * angle) / Math.sin(angle)] : [1 - t, t];
    return add(middle, add(p.map((v) => v / rp * k[0]), q.map((v) => v / rq), k[1]), rp + t * (rq - rp));
  }
  // Eye and lamp relative to a rotated board.
  function seen_from() {
    if (!state.tilted) return [state.eye, state.lamp];
    return [state.eye, state.lamp].map((p) => kept_above(add(middle, turned(state.tilted, add(p, middle, -1)))));
  }
  // All lights of a place when its first lamp is at this position: { light, at }, with white balance.
  function shining(lamp) {
    const g = place().gains, way = add(lamp, state.tilted ? turned(state.tilted, add(light().at_mm, middle, -1)) : light().at_mm, -1);
    const moved = Math.hypot(...way) > 1e-9;
    return place().lights.map((id, i) => {
      const one = now().lights[id];
      const at = state.tilted ? turned(state.tilted, add(one.at_mm, middle, -1)) : one.at_mm;
      return { ...one, intensity: one.intensity.map((v, c) => v * g[c]), at: i === 0 ? lamp : moved ? kept_above(add(at, way)) : at };
    });
  }
  function stand(index, keep_walking = false) {
    if (!keep_walking) stop_walk();
    state.picture = Math.min(index, now().pictures.length - 1);
    state.eye = [...place().eye_mm];
    state.lamp = [...light().at_mm];
    show_picture();
    changed();
  }

  // ---- exposure -----------------------------------------------------------------------------------------------------------
  // Eyes adapt: near a place its picture's own exposure, between places an interpolated one.
  function exposure_at(eye) {
    if (state.exposure) return state.exposure * 2 ** state.brightness;
    let sum = 0, weights = 0;
    for (const p of now().pictures) {
      if (p.light !== place().light) continue;
      const a = unit(add(eye, middle, -1)), b = unit(add(p.eye_mm, middle, -1));
      const weight = 1 / (1e-5 + add(a, b, -1).reduce((s, v) => s + v * v, 0));
      sum += weight * Math.log(p.exposure);
      weights += weight;
    }
    return Math.exp(sum / weights) * 2 ** state.brightness;
  }

  // ---- looks --------------------------------------------------------------------------------------------------------------
  function look_of(eye, width, height) {
    const kNone = Array(12).fill(0);
    if (state.look === 'flat') {
      const k = Math.max((data.size_mm[0]) / width, (data.size_mm[1]) / height) * (state.picture_only ? 1 : 1.04);
      const c = data.size_mm.map((v) => v / 2);
      return { flat: [c[0] - k * width / 2, c[1] - k * height / 2, c[0] + k * width / 2, c[1] + k * height / 2] };
    }
    if (state.look === 'carve') return { flat: data.carve_mm.flat() };
    if (state.look === 'photo') {
      const lens = now().lens, R = place().R, k = Math.min(width / lens.width, height / lens.height);
      const x = (width - k * lens.width) / 2, y = (height - k * lens.height) / 2;
      const [fx, fy, cx, cy] = lens.fxycxy;
      return { R, T: turned(R, eye).map((v) => -v), k: lens.k,
        lens: [fx * k, fy * k, (cx + 0.5) * k - 0.5 + x, (cy + 0.5) * k - 0.5 + y] };
    }
    // View towards the board's center: whole, upright, as large as the canvas allows.
    const target = [data.size_mm[0] / 2, data.size_mm[1] / 2, 0], forward = unit(add(target, eye, -1));
    const right = unit(cross(forward, Math.abs(forward[1]) < 0.999 ? [0, 1, 0] : [0, 0, -1])), down = cross(forward, right);
    const R = [right, down, forward], T = turned(R, eye).map((v) => -v);
    const corners = [[0, 0], [1, 0], [0, 1], [1, 1]].map(([a, b]) => {
      const c = add(turned(R, [a * data.size_mm[0], b * data.size_mm[1], 0]), T);
      return [c[0] / c[2], c[1] / c[2]];
    });
    const low = [0, 1].map((i) => Math.min(...corners.map((c) => c[i])));
    const high = [0, 1].map((i) => Math.max(...corners.map((c) => c[i])));
    const f = 0.94 * Math.min(width / (high[0] - low[0]), height / (high[1] - low[1]));
    return { R, T, k: kNone, lens: [f, f, width / 2 - 0.5 - f * (low[0] + high[0]) / 2, height / 2 - 0.5 - f * (low[1] + high[1]) / 2] };
  }

  // ---- drawing ------------------------------------------------------------------------------------------------------------
  const scene_of = (b) => ({ size_mm: data.size_mm, bow_mm: b.bow_mm, material: b.material,
    ambient: b.ambient.map((v, c) => v * place().gains[c]) });
  function fit_canvas() {
    const size = /^(\d{1,4})x(\d{1,4})$/.exec(asked.size);
    if (size && state.picture_only) {
      [canvas.width, canvas.height] = [size[1], size[2]].map((v) => Math.max(1, Number(v)));
    } else if (state.picture_only && state.look === 'photo') {
      canvas.width = now().lens.width; canvas.height = now().lens.height;
    } else {
      const box = canvas.getBoundingClientRect(), k = (window.devicePixelRatio || 1) * state.quality;
      const w = Math.max(1, Math.round(box.width * k)), h = Math.max(1, Math.round(box.height * k));
      if (canvas.width !== w || canvas.height !== h) { canvas.width = w; canvas.height = h; }
      return;
    }
    const dpr = window.devicePixelRatio || 1;
    canvas.style.width = canvas.width / dpr + 'px';
    canvas.style.height = canvas.height / dpr + 'px';
  }
  function draw() {
    fit_canvas();
    board.set_scratches(data.rows[now().rows]);
    const [eye, lamp] = seen_from(), { width, height } = canvas, look = look_of(eye, width, height);
    if (asked.exposure === 'auto' || (asked.exposure === undefined && state.picture_only && state.look === 'photo'))
      state.exposure = board.white(scene_of(now()), shining(lamp), look, eye, width, height);
    board.draw(scene_of(now()), shining(lamp), look, eye, exposure_at(eye));
  }
  let queued = false, resting = 0, last = 0, slow = 0;
  function changed() {
    if (queued) return;
    queued = true;
    requestAnimationFrame(frame);
  }
  // If a frame takes too long, the picture is coarser during a movement, and complete afterwards.
  function frame(time) {
    queued = false;
    if (state.walk) walk_on(time);
    const moving = Boolean(state.walk || state.tilt || fingers.size);
    if (moving && last && time - last < 1000) slow = 0.7 * slow + 0.3 * (time - last);
    if (!state.picture_only) state.quality = moving && slow > 45 ? (slow > 150 ? 0.35 : 0.5) : 1;
    last = moving ? time : 0;
    draw();
    tell();
    const [eye, lamp] = seen_from();
    if (room) room.update({ eye, lamp });
    clearTimeout(resting);
    if (state.walk) changed();
    else if (state.quality < 1) resting = setTimeout(() => { last = 0; slow = 0; state.quality = 1; draw(); }, 250);
  }

  // ---- words --------------------------------------------------------------------------------------------------------------
  let told = '';
  function tell() {
    const [eye] = seen_from();
    let nearest = 0, least = Infinity;
    now().pictures.forEach((p, i) => {
      const angle = Math.acos(Math.min(1, dot(unit(add(eye, middle, -1)), unit(add(p.eye_mm, middle, -1)))));
      if (angle < least - 1e-9) { least = angle; nearest = i; }
    });
    if (least < 1e-6) nearest = state.picture;
    const p = now().pictures[nearest], degrees = least * 180 / Math.PI, holds = inside(p, eye);
    const where = degrees < 0.05 ? `You stand at ${p.name}` : `${degrees < 9.5 ? degrees.toFixed(1) : Math.round(degrees)}\u00b0 from ${p.name}`;
    const text = where + (holds === null || degrees < 0.05 ? '.' : holds ? ': its picture holds here.' : ': beyond where its picture holds.');
    if (text !== told) by_id('status').textContent = told = text;
    canvas.setAttribute('aria-label', `The board as it glints. ${text}`);
    galleries[state.board].querySelectorAll('.card').forEach((card, i) => {
      card.classList.toggle('here', i === nearest && (degrees < 0.05 || holds === true));
    });
  }
  function inside(p, eye) {
    if (!p.tolerance_mm) return null;
    const d = add(eye, p.eye_mm, -1);
    return p.tolerance_mm.reduce((sum, axis) => sum + (dot(d, axis) / dot(axis, axis)) ** 2, 0) <= 1;
  }
  function show_picture() {
    const card = galleries[state.board].querySelectorAll('.card')[state.picture], image = card && card.querySelector('img.target');
    const figure = by_id('target');
    figure.hidden = !image || by_id('targets').getAttribute('aria-pressed') !== 'true';
    by_id('targets').hidden = !image;
    if (!image) return;
    figure.querySelector('img').src = image.src;
    figure.querySelector('img').alt = image.alt;
    figure.querySelector('figcaption').textContent = `What ${place().name} is to show, as it lies on the board`;
  }
  const pressed = (id, on) => by_id(id).setAttribute('aria-pressed', String(on));

  // ---- actions -----------------------------------------------------------------------------------------------------
  function set_board(index) {
    const at_place = add(state.eye || [0, 0, 0], place().eye_mm, -1).every((v) => Math.abs(v) < 1e-9);
    state.board = index;
    by_id('sentence').textContent = now().sentence;
    galleries.forEach((g, i) => { g.hidden = i !== index; });
    [...by_id('boards').children].forEach((b, i) => b.setAttribute('aria-pressed', String(i === index)));
    if (room) room.update({ data: now().scene });
    if (at_place || !state.eye) stand(state.picture);
    else { state.picture = Math.min(state.picture, now().pictures.length - 1); show_picture(); changed(); }
  }
  function set_drag(what) {
    state.drag = what;
    pressed('drag-eye', what === 'eye');
    pressed('drag-lamp', what === 'lamp');
  }
  const kLooks = ['seen', 'flat', 'photo'], kLookNames = { seen: 'As seen', flat: 'Laid flat', photo: 'As a photo', carve: 'Carve area' };
  function set_look(look) {
    state.look = look;
    by_id('look').textContent = kLookNames[look];
    changed();
  }
  function set_brightness(value) {
    state.brightness = Math.max(-2, Math.min(2, value));
    by_id('brightness').value = state.brightness;
    changed();
  }
  function toggle_targets() {
    pressed('targets', by_id('targets').getAttribute('aria-pressed') !== 'true');
    show_picture();
    changed();
  }
  function swing(right, up) {
    stop_walk();
    state[state.drag] = swung(state[state.drag], right, up);
    changed();
  }
  function come(k) {
    stop_walk();
    state[state.drag] = scaled(state[state.drag], k);
    changed();
  }

  const kLeg_ms = 2600, kPause = 0.35;  // from one place to the next; share of it without movement
  function walk_on(time) {
    const all = now().pictures, order = all.map((_, i) => i)
      .sort((a, b) => Math.atan2(...[0, 2].map((i) => add(all[a].eye_mm, middle, -1)[i])) -
        Math.atan2(...[0, 2].map((i) => add(all[b].eye_mm, middle, -1)[i])));
    const walk = state.walk;
    if (walk.begin === null) walk.begin = time - kLeg_ms * Math.max(0, order.indexOf(state.picture));
    const legs = Math.max(1, order.length - 1), at = (time - walk.begin) / kLeg_ms, back = Math.floor(at / legs) % 2 === 1;
    const along = back ? legs - at % legs : at % legs, i = Math.min(legs - 1, Math.floor(along));
    const t = Math.min(1, Math.max(0, (along - i - kPause / 2) / (1 - kPause))), ease = t * t * (3 - 2 * t);
    const a = all[order[i]], b = all[order[Math.min(order.length - 1, i + 1)]];
    state.eye = between(a.eye_mm, b.eye_mm, ease);
    state.lamp = between(now().lights[a.lights[0]].at_mm, now().lights[b.lights[0]].at_mm, ease);
    const index = order[Math.min(order.length - 1, ease < 0.5 ? i : i + 1)];
    if (index !== state.picture) { state.picture = index; show_picture(); }
  }
  function stop_walk() {
    if (!state.walk) return;
    state.walk = null;
    pressed('walk', false);
  }
  function toggle_walk() {
    if (state.walk) { stop_walk(); changed(); return; }
    state.walk = { begin: null };
    pressed('walk', true);
    changed();
  }

  // The phone acts as the board, with eye and lamp fixed in the room. W3C, Device Orientation: alpha, beta, gamma are
  // rotations about z, x, y, one after the other.
  function orientation(event) {
    if (event.alpha === null && event.beta === null) return;
    const [a, b, c] = [event.alpha || 0, event.beta || 0, event.gamma || 0].map((v) => v * Math.PI / 180);
    const s = -((screen.orientation && screen.orientation.angle) || 0) * Math.PI / 180;
    const times = (A, B) => A.map((row) => [0, 1, 2].map((j) => dot(row, B.map((r) => r[j]))));
    const about_z = (t) => [[Math.cos(t), -Math.sin(t), 0], [Math.sin(t), Math.cos(t), 0], [0, 0, 1]];
    const about_x = [[1, 0, 0], [0, Math.cos(b), -Math.sin(b)], [0, Math.sin(b), Math.cos(b)]];
    const about_y = [[Math.cos(c), 0, Math.sin(c)], [0, 1, 0], [-Math.sin(c), 0, Math.cos(c)]];
    const R = times(times(times(about_z(a), about_x), about_y), about_z(s));
    if (!state.tilt.first) state.tilt.first = R;
    state.tilted = times([0, 1, 2].map((i) => R.map((row) => row[i])), state.tilt.first);
    changed();
  }
  async function toggle_tilt() {
    if (state.tilt) {
      window.removeEventListener('deviceorientation', orientation);
      clearTimeout(state.tilt.waiting);
      state.tilt = state.tilted = null;
      pressed('tilt', false);
      changed();
      return;
    }
    const say = (text) => { by_id('status').textContent = told = text; };
    if (!('DeviceOrientationEvent' in window)) { say('This device does not say how it is held.'); return; }
    if (typeof DeviceOrientationEvent.requestPermission === 'function') {  // iOS asks for permission, only after a touch
      let answer = 'denied';
      try { answer = await DeviceOrientationEvent.requestPermission(); } catch (error) { answer = 'denied'; }
      if (answer !== 'granted') { say('The device was not allowed to say how it is held.'); return; }
    }
    state.tilt = { first: null };
    state.tilt.waiting = setTimeout(() => {
      if (state.tilt && !state.tilt.first) { toggle_tilt(); say('This device does not say how it is held: drag instead.'); }
    }, 1500);
    pressed('tilt', true);
    window.addEventListener('deviceorientation', orientation);
  }

  function toggle_full() {
    const stage = by_id('stage');
    const settle = () => { changed(); setTimeout(changed, 300); };
    if (document.fullscreenElement) { document.exitFullscreen().then(settle); return; }
    if (stage.classList.contains('showing')) { stage.classList.remove('showing'); settle(); return; }
    const without = () => { stage.classList.add('showing'); settle(); };  // some phones allow it for videos only
    if (stage.requestFullscreen) stage.requestFullscreen().then(settle, without);
    else without();
  }

  // ---- pointers and keys --------------------------------------------------------------------------------------------------------------
  const fingers = new Map();
  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
  });
  canvas.addEventListener('pointermove', (event) => {
    const before = fingers.get(event.pointerId);
    if (!before) return;
    const at = [event.clientX, event.clientY], dx = at[0] - before[0], dy = at[1] - before[1];
    if (fingers.size > 1) {
      const other = [...fingers].find(([id]) => id !== event.pointerId)[1];
      const apart = (p) => Math.max(1, Math.hypot(p[0] - other[0], p[1] - other[1]));
      come(apart(before) / apart(at));
    } else {
      const k = 1.2 / Math.max(300, canvas.getBoundingClientRect().width);  // the canvas' width: about 70 degrees
      swing(dx * k, -dy * k);
    }
    fingers.set(event.pointerId, at);
  });
  for (const end of ['pointerup', 'pointercancel'])
    canvas.addEventListener(end, (event) => { fingers.delete(event.pointerId); changed(); });
  canvas.addEventListener('wheel', (event) => { come(Math.exp(event.deltaY / 900)); event.preventDefault(); }, { passive: false });

  document.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
    const at = event.target, types = at.tagName === 'INPUT', presses = at.tagName === 'BUTTON' || at.tagName === 'SUMMARY';
    const step = (event.shiftKey ? 5 : 1) * Math.PI / 180, key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    const arrow = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, step], ArrowDown: [0, -step] }[key];
    if (arrow && !types) swing(...arrow);
    else if (key >= '1' && key <= '9') { if (Number(key) > now().pictures.length) return; stand(Number(key) - 1); }
    else if (key === 'Home' && !types) stand(0);
    else if (key === ' ' && !presses && !types) toggle_walk();
    else if (key === '+' || key === '=') come(1 / 1.05);
    else if (key === '-') come(1.05);
    else if (key === '[') set_brightness(state.brightness - 0.2);
    else if (key === ']') set_brightness(state.brightness + 0.2);
    else if (key === 'l') set_drag(state.drag === 'eye' ? 'lamp' : 'eye');
    else if (key === 'b') { if (data.boards.length < 2) return; set_board((state.board + 1) % data.boards.length); }
    else if (key === 't') toggle_targets();
    else if (key === 'r') set_look(kLooks[(kLooks.indexOf(state.look) + 1) % kLooks.length]);
    else if (key === 'f') toggle_full();
    else if (key === 'Escape' && by_id('stage').classList.contains('showing')) toggle_full();
    else return;
    event.preventDefault();
  });

  // ---- the page -----------------------------------------------------------------------------------------------------------
  by_id('stage').hidden = false;
  data.boards.forEach((b, i) => {
    const button = document.createElement('button');
    button.type = 'button';
    button.textContent = b.name;
    button.addEventListener('click', () => set_board(i));
    by_id('boards').append(button);
  });
  by_id('boards').hidden = data.boards.length < 2;
  galleries.forEach((gallery, g) => gallery.querySelectorAll('.card button').forEach((button, i) => {
    button.hidden = false;
    button.addEventListener('click', () => { if (g !== state.board) set_board(g); stand(i); canvas.scrollIntoView({ block: 'nearest' }); });
  }));
  const buttons = { 'drag-eye': () => set_drag('eye'), 'drag-lamp': () => set_drag('lamp'), walk: toggle_walk, tilt: toggle_tilt,
    look: () => set_look(kLooks[(kLooks.indexOf(state.look) + 1) % kLooks.length]), targets: toggle_targets, full: toggle_full };
  for (const [id, act] of Object.entries(buttons)) by_id(id).addEventListener('click', act);
  by_id('brightness').addEventListener('input', (event) => set_brightness(Number(event.target.value)));
  window.addEventListener('resize', changed);
  document.addEventListener('fullscreenchange', changed);
  board.on_lost(changed);

  let room = null;
  document.body.classList.toggle('picture', state.picture_only);
  if (!state.picture_only) {
    by_id('room').hidden = false;
    room = burinBenchScene(document.querySelector('#room .bench-scene'), now().scene, {
      alt: 'The room: board, places to look from, lamp, and where you are', eye: now().pictures[0].eye_mm,
      lamp: now().lights[now().pictures[0].lights[0]].at_mm,
      onEye: (p) => { stop_walk(); state.eye = kept_above(p); changed(); },
      onLamp: (p) => { stop_walk(); state.lamp = kept_above(p); changed(); },
    });
  }
  const numbers = (text) => { const v = text.split(',').map(Number); return v.length === 3 && v.every(Number.isFinite) ? v : null; };
  const index = Math.max(0, Math.min(data.boards.length - 1, Number(asked.board) || 0));
  set_board(index);
  if (asked.view) {
    const found = now().pictures.findIndex((p) => p.view === asked.view && (!asked.light || p.light === asked.light));
    if (found >= 0) stand(found);
    else by_id('status').textContent = told = `There is no view ${asked.view} here.`;
  }
  if (kLookNames[asked.look]) set_look(asked.look);
  if (asked.eye && numbers(asked.eye)) state.eye = numbers(asked.eye);
  if (asked.lamp && numbers(asked.lamp)) state.lamp = numbers(asked.lamp);
  if (Number(asked.exposure) > 0) state.exposure = Number(asked.exposure);
  if (state.picture_only) canvas.blur();
  draw();
  tell();
  by_id('speed').textContent = `${data.rows[now().rows].count} grooves; sums in ${board.sums}; drawn by ${board.machine}.`;

  // For tests and the console.
  window.burinView = {
    state, draw, stand, board,
    picture: () => { state.quality = 1; draw(); return canvas.toDataURL('image/png'); },
    // Milliseconds per frame over n frames, with a wait for each.
    time(n = 10, width = canvas.width, height = canvas.height) {
      const [eye, lamp] = seen_from(), old = [canvas.width, canvas.height];
      canvas.width = width; canvas.height = height;
      const look = look_of(eye, width, height), begin = performance.now();
      for (let i = 0; i < n; ++i) {
        board.draw(scene_of(now()), shining(lamp), look, add(eye, [i % 2, 0, 0]), exposure_at(eye));
        board.finish();
      }
      const each = (performance.now() - begin) / n;
      [canvas.width, canvas.height] = old;
      draw();
      return each;
    },
  };
})();
