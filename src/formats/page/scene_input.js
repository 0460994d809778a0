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
      scene.move(px - before[0], py - before[1]);
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
    const [px, py] = scene.toScreen(scene.picture.x[i], scene.picture.y[i]);
    if (px < 0 || py < 0 || px > canvas.clientWidth || py > canvas.clientHeight)
      [scene.view.x, scene.view.y] = [scene.picture.x[i], scene.picture.y[i]];
    choose(i);
  };
  const keys = {
    ArrowLeft: () => scene.move(40, 0),
    ArrowRight: () => scene.move(-40, 0),
    ArrowUp: () => scene.move(0, 40),
    ArrowDown: () => scene.move(0, -40),
    '+': () => scene.zoom(1.3),
    '=': () => scene.zoom(1.3),
    '-': () => scene.zoom(1 / 1.3),
    0: () => scene.whole(),
    Escape: () => choose(-1),
    n: () => reveal((scene.chosen + 1) % grains),
    p: () => reveal((Math.max(scene.chosen, 0) + grains - 1) % grains),
  };
  canvas.addEventListener('keydown', (event) => {
    const act = keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!act || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    act();
  });
  byId('zoom-in').addEventListener('click', () => scene.zoom(1.4));
  byId('zoom-out').addEventListener('click', () => scene.zoom(1 / 1.4));
  byId('whole').addEventListener('click', scene.whole);
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

// A sample in the legend: `draw` are elements of SVG within 35 x 18.
function addToLegend(text, ...draw) {
  const sample = element('svg', {viewBox: '0 0 35 18', 'aria-hidden': 'true'}, ...draw);
  const entry = element('span', {}, sample, text);
  byId('legend').append(entry);
  return entry;
}

// Lines of contacts in groups of equal thickness, which are drawn at once. `ends(k)`: [x1, y1, x2, y2], `size(k)`: the
// thickness within 0 to 1.
function lineGroups(numbers, ends, size, style) {
  const classes = 8, groups = new Map();
  for (const k of numbers) {
    const c = Math.max(1, Math.ceil(classes * Math.min(1, size(k))));
    if (!groups.has(c)) groups.set(c, {path: new Path2D(), width: c / classes, ...style});
    const path = groups.get(c).path, [x1, y1, x2, y2] = ends(k);
    path.moveTo(x1, y1);
    path.lineTo(x2, y2);
  }
  return [...groups.values()];
}
