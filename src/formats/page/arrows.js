// SPDX-License-Identifier: GPL-3.0-or-later
// Velocities as arrows: of every copy where grains are large enough to see them, else means over cells of the screen.
function paintArrows(scene, context) {
  const {picture, view, amplitude} = scene, {x, y, u, v} = picture.arrows;
  const single = scene.meanRadius * view.scale > 3.5;
  const length = amplitude * (single ? 3.2 * scene.meanRadius * view.scale : 40);
  const arrows = [];
  if (single) {
    for (let k = 0; k < x.length; ++k) arrows.push([...scene.toScreen(x[k], y[k]), u[k] * length, -v[k] * length]);
  } else {
    const cells = new Map(), size = 18;
    for (let k = 0; k < x.length; ++k) {
      const [px, py] = scene.toScreen(x[k], y[k]);
      const key = Math.floor(px / size) + 10000 * Math.floor(py / size);
      const cell = cells.get(key) ?? [0, 0, 0, 0, 0];
      [px, py, u[k], -v[k], 1].forEach((value, i) => {
        cell[i] += value;
      });
      cells.set(key, cell);
    }
    for (const [px, py, du, dv, n] of cells.values())
      arrows.push([px / n, py / n, (du / n) * length, (dv / n) * length]);
  }
  for (const [colour, extra] of [['rgba(255,255,255,.9)', 2.4], [modeInk, 0]]) {
    context.strokeStyle = context.fillStyle = colour;
    context.lineWidth = 1.7 + extra;
    context.lineJoin = 'round';
    context.beginPath();
    const heads = new Path2D();
    for (const [px, py, dx, dy] of arrows) {
      const size = Math.hypot(dx, dy);
      if (size < 2.5 || px < -50 || py < -50 || px > 4000 || py > 4000) continue;
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
