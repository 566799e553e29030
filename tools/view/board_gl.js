// board_gl.js - renders the board with WebGL2: each scratch's glint in closed form, summed per pixel, displayed as in
// `burin render` (docs/model.md 3 to 5). Frame: board, mm.
//
//   const board = burinBoard(canvas, shaders)                 null without WebGL2
//   board.set_scratches(rows)                                 as tools/view/packed_scratches.h packs them
//   board.draw(scene, lights, look, eye, exposure)
//     scene: size_mm, bow_mm, material, ambient
//     lights, all on together: [{ at, axis, falloff_exponent, intensity }, ...]; the surroundings count once
//     look: { flat: [x0, y0, x1, y1] mm } or { R, T, lens: [fx, fy, cx, cy], k: 12 of OpenCV's }
//   board.white(...): the exposure at which the brightest half per cent of the lit pixels clips
'use strict';

function burinBoard(canvas, shaders) {
  const gl = canvas.getContext('webgl2', { antialias: false, alpha: false, preserveDrawingBuffer: true });
  if (!gl) return null;
  const forced = /[#&]sums=(8|16)/.exec(location.hash);  // to test the paths of weaker machines
  const float_targets = !(forced && forced[1] === '8') && gl.getExtension('EXT_color_buffer_float');
  const full = float_targets && !forced && gl.getExtension('EXT_float_blend');
  const format = full ? gl.RG32F : float_targets ? gl.RG16F : gl.RGBA8;
  const kEncoded = 0, kLinear = 1, kRoots = 2;  // output of board.frag.glsl: for screens; for measurements and sums
  const kGrid = 48;  // cells along a side of a face bent by bow or lens

  function compiled(type, text) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, '#version 300 es\nprecision highp float;\nprecision highp int;\n' + text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost()) throw new Error(gl.getShaderInfoLog(shader));
    return shader;
  }
  function linked(vertex, fragment, attributes) {
    const program = gl.createProgram();
    gl.attachShader(program, compiled(gl.VERTEX_SHADER, vertex));
    gl.attachShader(program, compiled(gl.FRAGMENT_SHADER, fragment));
    attributes.forEach((name, i) => gl.bindAttribLocation(program, i, name));
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) throw new Error(gl.getProgramInfoLog(program));
    const places = {};
    for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); ++i) {
      const { name } = gl.getActiveUniform(program, i);
      places[name] = gl.getUniformLocation(program, name);
    }
    return { program, places };
  }

  let scratches, board, sums, measure, kept, grids, sets = new Map(), rows = null, lost = false;
  function build() {
    scratches = linked(shaders.camera + shaders.light + shaders.scratch_vert, shaders.scratch_frag, []);
    board = linked(shaders.camera + shaders.board_vert, shaders.camera + shaders.light + shaders.board_frag, ['aPlace']);
    grids = [1, kGrid].map((n) => {
      const array = gl.createVertexArray(), places = [];
      for (let y = 0; y < n; ++y)
        for (let x = 0; x < n; ++x)
          for (const [a, b] of [[0, 0], [1, 0], [0, 1], [0, 1], [1, 0], [1, 1]]) places.push((x + a) / n, (y + b) / n);
      gl.bindVertexArray(array);
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(places), gl.STATIC_DRAW);
      gl.enableVertexAttribArray(0);
      gl.vertexAttribPointer(0, 2, gl.FLOAT, false, 0, 0);
      gl.bindVertexArray(null);
      return { array, count: 6 * n * n };
    });
    sums = measure = null;
    kept = [null, null];
    sets = new Map();
  }
  build();

  function numbers_of(base64) {  // 16 bits each, little-endian
    const text = atob(base64), numbers = new Uint16Array(text.length >> 1);
    for (let i = 0; i < numbers.length; ++i) numbers[i] = text.charCodeAt(2 * i) | text.charCodeAt(2 * i + 1) << 8;
    return numbers;
  }
  function nearest() {  // tables and sums need exact values; float textures support nothing else
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
  }
  function set_scratches(packed) {
    rows = packed;
    if (sets.has(packed)) return;
    const kColumns = 1024, lines = Math.max(1, Math.ceil(packed.count / kColumns)), range = {};
    const table = (numbers) => {  // four 16-bit numbers per scratch
      const texture = gl.createTexture(), whole = new Uint16Array(4 * kColumns * lines);
      whole.set(numbers);
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA16UI, kColumns, lines);
      gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, kColumns, lines, gl.RGBA_INTEGER, gl.UNSIGNED_SHORT, whole);
      nearest();
      return texture;
    };
    const rows_table = table(numbers_of(packed.rows));
    const own = new Uint16Array(4 * packed.count);
    let has_own = false;
    ['width_um', 'depth_um', 'alpha'].forEach((name, i) => {
      const column = packed[name];
      range[name] = [column.min, column.max - column.min];
      if (!column.rows) return;
      has_own = true;
      numbers_of(column.rows).forEach((v, k) => { own[4 * k + i] = v; });
    });
    const own_table = table(has_own ? own : new Uint16Array(4));
    const array = gl.createVertexArray(), corners = new Uint32Array(6 * packed.count);
    for (let i = 0; i < packed.count; ++i) [0, 1, 2, 2, 1, 3].forEach((corner, k) => { corners[6 * i + k] = 4 * i + corner; });
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, corners, gl.STATIC_DRAW);
    gl.bindVertexArray(null);
    sets.set(packed, { array, range, rows_table, own_table, has_own });
  }

  function target(old, width, height, internal) {
    if (old && old.width === width && old.height === height) return old;
    if (old) { gl.deleteTexture(old.texture); gl.deleteFramebuffer(old.frame); }
    const texture = gl.createTexture(), frame = gl.createFramebuffer();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texStorage2D(gl.TEXTURE_2D, 1, internal, width, height);
    nearest();
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
    return { texture, frame, width, height };
  }

  function set_camera(places, scene, look, width, height) {
    gl.uniform2f(places.uCanvas, width, height);
    gl.uniform2f(places.uBoard, ...scene.size_mm);
    gl.uniform3f(places.uBow, ...scene.bow_mm);
    gl.uniform1i(places.uFlat, look.flat ? 1 : 0);
    if (look.flat) {
      const [x0, y0, x1, y1] = look.flat, sx = width / (x1 - x0), sy = height / (y1 - y0);
      gl.uniform4f(places.uFlatMap, -x0 * sx, -y0 * sy, sx, sy);
      return (x1 - x0) * (y1 - y0) / (width * height);
    }
    const { R, T, lens, k } = look;
    gl.uniformMatrix3fv(places.uR, true, R.flat());
    gl.uniform3f(places.uT, ...T);
    gl.uniform4f(places.uLens, ...lens);
    ['uK0', 'uK1', 'uK2'].forEach((name, i) => gl.uniform4f(places[name], ...k.slice(4 * i, 4 * i + 4)));
    const middle = scene.size_mm.map((v) => v / 2), z = R[2][0] * middle[0] + R[2][1] * middle[1] + T[2];
    const along = R[0][0] * R[1][1] - R[0][1] * R[1][0];  // foreshortening of the face
    return z * z / Math.max(0.1, Math.abs(along)) / (lens[0] * lens[1]);
  }
  function set_light(places, light, eye, lamp) {
    gl.uniform3f(places.uEye, ...eye);
    gl.uniform3f(places.uLamp, ...lamp);
    gl.uniform3f(places.uAxis, ...light.axis);
    gl.uniform1f(places.uExponent, light.falloff_exponent);
  }

  // Value of a sum that counts as 1: the pixel's own area, or less if 8 bits must represent white.
  // `before`: null, or the previous picture, to which this one is added.
  function render(scene, light, look, eye, exposure, stored, before, frame, width, height) {
    const lamp = light.at;
    sums = target(sums, width, height, format);
    gl.bindFramebuffer(gl.FRAMEBUFFER, sums.frame);
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE);
    gl.useProgram(scratches.program);
    let places = scratches.places;
    const area = set_camera(places, scene, look, width, height);
    // In 8 bits, a sum of 1 corresponds to twice white at the board's center.
    const middle = [scene.size_mm[0] / 2, scene.size_mm[1] / 2, 0];
    const far = middle.reduce((sum, v, i) => sum + (v - lamp[i]) ** 2, 0);
    const unit = area * (float_targets ? 1 : 8 * far / Math.max(1e-12, exposure * Math.max(...light.intensity)));
    set_light(places, light, eye, lamp);
    const { array, range, rows_table, own_table, has_own } = sets.get(rows);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, rows_table);
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, own_table);
    gl.uniform1i(places.uRows, 0);
    gl.uniform1i(places.uOwn, 1);
    gl.uniform1i(places.uHasOwn, has_own ? 1 : 0);
    gl.uniform4f(places.uArea, ...rows.min_mm, rows.max_mm[0] - rows.min_mm[0], rows.max_mm[1] - rows.min_mm[1]);
    gl.uniform1f(places.uLongest, rows.longest_mm);
    gl.uniform2f(places.uWidth, range.width_um[0] / 1000, range.width_um[1] / 1000);
    gl.uniform2f(places.uDepth, range.depth_um[0] / 1000, range.depth_um[1] / 1000);
    gl.uniform2f(places.uAlpha, ...range.alpha);
    gl.uniform1f(places.uPixelArea, area);
    gl.uniform1f(places.uLightUnit, unit / area);
    gl.bindVertexArray(array);
    gl.drawElements(gl.TRIANGLES, 6 * rows.count, gl.UNSIGNED_INT, 0);
    gl.disable(gl.BLEND);

    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    gl.clear(gl.COLOR_BUFFER_BIT);
    gl.useProgram(board.program);
    places = board.places;
    set_camera(places, scene, look, width, height);
    set_light(places, light, eye, lamp);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, sums.texture);
    gl.uniform1i(places.uSums, 0);
    gl.uniform1f(places.uPixelArea, area);
    gl.uniform1f(places.uLightUnit, unit / area);
    gl.uniform1f(places.uBaseAlpha, scene.material.base_alpha);
    gl.uniform3f(places.uF0, ...scene.material.f0);
    gl.uniform3f(places.uIntensity, ...light.intensity);
    gl.uniform3f(places.uAmbient, ...scene.ambient);
    gl.uniform1f(places.uExposure, exposure);
    gl.uniform1i(places.uStored, stored);
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, before || sums.texture);
    gl.uniform1i(places.uBefore, 1);
    gl.uniform1i(places.uHasBefore, before ? (float_targets ? kLinear : kRoots) : 0);
    const bent = scene.bow_mm.some((v) => v !== 0) || (!look.flat && look.k.some((v) => v !== 0));
    const grid = grids[bent ? 1 : 0];
    gl.bindVertexArray(grid.array);
    gl.drawArrays(gl.TRIANGLES, 0, grid.count);
    gl.bindVertexArray(null);
  }

  // Adds up the lights one after the other; the last pass draws into the frame.
  function render_all(scene, lights, look, eye, exposure, stored, frame, width, height) {
    let before = null;
    lights.forEach((light, i) => {
      const one = i === 0 ? scene : { ...scene, ambient: [0, 0, 0] };
      if (i === lights.length - 1) { render(one, light, look, eye, exposure, stored, before, frame, width, height); return; }
      kept[i % 2] = target(kept[i % 2], width, height, float_targets ? gl.RGBA32F : gl.RGBA8);
      render(one, light, look, eye, exposure, float_targets ? kLinear : kRoots, before, kept[i % 2].frame, width, height);
      before = kept[i % 2].texture;
    });
  }
  function draw(scene, lights, look, eye, exposure) {
    if (lost) return;
    render_all(scene, lights, look, eye, exposure, kEncoded, null, canvas.width, canvas.height);
  }
  // Null if this machine cannot measure (no float targets).
  function white(scene, lights, look, eye, width, height) {
    if (lost || !float_targets) return null;
    measure = target(measure, width, height, gl.RGBA32F);
    render_all(scene, lights, look, eye, 1, kLinear, measure.frame, width, height);
    const values = new Float32Array(4 * width * height);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.FLOAT, values);
    const lit = [];
    for (let i = 0; i < values.length; i += 4)
      for (let c = 0; c < 3; ++c) if (values[i + c] > 0) lit.push(values[i + c]);
    if (!lit.length) return 1;
    const sorted = Float32Array.from(lit).sort();
    return 1 / sorted[Math.floor(0.995 * (sorted.length - 1))];
  }
  function finish() { gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4)); }

  const info = gl.getExtension('WEBGL_debug_renderer_info');
  return {
    set_scratches, draw, white, finish,
    sums: full ? 'float' : float_targets ? 'half float' : '8 bits',
    machine: info ? gl.getParameter(info.UNMASKED_RENDERER_WEBGL) : gl.getParameter(gl.RENDERER),
    on_lost(again) {
      canvas.addEventListener('webglcontextlost', (event) => { lost = true; event.preventDefault(); });
      canvas.addEventListener('webglcontextrestored', () => {
        lost = false; build(); const packed = rows; rows = null; set_scratches(packed); again();
      });
    },
  };
}
