// SPDX-License-Identifier: GPL-3.0-or-later
// The picture: grains, subdomains, contacts, modes on a canvas, as a camera sees them, in layers from far to near. The
// plane is one layer. Shapes are in metres of the picture and drawn through the transform of the view, so that moving
// it costs no new shapes; turning the camera does.

// What a picture has: space; x, y, z, radius; holders(i), the subdomains of a grain; colours of subdomains;
// `special(i)` for grains of a boundary; walls as [x, y, nx, ny], circles with a radius behind, in space [x, y, z, nx,
// ny, nz, radius], cylinders with ends with half their length behind, and planks [x, y, nx, ny, radius, half length],
// in space [x, y, z, nx, ny, nz, radius, ax, ay, az, half length, half width]; lines: groups {segments, width, dash,
// colour, fine, plain}, of which fine and plain ones are left out where grains are small; arrows: {x, y, z, u, v, w}.
function createScene(canvas, picture) {
  const context = canvas.getContext('2d'), camera = createCamera(picture.space);
  const view = {x: 0, y: 0, scale: 1};
  const scene = {
    picture,
    view,
    camera,
    chosen: -1,
    layers: {hatching: true, contacts: true, labels: true, mode: true, inner: true},
    amplitude: 1,
    size: 1,  // of grains as they are drawn, times their own
    cut: 0    // part of the depth that is cut away
  };
  const plates = new WeakMap();  // paths of planks in space
  const plankFill = 'rgba(84,84,84,.3)', plateFill = 'rgba(0,60,120,.07)';
  const isPlank = (wall) => wall.length > 8;  // in space
  let looks = null, seen = null, shapes = null, patterns = null, stamps = null, asked = false;

  function meanRadius() {
    let sum = 0;
    for (const r of picture.radius) sum += r;
    return sum / picture.radius.length;
  }
  scene.meanRadius = meanRadius();

  function boxOf(...places) {
    const low = places.map(() => Infinity), high = places.map(() => -Infinity);
    places.forEach((values, k) => {
      for (let i = 0; i < values.length; ++i) {
        low[k] = Math.min(low[k], values[i] - picture.radius[i]);
        high[k] = Math.max(high[k], values[i] + picture.radius[i]);
      }
    });
    return [low, high];
  }
  const [low, high] = boxOf(picture.x, picture.y, picture.z);
  const edges = camera.space ? edgesOf(low, high) : [];  // of the box around all grains at first
  camera.aim(low, high);

  // Where the camera sees every grain, and in which order.
  function look() {
    const n = picture.x.length, [u, v, size, near] = [0, 1, 2, 3].map(() => new Float32Array(n));
    let [lowest, highest] = [Infinity, -Infinity];
    for (let i = 0; i < n; ++i) {
      const [right, up, towards, scale] = camera.project(picture.x[i], picture.y[i], picture.z[i]);
      [u[i], v[i], size[i], near[i]] = [right, up, scale * picture.radius[i], towards];
      [lowest, highest] = [Math.min(lowest, towards), Math.max(highest, towards)];
    }
    const order = fromFarToNear(near, lowest, highest), layerAt = (place) => {
      const layer = Math.floor((camera.layers * (place - lowest)) / (highest - lowest || 1));
      return Math.max(0, Math.min(camera.layers - 1, layer));
    };
    // Those of layer k are order[starts[k]] up to order[starts[k + 1]].
    const starts = new Uint32Array(camera.layers + 1);
    for (let i = 0; i < n; ++i) ++starts[layerAt(near[i]) + 1];
    for (let k = 0; k < camera.layers; ++k) starts[k + 1] += starts[k];
    return {u, v, size, near, order, starts, layerAt};
  }
  const sight = () => (seen ??= look());
  const shownLayers = () => Math.max(1, Math.round(camera.layers * (1 - scene.cut)));

  const width = () => canvas.clientWidth, height = () => canvas.clientHeight;
  scene.toScreen = (u, v) => [width() / 2 + (u - view.x) * view.scale, height() / 2 - (v - view.y) * view.scale];
  scene.toView = (px, py) => [view.x + (px - width() / 2) / view.scale, view.y - (py - height() / 2) / view.scale];
  scene.placeOf = (i) => [sight().u[i], sight().v[i]];

  // Points of planks, as far as they are near the grains: the picture is to show them, too.
  function endsOfPlanks() {
    const margin = 0.04 * Math.hypot(...high.map((value, k) => value - low[k]));
    const near = (value, k) => Math.max(low[k] - margin, Math.min(high[k] + margin, value));
    return (picture.walls ?? []).flatMap((wall) => {
      if (isPlank(wall)) return plateOf(wall, low, high).lines.map(([point]) => point);
      const [x, y, nx, ny, radius, half] = wall;
      if (camera.space || !radius) return [];
      if (!half) return [[-1, -1], [1, 1]].map(([s, t]) => [near(x + s * radius, 0), near(y + t * radius, 1), 0]);
      return [[half, radius], [half, -radius], [-half, radius], [-half, -radius]].map(
          ([s, t]) => [near(x + s * ny + t * nx, 0), near(y - s * nx + t * ny, 1), 0]);
    });
  }
  // A flat packing gets a flat picture.
  scene.whole = () => {
    const {u, v, size} = sight(), far = (values, way) => {
      let end = -Infinity;
      for (let i = 0; i < values.length; ++i) end = Math.max(end, way * values[i] + size[i]);
      return way * end;
    };
    const box = {left: far(u, -1), right: far(u, 1), bottom: far(v, -1), top: far(v, 1)};
    for (const corner of [...edges.flat(), ...endsOfPlanks()]) {
      const [right, up] = camera.project(...corner);
      [box.left, box.right] = [Math.min(box.left, right), Math.max(box.right, right)];
      [box.bottom, box.top] = [Math.min(box.bottom, up), Math.max(box.top, up)];
    }
    const tall = (width() * (box.top - box.bottom)) / (box.right - box.left) / 0.94 + 8;
    canvas.style.height = `clamp(${camera.space ? 20 : 13}rem, ${Math.round(tall)}px, min(62vh, 46rem))`;
    view.x = (box.left + box.right) / 2;
    view.y = (box.bottom + box.top) / 2;
    view.scale = 0.94 * Math.min(width() / (box.right - box.left), height() / (box.top - box.bottom));
    scene.home = view.scale;
    scene.fitted = true;
    scene.draw();
  };
  scene.reset = () => {
    camera.home();
    seen = shapes = null;
    scene.whole();
  };
  scene.zoom = (factor, px = width() / 2, py = height() / 2) => {
    const [x, y] = scene.toView(px, py);
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
  // Pixels to the right and down: what is seen goes along.
  scene.turn = (dx, dy) => {
    if (!camera.space) return scene.move(dx, dy);
    camera.turn(camera.azimuth - 0.4 * dx, camera.elevation + 0.4 * dy);
    seen = shapes = null;
    hurry();
    scene.draw();
  };
  // While many grains turn they are squares without contacts and arrows.
  let resting = 0, hasty = false;
  function hurry() {
    hasty = picture.x.length > 3000;
    clearTimeout(resting);
    if (hasty)
      resting = setTimeout(() => {
        hasty = false;
        scene.draw();
      }, 250);
  }
  const drawn = (i) => scene.layers.inner || looks === null || looks.list[looks.of[i]].length > 1;
  scene.grainAt = (px, py) => {
    const [x, y] = scene.toView(px, py), {u, v, size, near, layerAt} = sight();
    let found = -1;
    for (let i = 0; i < u.length; ++i)
      if ((u[i] - x) ** 2 + (v[i] - y) ** 2 <= (scene.size * size[i]) ** 2 && drawn(i) &&
          (found < 0 || near[i] > near[found]) && layerAt(near[i]) < shownLayers())
        found = i;
    return found;
  };
  scene.changed = () => {
    looks = seen = shapes = stamps = null;  // stamps go by the numbers of looks
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

  // What grains look like: lists of colours, of which a shared grain has several and one of no subdomain that of
  // `idle`. And where the labels of subdomains go.
  function makeLooks() {
    const list = palette.map((_, c) => [c]), of = new Uint32Array(picture.x.length);
    list.push([palette.length]);
    const numbers = new Map(list.map((colours, number) => [colours.join(), number]));
    const labels = picture.colours.map((_, e) => ({e, x: 0, y: 0, z: 0, grains: 0}));
    for (let i = 0; i < of.length; ++i) {
      const held = picture.holders(i), idling = picture.special(i) || held.length === 0;
      const colours = idling ? [palette.length] : held.map((e) => picture.colours[e]), key = colours.join();
      if (!numbers.has(key)) numbers.set(key, list.push(colours) - 1);
      of[i] = numbers.get(key);
      for (const e of held) {
        labels[e].x += picture.x[i];
        labels[e].y += picture.y[i];
        labels[e].z += picture.z[i];
        labels[e].grains += 1;
      }
    }
    return {list, of, labels: labels.filter((l) => l.grains > 0).sort((a, b) => b.grains - a.grains)};
  }

  function circle(path, i) {
    path.moveTo(seen.u[i] + seen.size[i], seen.v[i]);
    path.arc(seen.u[i], seen.v[i], seen.size[i], 0, 2 * Math.PI);
  }

  // Shapes of disks that `shown` says to draw: one for each colour, rims, shared grains.
  function makeShapes(shown) {
    const fills = palette.map(() => new Path2D()), rims = new Path2D(), shared = new Path2D(), others = new Path2D();
    for (let i = 0; i < looks.of.length; ++i) {
      if (!shown(i)) continue;
      const colours = looks.list[looks.of[i]];
      if (colours[0] === palette.length)
        circle(others, i);
      else if (colours.length === 1)
        [fills[colours[0]], rims].forEach((path) => circle(path, i));
      else {
        colours.forEach((c, k) => slice(fills[c], i, k, colours.length));
        circle(shared, i);
      }
    }
    return {fills, rims, shared, others};
  }

  // Those of many grains are made anew for what is in sight, which is little where they are large enough to be circles.
  function shapesInSight() {
    if (picture.x.length <= 20000) return (shapes ??= makeShapes(() => true));
    const [left, top] = scene.toView(-50, -50), [right, bottom] = scene.toView(width() + 50, height() + 50);
    return makeShapes((i) => seen.u[i] > left && seen.u[i] < right && seen.v[i] > bottom && seen.v[i] < top);
  }

  const levelOf = (layer) => Math.round(((hazeLevels - 1) * (layer + 1)) / camera.layers);

  // Grains of some pixels are squares of the same area: a browser draws a hundred thousand of them at once.
  function paintSquares(layer) {
    const level = levelOf(layer);
    const kinds = [...palette, idle], kindOf = looks.list.map((one) => (one.length > 1 ? kinds.length : one[0]));
    for (let kind = scene.layers.inner ? 0 : kinds.length; kind <= kinds.length; ++kind) {
      context.fillStyle = hazed(kinds[kind] ?? ink, level);
      for (let k = seen.starts[layer]; k < seen.starts[layer + 1]; ++k) {
        const i = seen.order[k], half = 0.886 * scene.size * seen.size[i];
        if (kindOf[looks.of[i]] === kind) context.fillRect(seen.u[i] - half, seen.v[i] - half, 2 * half, 2 * half);
      }
    }
  }

  function slice(path, i, k, parts) {
    const from = Math.PI / 2 + (2 * Math.PI * k) / parts, to = from + (2 * Math.PI) / parts;
    path.moveTo(seen.u[i], seen.v[i]);
    path.arc(seen.u[i], seen.v[i], seen.size[i], from, to);
    path.closePath();
  }

  function paintDisks(pixel, radius) {
    const {fills, rims, shared, others} = shapesInSight();
    fills.forEach((path, c) => {
      context.fillStyle = palette[c];
      context.fill(path);
      if (!scene.layers.hatching || radius < 5 || !patterns[c]) return;
      patterns[c].setTransform(new DOMMatrix().scale(pixel / 1.6));
      context.fillStyle = patterns[c];
      context.fill(path);
    });
    context.fillStyle = idle;
    context.fill(others);
    context.strokeStyle = ink;
    context.lineWidth = Math.min(1, radius / 8) * pixel;
    context.stroke(rims);
    context.stroke(others);
    context.lineWidth = Math.max(0.8, Math.min(3, radius / 4)) * pixel;
    context.stroke(shared);
  }

  function paintBalls(layer) {
    const level = levelOf(layer), hatched = scene.layers.hatching;
    for (let k = seen.starts[layer]; k < seen.starts[layer + 1]; ++k) {
      const i = seen.order[k], radius = scene.size * seen.size[i], pixels = radius * view.scale;
      const [px, py] = scene.toScreen(seen.u[i], seen.v[i]);
      if (!drawn(i) || px + pixels < 0 || py + pixels < 0 || px - pixels > width() || py - pixels > height()) continue;
      const stamp = stamps(looks.of[i], looks.list[looks.of[i]], level, pixels, hatched && pixels > 5);
      context.drawImage(stamp, px - pixels, py - pixels, 2 * pixels, 2 * pixels);
    }
  }

  // Below it grains are squares: balls take a browser longer than disks.
  const leastRadius = () => (camera.space && picture.x.length > 30000 ? 4 : 2);

  function paintGrains(layer, pixel) {
    const radius = (scene.size * scene.meanRadius) / pixel;
    if (hasty || radius < leastRadius()) return paintSquares(layer);
    if (!camera.space) return paintDisks(pixel, radius);
    onScreen(() => paintBalls(layer));
  }

  function paintWalls(pixel) {
    const far = (width() + height()) * pixel;
    context.lineWidth = 3 * pixel;
    context.strokeStyle = ink;
    for (const [x, y, nx, ny, radius, half] of picture.walls ?? []) {
      if (half > 0) {
        paintPlank(x, y, nx, ny, radius, half, pixel);
        continue;
      }
      if (radius) {  // a circle, with grains inside or outside
        context.beginPath();
        context.arc(x, y, Math.abs(radius), 0, 2 * Math.PI);
        context.fillStyle = plankFill;
        if (radius < 0) context.fill();
        context.stroke();
        continue;
      }
      // The part of the line that is in sight.
      const along = (view.x - x) * -ny + (view.y - y) * nx;
      const [cx, cy] = [x - ny * along, y + nx * along];
      context.beginPath();
      context.moveTo(cx + ny * far, cy - nx * far);
      context.lineTo(cx - ny * far, cy + nx * far);
      context.stroke();
    }
  }

  // All points within `radius` of a segment along (ny, -nx).
  function paintPlank(x, y, nx, ny, radius, half, pixel) {
    const angle = Math.atan2(ny, nx);
    context.beginPath();
    context.arc(x + half * ny, y - half * nx, radius, angle - Math.PI, angle);
    context.arc(x - half * ny, y + half * nx, radius, angle, angle + Math.PI);
    context.closePath();
    context.fillStyle = plankFill;
    context.fill();
    context.lineWidth = 1.5 * pixel;
    context.stroke();
    context.lineWidth = 3 * pixel;
  }

  // Planks in space, in the layers of their parts: grains may be all around.
  function paintPlates(layer, pixel) {
    const level = levelOf(layer);
    context.lineWidth = 1.2 * pixel;
    for (const wall of picture.walls ?? []) {
      if (!isPlank(wall)) continue;
      const {faces, lines} = pathsOfPlate(wall);
      context.fillStyle = plateFill;
      if (faces[layer]) context.fill(faces[layer]);
      context.strokeStyle = hazed('#606060', level);
      if (lines[layer]) context.stroke(lines[layer]);
    }
  }

  function pathsOfPlate(wall) {
    const known = plates.get(wall);
    if (known?.seen === seen) return known;
    const [faces, lines] = [0, 1].map(() => Array.from({length: camera.layers}, () => null));
    const plate = plateOf(wall, low, high);
    const add = (paths, points) => {
      const places = points.map((point) => camera.project(...point));
      const path = (paths[seen.layerAt(least(places.map((place) => place[2])))] ??= new Path2D());
      places.forEach(([u, v], k) => (k === 0 ? path.moveTo(u, v) : path.lineTo(u, v)));
    };
    for (const points of plate.pieces) add(faces, points);
    for (const points of plate.lines) add(lines, points);
    const paths = {seen, faces, lines};
    plates.set(wall, paths);
    return paths;
  }

  // Walls in space, as far as a box around the grains reaches: those behind as faces, those in front as edges. Without
  // walls the edges of the box.
  function paintBox(pixel, inFront) {
    const margin = 0.02 * Math.hypot(...high.map((value, k) => value - low[k]));
    const [from, to] = [low.map((value) => value - margin), high.map((value) => value + margin)];
    const trace = (points) => {
      context.beginPath();
      for (const point of points) context.lineTo(...camera.project(...point).slice(0, 2));
    };
    context.lineWidth = pixel;
    context.strokeStyle = inFront ? 'rgba(84,84,84,.45)' : '#8a8a8a';
    context.fillStyle = 'rgba(0,60,120,.05)';
    if (!picture.walls?.length && !inFront)
      for (const edge of edges) {
        trace(edge);
        context.stroke();
      }
    for (const wall of picture.walls ?? []) {
      if (isPlank(wall)) continue;
      const flat = wall[6] === 0;
      if ((flat ? camera.faces(wall) : true) === inFront) continue;
      for (const points of outlinesOf(wall, from, to)) {
        trace(points);
        if (flat && !inFront) context.fill();
        context.stroke();
      }
    }
  }

  // The directions x, y and z in a corner.
  function paintAxes() {
    const at = [34, height() - 34];
    context.font = '13px system-ui, sans-serif';
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    context.lineWidth = 1.5;
    context.strokeStyle = context.fillStyle = ink;
    ['x', 'y', 'z'].forEach((name, k) => {
      const [right, up] = camera.along(k === 0 ? 1 : 0, k === 1 ? 1 : 0, k === 2 ? 1 : 0);
      context.beginPath();
      context.moveTo(...at);
      context.lineTo(at[0] + 20 * right, at[1] - 20 * up);
      context.stroke();
      context.fillText(name, at[0] + 29 * right, at[1] - 29 * up);
    });
  }

  // The lines of a group in each layer: in that of the farther end, whose grain then hides what lies within it.
  function pathsOf(group) {
    if (group.seen === seen) return group.paths;
    const {segments} = group, paths = Array.from({length: camera.layers}, () => null);
    for (let k = 0; k < segments.length; k += 6) {
      const [u1, v1, near1] = camera.project(segments[k], segments[k + 1], segments[k + 2]);
      const [u2, v2, near2] = camera.project(segments[k + 3], segments[k + 4], segments[k + 5]);
      const path = (paths[seen.layerAt(Math.min(near1, near2))] ??= new Path2D());
      path.moveTo(u1, v1);
      path.lineTo(u2, v2);
    }
    Object.assign(group, {seen, paths});
    return paths;
  }

  function paintLines(layer, pixel) {
    const radius = scene.meanRadius / pixel, level = levelOf(layer);
    for (const group of picture.lines) {
      const {width: thickness, dash, colour, fine, plain} = group;
      if (radius < (fine ? 4 : plain ? leastRadius() : 0)) continue;
      const path = pathsOf(group)[layer];
      if (!path) continue;
      const broad = fine ? 1 : Math.max(0.7, thickness * Math.min(scene.size * radius, 14) * 0.75);
      context.setLineDash((dash ?? []).map((d) => d * pixel));
      if (broad > 2) {  // a light edge sets a chain off from the grains
        context.strokeStyle = 'rgba(255,255,255,.75)';
        context.lineWidth = (broad + 2) * pixel;
        context.stroke(path);
      }
      context.strokeStyle = hazed(colour, level);
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
    for (const {e, x, y, z, grains} of looks.labels) {
      const [u, v] = camera.project(x / grains, y / grains, z / grains), [px, py] = scene.toScreen(u, v);
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
    const [px, py] = scene.toScreen(...scene.placeOf(i));
    for (const [colour, thick] of [['#ffffff', 6], ['#0050a0', 3]]) {
      context.beginPath();
      context.arc(px, py, Math.max(scene.size * seen.size[i] * view.scale, 4) + 3, 0, 7);
      context.strokeStyle = colour;
      context.lineWidth = thick;
      context.stroke();
    }
  }

  // In pixels, not in metres.
  function onScreen(work) {
    const ratio = window.devicePixelRatio || 1;
    context.save();
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    work();
    context.restore();
  }

  function paint() {
    const ratio = window.devicePixelRatio || 1, pixel = 1 / view.scale;
    if (canvas.width !== Math.round(width() * ratio) || canvas.height !== Math.round(height() * ratio)) {
      canvas.width = Math.round(width() * ratio);
      canvas.height = Math.round(height() * ratio);
    }
    patterns ??= hatchings();
    stamps ??= createStamps(patterns);
    looks ??= makeLooks();
    sight();
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width(), height());
    const [ox, oy] = scene.toScreen(0, 0);
    context.transform(view.scale, 0, 0, -view.scale, ox, oy);
    const arrows = scene.layers.mode && picture.arrows && !hasty ? arrowsInSight(scene, seen.layerAt) : null;
    if (camera.space) paintBox(pixel, false);
    for (let layer = 0; layer < shownLayers(); ++layer) {
      if (camera.space) paintPlates(layer, pixel);
      if (camera.space && scene.layers.contacts && !hasty) paintLines(layer, pixel);
      paintGrains(layer, pixel);
      if (!camera.space) paintWalls(pixel);
      if (!camera.space && scene.layers.contacts) paintLines(layer, pixel);
      if (arrows?.[layer].length) onScreen(() => paintArrows(context, arrows[layer], hazed(modeInk, levelOf(layer))));
    }
    if (camera.space) paintBox(pixel, true);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    if (camera.space) paintAxes();
    if (scene.layers.labels && picture.colours.length > 1) paintLabels();
    paintChosen();
    canvas.dataset.painted = Number(canvas.dataset.painted ?? 0) + 1;
  }
  return scene;
}
