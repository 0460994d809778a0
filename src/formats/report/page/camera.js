// SPDX-License-Identifier: GPL-3.0-or-later
// The camera looks at the middle of the grains from a direction: azimuth from -y towards +x, and elevation, degrees. A
// packing in the plane is seen from above, from infinitely far, and such a camera does not turn.

function createCamera(space) {
  const home = space ? [28, 16] : [0, 90];
  const camera = {space, layers: space ? 48 : 1, target: [0, 0, 0], distance: Infinity};
  let right, up, back;
  const dot = (a, x, y, z) => a[0] * x + a[1] * y + a[2] * z;

  camera.turn = (azimuth, elevation) => {
    camera.azimuth = azimuth;
    camera.elevation = Math.max(-90, Math.min(90, elevation));
    const a = (azimuth * Math.PI) / 180, e = (camera.elevation * Math.PI) / 180;
    const level = Math.abs(camera.elevation) === 90 ? 0 : Math.cos(e);  // no rounding moves a plane
    back = [Math.sin(a) * level, -Math.cos(a) * level, Math.sin(e)];
    right = [Math.cos(a), Math.sin(a), 0];
    up = [-back[2] * right[1], back[2] * right[0], back[0] * right[1] - back[1] * right[0]];
  };
  camera.home = () => camera.turn(...home);

  // Looks at the middle of a box.
  camera.aim = (low, high) => {
    if (!space) return;
    camera.target = low.map((value, k) => (value + high[k]) / 2);
    camera.distance = 3.2 * Math.hypot(...low.map((value, k) => high[k] - value));
  };
  // To the right and upwards on the picture, the way towards the eye, and the length that a metre has there.
  camera.project = (x, y, z) => {
    const [dx, dy, dz] = [x - camera.target[0], y - camera.target[1], z - camera.target[2]];
    const near = dot(back, dx, dy, dz), size = 1 / (1 - near / camera.distance);
    return [dot(right, dx, dy, dz) * size, dot(up, dx, dy, dz) * size, near, size];
  };
  // A vector to the right and upwards.
  camera.along = (x, y, z) => [dot(right, x, y, z), dot(up, x, y, z)];
  // Whether the eye is on the side of a plane that its normal points to.
  camera.faces = ([x, y, z, nx, ny, nz]) => {
    const eye = camera.target.map((value, k) => value + camera.distance * back[k]);
    return nx * (eye[0] - x) + ny * (eye[1] - y) + nz * (eye[2] - z) > 0;
  };
  camera.home();
  return camera;
}

// Numbers of grains from far to near, by thousands of equal steps of their nearness.
function fromFarToNear(near, lowest, highest) {
  const steps = highest > lowest ? 8208 : 1, first = new Uint32Array(steps + 1), order = new Uint32Array(near.length);
  // Near ends are rounded otherwise than `near`, and may lie outside by that much.
  const place = (i) => Math.floor((steps * (near[i] - lowest)) / (highest - lowest || 1));
  const step = (i) => Math.max(0, Math.min(steps - 1, place(i)));
  for (let i = 0; i < near.length; ++i) ++first[step(i) + 1];
  for (let k = 0; k < steps; ++k) first[k + 1] += first[k];
  for (let i = 0; i < near.length; ++i) order[first[step(i)]++] = i;
  return order;
}

// The edges of a box, or what it shows of a wall: a polygon of a plane, or circles and lines of a cylinder around its
// axis. Lists of points.
function edgesOf(low, high) {
  const corner = (k) => low.map((value, axis) => (k & (1 << axis) ? high[axis] : value)), edges = [];
  for (let k = 0; k < 8; ++k)
    for (let axis = 0; axis < 3; ++axis)
      if (!(k & (1 << axis))) edges.push([corner(k), corner(k | (1 << axis))]);
  return edges;
}

// Two unit vectors that are normal to a third one and to each other.
function normalTo([x, y, z]) {
  const first = Math.abs(z) < 0.9 ? [y, -x, 0] : [0, z, -y], length = Math.hypot(...first);
  const [a, b, c] = first.map((value) => value / length);
  return [[a, b, c], [y * c - z * b, z * a - x * c, x * b - y * a]];
}

