// SPDX-License-Identifier: GPL-3.0-or-later
// Line charts as SVG. Lines differ in dash and mark as well as in colour.

// An axis over `values` on `from` ... `to` pixels: linear, or logarithmic with places of their own for 0 and infinity.
// `range`: its ends; `widen`: to whole decades.
function axisOf(values, kind, from, to, {range, widen} = {}) {
  const finite = values.filter((v) => Number.isFinite(v) && (kind !== 'log' || v > 0));
  let low = range?.[0] ?? least(finite), high = range?.[1] ?? most(finite);
  if (!finite.length) [low, high] = kind === 'log' ? [0.1, 1] : [0, 1];
  if (kind === 'log' && !range && finite.length && widen)
    [low, high] = [10 ** Math.floor(Math.log10(low) + 1e-9), 10 ** Math.ceil(Math.log10(high) - 1e-9)];
  if (!(high > low)) [low, high] = kind === 'log' ? [low / 2, low * 2] : [low - 0.5, low + 0.5];
  const scale = kind === 'log' ? Math.log10 : (v) => v;
  const zero = kind === 'log' && values.includes(0), infinite = values.includes(Infinity);
  const room = Math.sign(to - from) * 34;
  const first = from + (zero ? room : 0), last = to - (infinite ? room : 0);
  const place = (v) => {
    if (v === 0 && kind === 'log') return from;
    if (v === Infinity) return to;
    return first + ((scale(v) - scale(low)) / (scale(high) - scale(low))) * (last - first);
  };
  const ticks = [];
  if (zero) ticks.push([0, '0']);
  if (kind === 'log') {
    const [a, b] = [Math.ceil(Math.log10(low) - 1e-9), Math.floor(Math.log10(high) + 1e-9)];
    const stride = Math.max(1, Math.ceil((b - a + 1) / (Math.abs(to - from) / 48)));
    for (let n = a; n <= b; n += stride) ticks.push([10 ** n, power(n)]);
    if (b < a) ticks.push([low, told(low, 2)], [high, told(high, 2)]);
  } else {
    const rough = (high - low) / Math.max(2, Math.abs(to - from) / 60), unit = 10 ** Math.floor(Math.log10(rough));
    const stride = [1, 2, 5, 10].map((f) => f * unit).find((s) => s >= rough);
    for (let n = Math.ceil(low / stride - 1e-9); n * stride <= high * (1 + 1e-12) + 1e-300; ++n)
      ticks.push([n * stride, told(Number((n * stride).toPrecision(12)), 4)]);
  }
  if (infinite) ticks.push([Infinity, '∞']);
  return {place, ticks, low, high};
}

function drawMark(kind, x, y, colour) {
  if (kind === 'square') return element('rect', {x: x - 3, y: y - 3, width: 6, height: 6, fill: colour});
  if (kind === 'triangle') return element('path', {d: `M${x},${y - 4}l4,7h-8z`, fill: colour});
  return element('circle', {cx: x, cy: y, r: 3, fill: kind === 'open' ? '#fff' : colour, stroke: colour});
}

