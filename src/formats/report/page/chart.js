// SPDX-License-Identifier: GPL-3.0-or-later
// Line charts as SVG. Lines differ in dash and mark as well as in colour.

// Ticks at powers of ten that are not too close together. With fewer than three of them, also at their multiples.
function logTicks(low, high, length) {
  const [a, b] = [Math.ceil(Math.log10(low) - 1e-9), Math.floor(Math.log10(high) + 1e-9)];
  const fitting = Math.max(1, Math.ceil((b - a + 1) / (length / 48)));
  const stride = Math.max(1, Math.min(fitting, Math.floor((b - a) / 2)));
  const powers = [];
  for (let n = a; n <= b; n += stride) powers.push([10 ** n, power(n)]);
  if (powers.length >= 3) return powers;
  for (const factors of [[1, 2, 5], [1, 2, 3, 4, 5, 6, 7, 8, 9]]) {
    const ticks = [];
    for (let n = a - 1; n <= b; ++n)
      for (const f of factors) {
        const value = Number(`${f}e${n}`);
        if (value >= low * (1 - 1e-9) && value <= high * (1 + 1e-9))
          ticks.push([value, told(value, 1)]);
      }
    if (ticks.length >= 3) return ticks;
  }
  return [[low, told(low, 2)], [high, told(high, 2)]];
}

// Multiples of 1, 2 or 5 times a power of ten: at least three, unless there are fewer whole numbers.
function linearTicks(low, high, length, whole) {
  const rough = (high - low) / Math.max(2, length / 60), unit = 10 ** Math.floor(Math.log10(rough));
  const strides = [10, 5, 2, 1, 0.5, 0.2, 0.1].map((f) => f * unit);
  const first = (s) => Math.ceil(low / s - 1e-9), last = (s) => Math.floor(high / s + 1e-9);
  const wide = strides.filter((s) => s >= rough * (1 - 1e-9)).at(-1);
  let stride = strides.find((s) => s <= wide && last(s) - first(s) >= 2) ?? wide;
  if (whole) stride = Math.max(1, Math.round(stride));
  const digits = Math.min(12, Math.max(4, Math.ceil(Math.log10(Math.max(-low, high) / stride)) + 1));
  const ticks = [];
  for (let n = first(stride); n <= last(stride); ++n)
    ticks.push([n * stride, told(Number((n * stride).toPrecision(12)), digits)]);
  return ticks;
}

// An axis over `values` on `from` ... `to` pixels: linear, or logarithmic with places of their own for 0 and infinity.
// `range`: its ends; `widen`: to whole decades; `whole`: of whole numbers.
function axisOf(values, kind, from, to, {range, widen, whole} = {}) {
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
  ticks.push(...(kind === 'log' ? logTicks : linearTicks)(low, high, Math.abs(to - from), whole));
  if (infinite) ticks.push([Infinity, '∞']);
  return {place, ticks, low, high};
}

function drawMark(kind, x, y, colour) {
  if (kind === 'square') return element('rect', {x: x - 3, y: y - 3, width: 6, height: 6, fill: colour});
  if (kind === 'triangle' || kind === 'above')
    return element('path', {class: kind, d: `M${x},${y - 4}l4,7h-8z`, fill: colour});
  return element('circle', {cx: x, cy: y, r: 3, fill: kind === 'open' ? '#fff' : colour, stroke: colour});
}

// chart: x: {kind, label, whole}, y: {kind, label, range}, series: [{name, points, dash, colour, mark}], rules: [[y,
// text]], places: [[x, text]], marker: [x, y] or [x], pick(x): called with the nearest x of all points.
function drawChart(holder, chart) {
  const width = Math.max(280, holder.clientWidth), height = Math.min(300, Math.max(200, width * 0.55));
  const [left, right, top, bottom] = [58, 14, 12, 40];
  const all = chart.series.flatMap((s) => s.points), rules = chart.rules ?? [];
  const x = axisOf(all.map((p) => p[0]), chart.x.kind, left, width - right, {whole: chart.x.whole});
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
  const ruled = rules.filter(([value]) => value >= y.low && value <= y.high);
  for (const [value] of ruled)
    line(left, y.place(value), width - right, y.place(value), '#8a1c00', {'stroke-dasharray': '2 3'});
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
        svg.append(drawMark(p[1] > y.high ? 'above' : series.mark, x.place(p[0]), clipped(p[1]), series.colour));
  }
  for (const [value, words] of ruled) {
    const [px, anchor] = chart.rulesLeft ? [left + 8, 'start'] : [width - right - 4, 'end'];
    text(words, px, y.place(value) - 4, {'text-anchor': anchor, 'font-size': 11, class: 'on-top'});
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
  if (svg.querySelector('.above'))
    keys.append(element('li', {}, `▲ above ${told(y.high, 3)}, off the chart`));
  holder.replaceChildren(svg, keys);
}
