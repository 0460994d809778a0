// SPDX-License-Identifier: GPL-3.0-or-later
// Velocities as arrows: of every copy where grains are large enough to see them, else means over cells of the screen
// and, in space, of depth. [x, y, dx, dy] in pixels, by layer.
function arrowsInSight(scene, layerAt) {
  const {picture, view, camera, amplitude} = scene, {x, y, z, u, v, w} = picture.arrows;
  const single = scene.meanRadius * view.scale > 3.5, cell = camera.space ? 30 : 18;
  const length = amplitude * (single ? 3.2 * scene.meanRadius * view.scale : cell * 2.2);
  const layers = Array.from({length: camera.layers}, () => []), cells = new Map();
  const add = (px, py, near, dx, dy) => {
    if (Math.hypot(dx, dy) < 2.5 || px < -50 || py < -50 || px > 4000 || py > 4000) return;
    layers[layerAt(near)].push([px, py, dx, dy]);
  };
  for (let k = 0; k < x.length; ++k) {
    const [right, up, near, size] = camera.project(x[k], y[k], z[k]), [px, py] = scene.toScreen(right, up);
    const [dx, dy] = camera.along(u[k], v[k], w[k]).map((part) => part * length * size);
    if (single) {
      add(px, py, near, dx, -dy);
      continue;
    }
    const key = [px, py, near * view.scale].reduce((sum, place, i) => sum + Math.floor(place / cell) * 1e4 ** i, 0);
    const sums = cells.get(key) ?? [0, 0, 0, 0, 0, 0];
    [px, py, near, dx, -dy, 1].forEach((value, i) => {
      sums[i] += value;
    });
    cells.set(key, sums);
  }
  for (const sums of cells.values()) add(...sums.slice(0, 5).map((sum) => sum / sums[5]));
  return layers;
}

function paintArrows(context, arrows, colour) {
  for (const [paint, extra] of [['rgba(255,255,255,.9)', 2.4], [colour, 0]]) {
    context.strokeStyle = context.fillStyle = paint;
    context.lineWidth = 1.7 + extra;
    context.lineJoin = 'round';
    context.beginPath();
    const heads = new Path2D();
    for (const [px, py, dx, dy] of arrows) {
      const size = Math.hypot(dx, dy);
      const head = Math.min(7, 0.45 * size + 1), [ex, ey] = [dx / size, dy / size], [tx, ty] = [px + dx, py + dy];
      context.moveTo(px, py);
      context.lineTo(tx - ex * head * 0.7, ty - ey * head * 0.7);
      heads.moveTo(tx, ty);
      heads.lineTo(tx - ex * head - ey * head * 0.5, ty - ey * head + ex * head * 0.5);
      heads.lineTo(tx - ex * head + ey * head * 0.5, ty - ey * head - ex * head * 0.5);
      heads.closePath();
    }
    context.stroke();
    context.fill(heads);
    if (extra) context.stroke(heads);
  }
}
