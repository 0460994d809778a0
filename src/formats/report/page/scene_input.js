// SPDX-License-Identifier: GPL-3.0-or-later
// The picture by mouse, touch and keyboard, and the switches of what it shows.

// `describe(i)`: what a grain is, in words.
function listen(scene, canvas, describe) {
  const pointers = new Map();
  const hint = byId('hint');
  let travelled = 0;

  const place = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  const choose = (i) => {
    scene.chosen = i;
    byId('grain').textContent = i < 0 ? '' : describe(i);
    scene.draw();
  };
  const show = (i, px, py) => {
    hint.hidden = i < 0;
    if (i < 0) return;
    hint.textContent = describe(i);
    hint.style.left = Math.max(0, Math.min(px + 14, canvas.clientWidth - hint.offsetWidth)) + 'px';
    hint.style.top = Math.max(0, py - hint.offsetHeight - 8) + 'px';
  };

  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, place(event));
    travelled = 0;
    show(-1);
  });
  canvas.addEventListener('pointermove', (event) => {
    const [px, py] = place(event), before = pointers.get(event.pointerId);
    if (!before) return show(scene.grainAt(px, py), px, py);
    const others = [...pointers].filter(([id]) => id !== event.pointerId).map(([, p]) => p);
    if (others.length === 1) {  // two fingers: their distance is the scale, their middle moves
      const [ox, oy] = others[0];
      const factor = Math.hypot(px - ox, py - oy) / Math.max(1, Math.hypot(before[0] - ox, before[1] - oy));
      scene.move((px - before[0]) / 2, (py - before[1]) / 2);
      scene.zoom(factor, (px + ox) / 2, (py + oy) / 2);
    } else {
      (event.shiftKey ? scene.move : scene.turn)(px - before[0], py - before[1]);
    }
    travelled += Math.hypot(px - before[0], py - before[1]);
    pointers.set(event.pointerId, [px, py]);
  });
  for (const end of ['pointerup', 'pointercancel'])
    canvas.addEventListener(end, (event) => {
      pointers.delete(event.pointerId);
      if (end === 'pointerup' && travelled < 4) choose(scene.grainAt(...place(event)));
    });
  canvas.addEventListener('pointerleave', () => show(-1));
  // A page that is scrolled past the picture goes on scrolling.
  canvas.addEventListener('wheel', (event) => {
    if (!event.ctrlKey && document.activeElement !== canvas) return;
    event.preventDefault();
    scene.zoom(Math.exp(-event.deltaY / 400), ...place(event));
  }, {passive: false});

  const grains = scene.picture.x.length, reveal = (i) => {
    const [px, py] = scene.toScreen(...scene.placeOf(i));
    if (px < 0 || py < 0 || px > canvas.clientWidth || py > canvas.clientHeight)
      [scene.view.x, scene.view.y] = scene.placeOf(i);
    choose(i);
  };
  // Arrow keys go where the camera is to look: in space it turns, and moves with Shift.
  const step = (dx, dy) => (event) => (scene.camera.space && !event.shiftKey ? scene.turn : scene.move)(dx, dy);
  const keys = {
    ArrowLeft: step(40, 0),
    ArrowRight: step(-40, 0),
    ArrowUp: step(0, 40),
    ArrowDown: step(0, -40),
    '+': () => scene.zoom(1.3),
    '=': () => scene.zoom(1.3),
    '-': () => scene.zoom(1 / 1.3),
    0: () => scene.reset(),
    Escape: () => choose(-1),
    n: () => reveal((scene.chosen + 1) % grains),
    p: () => reveal((Math.max(scene.chosen, 0) + grains - 1) % grains),
  };
  canvas.addEventListener('keydown', (event) => {
    const act = keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!act || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    act(event);
  });
  byId('zoom-in').addEventListener('click', () => scene.zoom(1.4));
  byId('zoom-out').addEventListener('click', () => scene.zoom(1 / 1.4));
  byId('whole').addEventListener('click', scene.reset);
  if (scene.camera.space)
    byId('scene-help').textContent = 'Drag with the mouse or a finger to turn, with Shift or two fingers to move, pinch ' +
        'to zoom, or turn the wheel with Ctrl or after a click into the picture; touch a grain to see what it is. With ' +
        'the picture in focus: arrow keys turn, with Shift they move, + and − zoom, 0 shows the whole from where it was ' +
        'seen first, N and P go to the next and previous grain.';
  new ResizeObserver(() => (scene.fitted ? scene.whole() : scene.draw())).observe(canvas);
  return {choose};
}

function addSwitch(scene, layer, text) {
  const box = element('input', {type: 'checkbox', id: 'layer-' + layer});
  box.checked = scene.layers[layer];
  box.addEventListener('change', () => {
    scene.layers[layer] = box.checked;
    scene.draw();
  });
  byId('layers').append(element('label', {}, box, text));
}

// A slider beside the switches, which says its value in words.
function addRange(scene, id, text, range, words, apply) {
  const slider = element('input', {type: 'range', id, ...range, 'aria-valuetext': words(range.value)});
  slider.addEventListener('input', () => {
    apply(Number(slider.value));
    slider.setAttribute('aria-valuetext', words(Number(slider.value)));
    scene.draw();
  });
  byId('layers').append(element('label', {}, text, slider));
}

// What lets one look into a packing in space.
function addSpaceTools(scene, size) {
  const {camera} = scene, percent = (value) => value + ' %';
  if (!camera.space) return;
  scene.size = size / 100;
  if (scene.picture.colours.length > 1) addSwitch(scene, 'inner', 'grains of one subdomain');
  addRange(scene, 'grain-size', 'size of grains', {min: 10, max: 100, step: 5, value: size}, percent, (value) => {
    scene.size = value / 100;
  });
  addRange(scene, 'cut', 'cut away from the front', {min: 0, max: 95, step: 5, value: 0}, percent, (value) => {
    scene.cut = value / 100;
  });
}

// A sample in the legend: `draw` are elements of SVG within 35 x 18.
function addToLegend(text, ...draw) {
  const sample = element('svg', {viewBox: '0 0 35 18', 'aria-hidden': 'true'}, ...draw);
  const entry = element('span', {}, sample, text);
  byId('legend').append(entry);
  return entry;
}

// Lines of contacts in groups of equal thickness, which are drawn at once. `ends(k)`: x, y, z of both ends; `size(k)`:
// the thickness within 0 to 1.
function lineGroups(numbers, ends, size, style) {
  const classes = 8, groups = new Map();
  for (const k of numbers) {
    const c = Math.max(1, Math.ceil(classes * Math.min(1, size(k))));
    if (!groups.has(c)) groups.set(c, {segments: [], width: c / classes, ...style});
    groups.get(c).segments.push(...ends(k));
  }
  return [...groups.values()];
}
