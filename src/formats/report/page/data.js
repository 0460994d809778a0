// SPDX-License-Identifier: GPL-3.0-or-later
// The data of the page, numbers as text, and small helpers for elements.

const data = JSON.parse(document.getElementById('data').textContent);
const byId = (id) => document.getElementById(id);

// A packed array of the data: little-endian numbers in base 64.
function unpacked({type, data: letters}) {
  const text = atob(letters);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  const kinds = {float32: Float32Array, int16: Int16Array, uint8: Uint8Array, uint32: Uint32Array};
  return new kinds[type](bytes.buffer);
}

// The place of `to`, in a periodic cell that of its image, that is nearest to `from`.
function nearestImage(from, to) {
  return to.map((v, k) => (data.period[k] > 0 ? v - data.period[k] * Math.round((v - from[k]) / data.period[k]) : v));
}

function element(name, attributes = {}, ...children) {
  const svg = ['svg', 'path', 'line', 'text', 'circle', 'g', 'rect', 'title'].includes(name);
  const made = svg ? document.createElementNS('http://www.w3.org/2000/svg', name) : document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

const superscripts = {
  '-': '⁻',
  0: '⁰',
  1: '¹',
  2: '²',
  3: '³',
  4: '⁴',
  5: '⁵',
  6: '⁶',
  7: '⁷',
  8: '⁸',
  9: '⁹'
};
const power = (n) => '10' + [...String(n)].map((c) => superscripts[c]).join('');

// A number for a reader: so many digits, and a power of ten where it is far from 1.
function told(value, digits = 4) {
  if (value === null || value === undefined || Number.isNaN(value)) return 'unknown';
  if (value === Infinity) return '∞';
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size >= 1e-3 && size < 1e5) return String(Number(value.toPrecision(digits))).replace('-', '−');
  const [mantissa, exponent] = value.toExponential(digits - 1).split('e');
  const short = String(Number(mantissa)).replace('-', '−');
  return (short === '1' ? '' : short + '·') + power(Number(exponent));
}

// A bound for a reader, never rounded into what it encloses: `way` is -1 for a lower and 1 for an upper one.
function toldBound(value, digits, way) {
  if (!Number.isFinite(value) || value === 0) return told(value, digits);
  const near = Number(value.toPrecision(digits));
  const unit = 10 ** (Math.floor(Math.log10(Math.abs(value))) - digits + 1);
  return told(way * (near - value) >= 0 ? near : near + way * unit, digits);
}

// Of lists that are too long for the arguments of a call.
const least = (values) => values.reduce((a, b) => Math.min(a, b), Infinity);
const most = (values) => values.reduce((a, b) => Math.max(a, b), -Infinity);

const plural = (n, one, many = one + 's') => `${n} ${n === 1 ? one : many}`;

function fact(list, term, text) {
  list.append(element('dt', {}, term), element('dd', {}, text));
}

// Colours of subdomains that people tell apart whatever their colour vision (tests/report measures the distances).
// Each goes with a hatching of its own, so that no colour is the only sign.
const palette = ['#56B4E9', '#E69F00', '#F2EFE6', '#8F8F8F', '#0072B2', '#F0E442'];
const ink = '#1b1b1b', modeInk = '#8a1c00', idle = '#d8d8d8';

// Neighbouring subdomains get different colours, the first ones free. `holders(i)`: subdomains of grain i.
function coloursOf(subdomains, grains, holders) {
  const neighbours = Array.from({length: subdomains}, () => new Set());
  for (let i = 0; i < grains; ++i) {
    const held = holders(i);
    for (const e of held)
      for (const f of held)
        if (e !== f) neighbours[e].add(f);
  }
  const colours = [];
  for (let e = 0; e < subdomains; ++e) {
    const taken = new Set([...neighbours[e]].map((f) => colours[f]));
    const free = palette.findIndex((_, c) => !taken.has(c));
    colours.push(free < 0 ? e % palette.length : free);
  }
  return colours;
}