function outlinesOf([x, y, z, nx, ny, nz, radius, half], low, high) {
  const [first, second] = normalTo([nx, ny, nz]);
  const height = (p) => (p[0] - x) * nx + (p[1] - y) * ny + (p[2] - z) * nz;
  const edges = edgesOf(low, high);
  if (radius === 0) {
    const points = [];
    for (const [p, q] of edges) {
      const [hp, hq] = [height(p), height(q)];
      if (hp * hq < 0) points.push(p.map((value, k) => value + ((q[k] - value) * hp) / (hp - hq)));
    }
    if (points.length < 3) return [];
    const middle = [0, 1, 2].map((k) => points.reduce((sum, p) => sum + p[k], 0) / points.length);
    const angle = (p) => {
      const way = p.map((value, k) => value - middle[k]), dot = (a) => a[0] * way[0] + a[1] * way[1] + a[2] * way[2];
      return Math.atan2(dot(second), dot(first));
    };
    points.sort((p, q) => angle(p) - angle(q));
    return [[...points, points[0]]];
  }
  const heights = edges.flat().map(height), ends = half ? [-half, half] : [least(heights), most(heights)], parts = 48;
  const point = (k, h) => {
    const a = (2 * Math.PI * k) / parts, [c, s] = [Math.abs(radius) * Math.cos(a), Math.abs(radius) * Math.sin(a)];
    return [x, y, z].map((value, i) => value + c * first[i] + s * second[i] + h * [nx, ny, nz][i]);
  };
  const circles = ends.map((h) => Array.from({length: parts + 1}, (_, k) => point(k, h)));
  return [...circles, ...[0, 8, 16, 24, 32, 40].map((k) => ends.map((h) => point(k, h)))];
}

// What the picture shows of a plank in space as far as a box around the grains reaches: pieces of its middle plane, and
// lines of the borders of both faces and of the rim. Lists of points.
function plateOf([x, y, z, nx, ny, nz, radius, ax, ay, az, half, halfWidth], low, high) {
  const normal = [nx, ny, nz], axis = [ax, ay, az], across = [ny * az - nz * ay, nz * ax - nx * az, nx * ay - ny * ax];
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2], parts = 24;
  const margin = 0.1 * Math.hypot(...high.map((value, k) => value - low[k]));
  const corners = edgesOf(low, high).flat().map((p) => [p[0] - x, p[1] - y, p[2] - z]);
  const range = (direction, end) => {
    const places = corners.map((corner) => dot(corner, direction));
    return [Math.max(-end, least(places) - margin), Math.min(end, most(places) + margin)];
  };
  const [s0, s1] = range(axis, half), [t0, t1] = range(across, halfWidth), flat = t1 > t0;
  if (s0 > s1 || t0 > t1) return {pieces: [], lines: []};
  const point = (s, t, h) => [x, y, z].map((value, k) => value + s * axis[k] + t * across[k] + h * normal[k]);
  const steps = (from, to) => Array.from({length: parts + 1}, (_, k) => from + ((to - from) * k) / parts);
  const [s, t] = [steps(s0, s1), steps(t0, t1)], pieces = [], lines = [];
  const trace = (points) => {
    for (let k = 1; k < points.length; ++k) lines.push([points[k - 1], points[k]]);
  };
  for (let i = 0; flat && i < parts; ++i)
    for (let j = 0; j < parts; ++j)
      pieces.push([[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]].map(([a, b]) => point(s[a], t[b], 0)));
  for (const h of flat ? [-radius, radius] : []) {
    for (const end of [t0, t1]) trace(s.map((value) => point(value, end, h)));
    for (const end of [s0, s1]) trace(t.map((value) => point(end, value, h)));
  }
  // The rim: a quarter of a circle at each corner, and what joins them.
  const rim = (at) => {
    const points = [[s1, t1], [s0, t1], [s0, t0], [s1, t0]].flatMap(([a, b], quarter) => [0, 1, 2, 3, 4].map((k) => {
      const angle = ((quarter + k / 4) * Math.PI) / 2;
      return at(a, b, radius * Math.cos(angle), radius * Math.sin(angle));
    }));
    trace([...points, points[0]]);
  };
  rim((a, b, c, d) => point(a + c, b + d, 0));
  if (!flat) rim((a, b, c, d) => point(a + c, b, d));
  return {pieces, lines};
}
