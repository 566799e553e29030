// tools/report/page.js - interaction of a report's page. It wipes between two pictures of one place, and zooms and pans all
// pictures of that place together, by pointer, touch and keyboard. It unfolds everything for paper.
// It needs only the markup of tools/report/pictures.h: .compare contains figures, each with data-name; the .compares
// around them name their place in data-place. It uses no network, and sets inline styles through the DOM only.
'use strict';

(() => {
  const kMostZoom = 16;
  document.documentElement.classList.add('js');

  // Visible part of each place: the window's center as a fraction of the picture, and the scale.
  const places = new Map();

  function placeOf(name) {
    if (!places.has(name)) places.set(name, { x: 0.5, y: 0.5, scale: 1, images: [], stages: [] });
    return places.get(name);
  }

  function draw(place) {
    const { x, y, scale } = place;
    const transform = scale === 1 ? 'none'
      : `translate(${100 * (0.5 - scale * x)}%, ${100 * (0.5 - scale * y)}%) scale(${scale})`;
    for (const image of place.images) {
      image.style.transform = transform;
      image.classList.toggle('crisp', scale >= 2);
    }
    for (const stage of place.stages) stage.onZoom(scale);
  }

  function look(place, x, y, scale) {
    place.scale = Math.min(kMostZoom, Math.max(1, scale));
    const margin = 0.5 / place.scale;  // the picture fills the window
    place.x = Math.min(1 - margin, Math.max(margin, x));
    place.y = Math.min(1 - margin, Math.max(margin, y));
    draw(place);
  }

  // Zooms about the point (u, v), in fractions of the window.
  function zoomAt(place, factor, u = 0.5, v = 0.5) {
    const scale = Math.min(kMostZoom, Math.max(1, place.scale * factor));
    look(place, place.x + (u - 0.5) * (1 / place.scale - 1 / scale), place.y + (v - 0.5) * (1 / place.scale - 1 / scale),
         scale);
  }

  function element(name, classes, properties = {}) {
    const made = document.createElement(name);
    if (classes) made.className = classes;
    for (const [key, value] of Object.entries(properties)) {
      if (key.startsWith('aria-') || key === 'role') made.setAttribute(key, value);
      else made[key] = value;
    }
    return made;
  }

  function buildStage(compare, place) {
    const figures = [...compare.querySelectorAll('figure')];
    const pictures = figures.map((figure) => figure.querySelector('img'));
    const names = figures.map((figure) => figure.dataset.name);
    const title = compare.dataset.title || '';
    const stage = element('div', 'stage', { tabIndex: 0, role: 'group' });
    stage.setAttribute('aria-label',
                       `${title}: two pictures with a wipe between them. Left and right move the wipe; plus, minus and 0 zoom; ` +
                       'zoomed in, arrows move the picture.');
    stage.style.aspectRatio = `${pictures[0].getAttribute('width')} / ${pictures[0].getAttribute('height')}`;

    const layers = ['left', 'right'].map((side) => {
      const layer = element('div', `layer ${side}`), image = element('img', '', { draggable: false });
      const name = element('span', `name ${side}`);
      layer.append(image);
      stage.append(layer);
      place.images.push(image);
      return { side, layer, image, name, index: Number(compare.dataset[side] || 0) };
    });
    const edge = element('div', 'edge');
    stage.append(layers[0].name, layers[1].name, edge);

    const controls = element('div', 'controls');
    const range = element('input', 'wipe', { type: 'range', min: '0', max: '100', value: '50' });
    const selects = layers.map((layer) => {
      const select = element('select', layer.side, { 'aria-label': `${title}: picture on the ${layer.side}` });
      names.forEach((name, index) => select.append(element('option', '', { textContent: name, value: String(index) })));
      select.addEventListener('change', () => choose(layer, Number(select.value)));
      return select;
    });
    const zoom = element('div', 'zoom');
    for (const [text, label, act] of [['all', 'Show the whole picture', () => look(place, 0.5, 0.5, 1)],
                                      ['−', 'Zoom out', () => zoomAt(place, 1 / 1.6)], ['+', 'Zoom in', () => zoomAt(place, 1.6)]]) {
      const button = element('button', text === 'all' ? 'all' : '', { type: 'button', textContent: text, title: label });
      button.setAttribute('aria-label', label);
      button.addEventListener('click', act);
      for (const type of ['pointerdown', 'dblclick']) button.addEventListener(type, (event) => event.stopPropagation());
      button.addEventListener('keydown', (event) => event.stopPropagation());
      zoom.append(button);
    }
    stage.append(zoom);
    controls.append(range, ...selects);

    function wipe(percent) {
      range.value = String(Math.min(100, Math.max(0, percent)));
      const at = Number(range.value);
      layers[1].layer.style.clipPath = `inset(0 0 0 ${at}%)`;
      edge.style.left = `${at}%`;
      range.setAttribute('aria-valuetext', `${Math.round(at)} % ${names[layers[0].index]}, the rest ${names[layers[1].index]}`);
    }

    function choose(layer, index) {
      layer.index = index;
      layer.image.src = pictures[index].src;
      layer.image.alt = pictures[index].alt;
      layer.name.textContent = names[index];
      selects[layers.indexOf(layer)].value = String(index);
      figures.forEach((figure, i) => figure.classList.toggle(`on-${layer.side}`, i === index));
      range.setAttribute('aria-label', `${title}: wipe between ${names[layers[0].index]} and ${names[layers[1].index]}`);
      wipe(Number(range.value));
    }

    range.addEventListener('input', () => wipe(Number(range.value)));
    figures.forEach((figure, index) => figure.addEventListener('click', () => choose(layers[1], index)));
    place.stages.push({ onZoom: (scale) => stage.classList.toggle('zoomed', scale > 1) });
    pointers(stage, edge, place, wipe);
    keys(stage, place, (by) => wipe(Number(range.value) + by));
    compare.insertBefore(stage, figures[0].parentElement);
    compare.insertBefore(controls, figures[0].parentElement);
    layers.forEach((layer) => choose(layer, Math.min(layer.index, names.length - 1)));
  }

  function keys(stage, place, wipeBy) {
    stage.addEventListener('keydown', (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      const step = 0.1 / place.scale;
      const move = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
      if (event.key === '+' || event.key === '=') zoomAt(place, 1.6);
      else if (event.key === '-') zoomAt(place, 1 / 1.6);
      else if (event.key === '0') look(place, 0.5, 0.5, 1);
      else if (move && place.scale > 1) look(place, place.x + move[0] * step, place.y + move[1] * step, place.scale);
      else if (move && move[0] !== 0) wipeBy(4 * move[0]);
      else return;
      event.preventDefault();
    });
  }

  // One finger or the mouse moves the wipe, or a zoomed picture outside of the wipe's handle. Two fingers zoom.
  function pointers(stage, edge, place, wipe) {
    const down = new Map();
    let onEdge = false, spread = 0;
    const fraction = (event) => {
      const box = stage.getBoundingClientRect();
      return { u: (event.clientX - box.left) / box.width, v: (event.clientY - box.top) / box.height };
    };
    stage.addEventListener('pointerdown', (event) => {
      if (event.button !== 0) return;
      stage.setPointerCapture(event.pointerId);
      down.set(event.pointerId, fraction(event));
      onEdge = event.target === edge || place.scale === 1;
      spread = 0;
      if (onEdge && down.size === 1 && event.pointerType === 'mouse') wipe(100 * fraction(event).u);
    });
    stage.addEventListener('pointermove', (event) => {
      if (!down.has(event.pointerId)) return;
      const before = down.get(event.pointerId), now = fraction(event);
      down.set(event.pointerId, now);
      if (down.size === 2) {
        const [a, b] = [...down.values()];
        const apart = Math.hypot(a.u - b.u, a.v - b.v);
        if (spread > 0 && apart > 0) zoomAt(place, apart / spread, (a.u + b.u) / 2, (a.v + b.v) / 2);
        spread = apart;
      } else if (onEdge) {
        wipe(100 * now.u);
      } else {
        look(place, place.x - (now.u - before.u) / place.scale, place.y - (now.v - before.v) / place.scale, place.scale);
      }
    });
    for (const type of ['pointerup', 'pointercancel'])
      stage.addEventListener(type, (event) => { down.delete(event.pointerId); spread = 0; });
    stage.addEventListener('dblclick', (event) => {
      const { u, v } = fraction(event);
      if (place.scale > 1) look(place, 0.5, 0.5, 1);
      else zoomAt(place, 4, u, v);
    });
    stage.addEventListener('wheel', (event) => {
      if (!event.ctrlKey) return;  // the wheel alone scrolls the page
      event.preventDefault();
      const { u, v } = fraction(event);
      zoomAt(place, Math.exp(-event.deltaY / 200), u, v);
    }, { passive: false });
  }

  for (const compares of document.querySelectorAll('.compares')) {
    const place = placeOf(compares.dataset.place || '');
    for (const compare of compares.querySelectorAll('.compare')) {
      place.images.push(...compare.querySelectorAll('.figures img'));
      if (compare.querySelectorAll('figure').length > 1) buildStage(compare, place);
    }
  }

  const stages = document.querySelector('.compares:has(.stage)');
  if (stages)
    stages.after(element('p', 'soft hint', {
      textContent: 'Drag across a picture, or use the arrow keys, to wipe. Plus and minus, a double click or two fingers zoom ' +
        'all pictures of the board together.',
    }));

  // Paper shows all folded parts.
  let folded = [];
  window.addEventListener('beforeprint', () => {
    folded = [...document.querySelectorAll('details:not([open])')];
    for (const part of folded) part.open = true;
  });
  window.addEventListener('afterprint', () => { for (const part of folded) part.open = false; });
})();
