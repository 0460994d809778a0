// SPDX-License-Identifier: GPL-3.0-or-later
// The picture: grains, subdomains, contacts, modes on a canvas. Shapes are in metres and drawn through the transform of
// the view, so that moving it costs no new shapes.

// What a picture has: x, y, radius; holders(i), the subdomains of a grain; colours of subdomains; `special(i)` for
// grains of a boundary; walls as [x, y, nx, ny]; lines: groups {path, width, dash, colour,
// fine, plain}, of which fine and plain ones are left out where grains are small; arrows: {x, y, u, v}.
function createScene(canvas, picture) {
  const context = canvas.getContext('2d');
  const view = {x: 0, y: 0, scale: 1};
  const scene =
      {picture, view, chosen: -1, layers: {hatching: true, contacts: true, labels: true, mode: true}, amplitude: 1};
  let groups = null, shapes = null, patterns = null, asked = false;

  function bounds() {
    let [left, bottom, right, top] = [Infinity, Infinity, -Infinity, -Infinity];
    for (let i = 0; i < picture.x.length; ++i) {
      left = Math.min(left, picture.x[i] - picture.radius[i]);
      right = Math.max(right, picture.x[i] + picture.radius[i]);
      bottom = Math.min(bottom, picture.y[i] - picture.radius[i]);
      top = Math.max(top, picture.y[i] + picture.radius[i]);
    }
    return {left, bottom, right, top};
  }

  function meanRadius() {
    let sum = 0;
    for (const r of picture.radius) sum += r;
    return sum / picture.radius.length;
  }
  scene.meanRadius = meanRadius();

  const width = () => canvas.clientWidth, height = () => canvas.clientHeight;
  scene.toScreen = (x, y) => [width() / 2 + (x - view.x) * view.scale, height() / 2 - (y - view.y) * view.scale];
  scene.toWorld = (px, py) => [view.x + (px - width() / 2) / view.scale, view.y - (py - height() / 2) / view.scale];

  // A flat packing gets a flat picture.
  scene.whole = () => {
    const box = bounds(), tall = (width() * (box.top - box.bottom)) / (box.right - box.left) / 0.94 + 8;
    canvas.style.height = `clamp(13rem, ${Math.round(tall)}px, min(62vh, 46rem))`;
    view.x = (box.left + box.right) / 2;
    view.y = (box.bottom + box.top) / 2;
    view.scale = 0.94 * Math.min(width() / (box.right - box.left), height() / (box.top - box.bottom));
    scene.home = view.scale;
    scene.fitted = true;
    scene.draw();
  };
  scene.zoom = (factor, px = width() / 2, py = height() / 2) => {
    const [x, y] = scene.toWorld(px, py);
    view.scale = Math.min(Math.max(view.scale * factor, scene.home / 4), 400 / scene.meanRadius);
    view.x = x - (px - width() / 2) / view.scale;
    view.y = y + (py - height() / 2) / view.scale;
    scene.fitted = false;
    scene.draw();
  };
  scene.move = (dx, dy) => {
    view.x -= dx / view.scale;
    view.y += dy / view.scale;
    scene.fitted = false;
    scene.draw();
  };
  scene.grainAt = (px, py) => {
    const [x, y] = scene.toWorld(px, py);
    for (let i = 0; i < picture.x.length; ++i)
      if ((picture.x[i] - x) ** 2 + (picture.y[i] - y) ** 2 <= picture.radius[i] ** 2) return i;
    return -1;
  };
  scene.changed = () => {
    groups = shapes = null;
    scene.draw();
  };
  scene.draw = () => {
    if (asked) return;
    asked = true;
    requestAnimationFrame(() => {
      asked = false;
      paint();
    });
  };

  // One hatching for each colour: none, three directions, dots, crossed.
  function hatchings() {
    return palette.map((_, kind) => {
      if (kind === 0) return null;
      const tile = document.createElement('canvas');
      tile.width = tile.height = 16;
      const c = tile.getContext('2d');
      c.strokeStyle = c.fillStyle = kind === 4 ? 'rgba(255,255,255,.65)' : 'rgba(0,0,0,.38)';
      c.lineWidth = 2;
      const line = (...p) => {
        c.beginPath();
        c.moveTo(p[0], p[1]);
        c.lineTo(p[2], p[3]);
        c.stroke();
      };
      if (kind === 1 || kind === 5) {
        line(-4, 20, 20, -4);
        line(-4, 4, 4, -4);
        line(12, 20, 20, 12);
      }
      if (kind === 4 || kind === 5) {
        line(-4, -4, 20, 20);
        line(12, -4, 20, 4);
        line(-4, 12, 4, 20);
      }
      if (kind === 3) line(0, 8, 16, 8);
      if (kind === 2) {
        c.beginPath();
        c.arc(8, 8, 2, 0, 7);
        c.fill();
      }
      return context.createPattern(tile, 'repeat');
    });
  }

  // Grains by what they look like: of one colour, shared, or of no subdomain. And where the labels of subdomains go.
  function makeGroups() {
    const single = palette.map(() => []), shared = [], others = [];
    const labels = picture.colours.map((_, e) => ({e, x: 0, y: 0, grains: 0}));
    for (let i = 0; i < picture.x.length; ++i) {
      const held = picture.holders(i);
      if (picture.special(i) || held.length === 0)
        others.push(i);
      else if (held.length === 1)
        single[picture.colours[held[0]]].push(i);
      else
        shared.push(i);
      for (const e of held) {
        labels[e].x += picture.x[i];
        labels[e].y += picture.y[i];
        labels[e].grains += 1;
      }
    }
    return {single, shared, others, labels: labels.filter((l) => l.grains > 0).sort((a, b) => b.grains - a.grains)};
  }

  function circle(path, i) {
    path.moveTo(picture.x[i] + picture.radius[i], picture.y[i]);
    path.arc(picture.x[i], picture.y[i], picture.radius[i], 0, 2 * Math.PI);
  }

  // Shapes of the grains that `shown` says to draw: one for each colour, rims, shared grains.
  function makeShapes(shown) {
    const fills = palette.map(() => new Path2D()), rims = new Path2D(), shared = new Path2D(), others = new Path2D();
    groups.single.forEach((numbers, c) => {
      for (const i of numbers.filter(shown)) [fills[c], rims].forEach((path) => circle(path, i));
    });
    for (const i of groups.others.filter(shown)) circle(others, i);
    for (const i of groups.shared.filter(shown)) {
      const held = picture.holders(i);
      held.forEach((e, k) => slice(fills[picture.colours[e]], i, k, held.length));
      circle(shared, i);
    }
    return {fills, rims, shared, others};
  }

  // Those of many grains are made anew for what is in sight, which is little where they are large enough to be circles.
  function shapesInSight() {
    if (picture.x.length <= 20000) return (shapes ??= makeShapes(() => true));
    const [left, top] = scene.toWorld(-50, -50), [right, bottom] = scene.toWorld(width() + 50, height() + 50);
    return makeShapes(
        (i) => picture.x[i] > left && picture.x[i] < right && picture.y[i] > bottom && picture.y[i] < top);
  }

  // Grains of some pixels are squares of the same area: a browser draws a hundred thousand of them at once.
  function paintSquares() {
    const paint = (numbers, colour) => {
      context.fillStyle = colour;
      for (const i of numbers) {
        const half = 0.886 * picture.radius[i];
        context.fillRect(picture.x[i] - half, picture.y[i] - half, 2 * half, 2 * half);
      }
    };
    groups.single.forEach((numbers, c) => paint(numbers, palette[c]));
    paint(groups.others, '#d8d8d8');
    paint(groups.shared, ink);
  }

  function slice(path, i, k, parts) {
    const from = Math.PI / 2 + (2 * Math.PI * k) / parts, to = from + (2 * Math.PI) / parts;
    path.moveTo(picture.x[i], picture.y[i]);
    path.arc(picture.x[i], picture.y[i], picture.radius[i], from, to);
    path.closePath();
  }

  function paintGrains(pixel) {
    const radius = scene.meanRadius / pixel;
    if (radius < 2) return paintSquares();
    const {fills, rims, shared, others} = shapesInSight();
    fills.forEach((path, c) => {
      context.fillStyle = palette[c];
      context.fill(path);
      if (!scene.layers.hatching || radius < 5 || !patterns[c]) return;
      patterns[c].setTransform(new DOMMatrix().scale(pixel / 1.6));
      context.fillStyle = patterns[c];
      context.fill(path);
    });
    context.fillStyle = '#d8d8d8';
    context.fill(others);
    context.strokeStyle = ink;
    context.lineWidth = Math.min(1, radius / 8) * pixel;
    context.stroke(rims);
    context.stroke(others);
    context.lineWidth = Math.max(0.8, Math.min(3, radius / 4)) * pixel;
    context.stroke(shared);
  }

  function paintWalls(pixel) {
    const far = (width() + height()) * pixel;
    context.lineWidth = 3 * pixel;
    context.strokeStyle = ink;
    for (const [x, y, nx, ny] of picture.walls ?? []) {
      // The part of the line that is in sight.
      const along = (view.x - x) * -ny + (view.y - y) * nx;
      const [cx, cy] = [x - ny * along, y + nx * along];
      context.beginPath();
      context.moveTo(cx + ny * far, cy - nx * far);
      context.lineTo(cx - ny * far, cy + nx * far);
      context.stroke();
    }
  }

  function paintLines(pixel) {
    const radius = scene.meanRadius / pixel;
    for (const {path, width: thickness, dash, colour, fine, plain} of picture.lines) {
      if (radius < (fine ? 4 : plain ? 2 : 0)) continue;
      const broad = fine ? 1 : Math.max(0.7, thickness * Math.min(radius, 14) * 0.75);
      context.setLineDash((dash ?? []).map((d) => d * pixel));
      if (broad > 2) {  // a light edge sets a chain off from the grains
        context.strokeStyle = 'rgba(255,255,255,.75)';
        context.lineWidth = (broad + 2) * pixel;
        context.stroke(path);
      }
      context.strokeStyle = colour;
      context.lineWidth = broad * pixel;
      context.stroke(path);
    }
    context.setLineDash([]);
  }

  function paintLabels() {
    context.font = 'bold 15px system-ui, sans-serif';
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    const taken = [];  // a label that would cover another one is left out
    for (const {e, x, y, grains} of groups.labels) {
      const [px, py] = scene.toScreen(x / grains, y / grains);
      if (px < 0 || py < 0 || px > width() || py > height()) continue;
      const half = context.measureText(e).width / 2 + 5;
      if (taken.some((one) => Math.abs(one.px - px) < one.half + half + 2 && Math.abs(one.py - py) < 22)) continue;
      taken.push({px, py, half});
      context.fillStyle = 'rgba(255,255,255,.9)';
      context.fillRect(px - half, py - 10, 2 * half, 20);
      context.strokeStyle = ink;
      context.lineWidth = 1;
      context.strokeRect(px - half, py - 10, 2 * half, 20);
      context.fillStyle = ink;
      context.fillText(e, px, py + 1);
    }
  }

  function paintChosen() {
    const i = scene.chosen;
    if (i < 0) return;
    const [px, py] = scene.toScreen(picture.x[i], picture.y[i]);
    for (const [colour, thick] of [['#ffffff', 6], ['#0050a0', 3]]) {
      context.beginPath();
      context.arc(px, py, Math.max(picture.radius[i] * view.scale, 4) + 3, 0, 7);
      context.strokeStyle = colour;
      context.lineWidth = thick;
      context.stroke();
    }
  }

  function paint() {
    const ratio = window.devicePixelRatio || 1, pixel = 1 / view.scale;
    if (canvas.width !== Math.round(width() * ratio) || canvas.height !== Math.round(height() * ratio)) {
      canvas.width = Math.round(width() * ratio);
      canvas.height = Math.round(height() * ratio);
    }
    patterns ??= hatchings();
    groups ??= makeGroups();
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width(), height());
    const [ox, oy] = scene.toScreen(0, 0);
    context.transform(view.scale, 0, 0, -view.scale, ox, oy);
    paintGrains(pixel);
    paintWalls(pixel);
    if (scene.layers.contacts) paintLines(pixel);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    if (scene.layers.mode && picture.arrows) paintArrows(scene, context);
    if (scene.layers.labels && picture.colours.length > 1) paintLabels();
    paintChosen();
    canvas.dataset.painted = Number(canvas.dataset.painted ?? 0) + 1;
  }
  return scene;
}