// chart: x: {kind, label}, y: {kind, label, range}, series: [{name, points, dash, colour, mark}], rules: [[y, text]],
// places: [[x, text]], marker: [x, y] or [x], pick(x): called with the nearest x of all points.
function drawChart(holder, chart) {
  const width = Math.max(280, holder.clientWidth), height = Math.min(300, Math.max(200, width * 0.55));
  const [left, right, top, bottom] = [58, 14, 12, 40];
  const all = chart.series.flatMap((s) => s.points), rules = chart.rules ?? [];
  const x = axisOf(all.map((p) => p[0]), chart.x.kind, left, width - right);
  const y = axisOf(
      [...all.map((p) => p[1]), ...rules.map((r) => r[0])], chart.y.kind, height - bottom, top,
      {range: chart.y.range, widen: true});
  const svg = element('svg', {viewBox: `0 0 ${width} ${height}`, role: 'img', 'aria-label': chart.label});
  const clipped = (v) => Math.min(Math.max(y.place(v), top), height - bottom);
  const line = (x1, y1, x2, y2, colour, extra = {}) =>
      svg.append(element('line', {x1, y1, x2, y2, stroke: colour, ...extra}));
  const text = (words, px, py, extra = {}) => svg.append(element('text', {x: px, y: py, ...extra}, words));
  for (const [value, words] of x.ticks) {
    line(x.place(value), top, x.place(value), height - bottom, '#dcdcdc');
    text(words, x.place(value), height - bottom + 16, {'text-anchor': 'middle'});
  }
  for (const [value, words] of y.ticks) {
    line(left, y.place(value), width - right, y.place(value), '#dcdcdc');
    text(words, left - 6, y.place(value) + 4, {'text-anchor': 'end'});
  }
  line(left, height - bottom, width - right, height - bottom, '#767676');
  line(left, top, left, height - bottom, '#767676');
  text(chart.x.label, (left + width - right) / 2, height - 5, {'text-anchor': 'middle'});
  text(
      chart.y.label, 14, (top + height - bottom) / 2,
      {'text-anchor': 'middle', transform: `rotate(-90 14 ${(top + height - bottom) / 2})`});
  for (const [value, words] of rules) {
    if (value < y.low || value > y.high) continue;
    line(left, y.place(value), width - right, y.place(value), '#8a1c00', {'stroke-dasharray': '2 3'});
    const [px, anchor] = chart.rulesLeft ? [left + 8, 'start'] : [width - right - 4, 'end'];
    text(words, px, y.place(value) - 4, {'text-anchor': anchor, 'font-size': 11, class: 'on-top'});
  }
  for (const [value, words] of chart.places ?? []) {
    line(x.place(value), top, x.place(value), height - bottom, '#545454', {'stroke-dasharray': '7 3'});
    const near = x.place(value) > width - 120;
    text(words, x.place(value) + (near ? -4 : 4), top + 10, {'font-size': 11, 'text-anchor': near ? 'end' : 'start'});
  }
  for (const series of chart.series) {
    const shown = series.points.filter((p) => Number.isFinite(p[1]) && (chart.y.kind !== 'log' || p[1] > 0));
    const d = shown.map((p, i) => (i ? 'L' : 'M') + x.place(p[0]).toFixed(2) + ',' + clipped(p[1]).toFixed(2)).join('');
    svg.append(element(
        'path',
        {d, fill: 'none', stroke: series.colour, 'stroke-width': 2, 'stroke-dasharray': series.dash ?? 'none'}));
    if (shown.length <= 60 && series.mark)
      for (const p of shown)
        svg.append(drawMark(p[1] > y.high ? 'triangle' : series.mark, x.place(p[0]), clipped(p[1]), series.colour));
  }
  if (chart.marker) {
    const [mx, my] = chart.marker, px = x.place(mx);
    line(px, top, px, height - bottom, '#0050a0', {'stroke-width': 1.5});
    if (Number.isFinite(my))
      svg.append(element(
          'circle',
          {class: 'marker', cx: px, cy: clipped(my), r: 7, fill: '#fff', stroke: '#0050a0', 'stroke-width': 3}));
  }
  if (chart.pick)
    svg.addEventListener('click', (event) => {
      const box = svg.getBoundingClientRect(), px = ((event.clientX - box.left) / box.width) * width;
      const far = (p) => Math.abs(x.place(p[0]) - px);
      chart.pick(all.reduce((best, p) => (far(p) < far(best) ? p : best))[0]);
    });
  const keys = element('ul', {class: 'keys'});
  for (const {name, colour, dash, mark} of chart.series.length > 1 ? chart.series : []) {
    const sample = element(
        'svg', {viewBox: '0 0 32 12', 'aria-hidden': 'true'},
        element(
            'line',
            {x1: 0, y1: 6, x2: 32, y2: 6, stroke: colour, 'stroke-width': 2.5, 'stroke-dasharray': dash ?? 'none'}));
    if (mark) sample.append(drawMark(mark, 16, 6, colour));
    keys.append(element('li', {}, sample, name));
  }
  holder.replaceChildren(svg, keys);
}
