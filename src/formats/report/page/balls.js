// SPDX-License-Identifier: GPL-3.0-or-later
// Spheres: painted once for every look, and stamped wherever one is. Far things are mixed with white.

const hazeLevels = 8;
const hazeOf = (level) => (0.55 * (hazeLevels - 1 - level)) / (hazeLevels - 1);

function hazed(colour, level) {
  const part = hazeOf(level), number = parseInt(colour.slice(1), 16);
  const mixed = [number >> 16, (number >> 8) & 255, number & 255].map((c) => Math.round(c + (255 - c) * part));
  return `rgb(${mixed.join(',')})`;
}

// `look`: colours of its parts, more than one for a shared grain.
function paintBall(look, level, size, patterns) {
  const canvas = document.createElement('canvas'), c = canvas.getContext('2d'), middle = size / 2;
  canvas.width = canvas.height = size;
  const rim = look.length > 1 ? size / 14 : size / 40, radius = middle - rim / 2 - 1;
  look.forEach((colour, k) => {
    const from = Math.PI / 2 + (2 * Math.PI * k) / look.length;
    c.beginPath();
    c.moveTo(middle, middle);
    c.arc(middle, middle, radius, from, from + (2 * Math.PI) / look.length);
    c.closePath();
    c.fillStyle = palette[colour] ?? idle;
    c.fill();
    if (!patterns?.[colour]) return;
    patterns[colour].setTransform(new DOMMatrix().scale(size / 80));
    c.fillStyle = patterns[colour];
    c.fill();
  });
  c.beginPath();
  c.arc(middle, middle, radius, 0, 7);
  const light = c.createRadialGradient(0.66 * middle, 0.6 * middle, 0, 0.85 * middle, 0.85 * middle, 1.15 * radius);
  light.addColorStop(0, 'rgba(255,255,255,.55)');
  light.addColorStop(0.35, 'rgba(255,255,255,0)');
  light.addColorStop(0.65, 'rgba(0,0,0,0)');
  light.addColorStop(1, 'rgba(0,0,0,.38)');
  c.fillStyle = light;
  c.fill();
  c.strokeStyle = ink;
  c.lineWidth = rim;
  c.stroke();
  c.globalCompositeOperation = 'source-atop';
  c.fillStyle = `rgba(255,255,255,${hazeOf(level)})`;
  c.fillRect(0, 0, size, size);
  return canvas;
}

// Returns what gives the stamp of a look, known by its number, at a radius in pixels.
function createStamps(patterns) {
  const stamps = new Map();
  return (number, look, level, radius, hatched) => {
    const size = radius > 18 ? 256 : 48, key = ((number * hazeLevels + level) * 2 + (size > 48)) * 2 + hatched;
    if (!stamps.has(key)) stamps.set(key, paintBall(look, level, size, hatched && patterns));
    return stamps.get(key);
  };
}
