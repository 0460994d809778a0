// SPDX-License-Identifier: GPL-3.0-or-later
// The page of one packing or contact problem: radii over a grid of flexibilities, and the slowest mode at its points.

function showPacking() {
  const {counts, scale, epsilon, contacts: network, problem} = data;
  const eta = data.eta.map((value) => (value === 'inf' ? Infinity : value));
  const grains = Object.fromEntries(Object.entries(data.grains).map(([key, array]) => [key, unpacked(array)]));
  const space = data.dimension === 3, drawn = grains.x.length > 0;
  const Grain = problem ? 'Body' : 'Grain', grainsText = (n) => problem ? plural(n, 'body', 'bodies') : plural(n, 'grain');
  grains.z ??= new Float32Array(grains.x.length);
  const start = unpacked(data.copies.start), subdomainOfCopy = unpacked(data.copies.subdomain);
  const [first, second] = [unpacked(network.a), unpacked(network.b)];
  const points = network.point && unpacked(network.point), support = 2 ** 32 - 1;
  const impulses = network.impulse && unpacked(network.impulse);
  const holders = (i) => Array.from(subdomainOfCopy.subarray(start[i], start[i + 1]));
  const colours = coloursOf(data.subdomains, grains.x.length, holders);
  const state = {grid: 0, epsilon: 0, eta: eta.length - 1};
  const velocities = new Map();  // of modes, unpacked once

  byId('figures').append(byId('packing').content);
  if (data.scheme === 'schwarz') {
    for (const id of ['eta', 'eta-value', 'along-eta', 'along-eta-title', 'numbers']) byId(id).hidden = true;
    document.querySelector('label[for=eta]').textContent = 'Scheme schwarz: block Jacobi with whole masses, without η';
  }
  const [picture, scene] = drawn ? makePicture() : [];

  const grid = () => data.grids[state.grid];
  const pointAt = (e, h) => grid().points[e * eta.length + h];
  // What is smaller than rounding is 0.
  const ratio = (value, digits) => told(value !== null && Math.abs(value) < 1e-14 ? 0 : value, digits);
  const flexibility = (value) => {
    if (value === Infinity) return told(value);
    if (value === 0) return told(value) + ' 1/kg';
    return `${told(value)} 1/kg (${told(value / scale, 3)} W)`;
  };

  function makePicture() {
    const made = {...grains, space, holders, colours, special: () => false, lines: [], arrows: null};
    const canvas = byId('scene');
    canvas.setAttribute(
        'aria-label', `Picture of ${grainsText(counts.grains)} in ` + plural(data.subdomains, 'subdomain'));
    return [made, createScene(canvas, made)];
  }

  function describe(i) {
    const held = holders(i);
    const where = held.length === 0 ? 'touches nothing' :
        held.length === 1           ? `subdomain ${held[0]}` :
                                      `shared by subdomains ${held.join(', ')}`;
    const size = problem ? '' : `mass ${told(grains.mass[i])} kg, radius ${told(grains.radius[i])} m, `;
    return `${Grain} ${i}: ${size}${where}`;
  }

  // Contacts of Stage 1 and the others. Thickness is the impulse of the linear rigid problem where there is a load, or
  // that of the file of a contact problem, where a contact goes from body to body by its point.
  function showContacts() {
    if (!drawn) return;
    const active = unpacked(grid().active);
    const numbers = Array.from(first.keys());
    const place = (i) => [grains.x[i], grains.y[i], grains.z[i]];
    const pointOf = (k) => [...points.subarray(data.dimension * k, data.dimension * (k + 1)), 0].slice(0, 3);
    const ends = (k) => !points ? [...place(first[k]), ...nearestImage(place(first[k]), place(second[k]))] :
        second[k] === support   ? [...place(first[k]), ...pointOf(k)] :
                                  [...place(first[k]), ...pointOf(k), ...pointOf(k), ...place(second[k])];
    const sorted = impulses ? Array.from(impulses, Math.abs).sort((a, b) => a - b) : [];
    const full = sorted.length ? sorted[Math.floor(0.99 * (sorted.length - 1))] || 1 : 1;
    const size = (k) => (impulses ? Math.abs(impulses[k]) / full : 0.3);
    const pulls = (k) => impulses && impulses[k] < 0;
    const carrying = numbers.filter((k) => active[k]);
    picture.lines = [
      ...lineGroups(numbers.filter((k) => !active[k]), ends, () => 0.1, {colour: '#4a4a4a', dash: [2, 3], fine: true}),
      ...lineGroups(carrying.filter(pulls), ends, size, {colour: ink, dash: [5, 3]}),
      ...lineGroups(carrying.filter((k) => !pulls(k)), ends, size, {colour: ink, plain: !impulses}),
    ];
    scene.draw();
  }

  // The mode of the point, or of the nearest one that has one.
  function nearestMode() {
    const distance = (m) => Math.abs(m.epsilon - state.epsilon) + Math.abs(m.eta - state.eta);
    return grid().modes.reduce((best, m) => (!best || distance(m) < distance(best) ? m : best), null);
  }

  function showMode() {
    if (!drawn) return;
    const mode = nearestMode();
    const exact = mode && mode.epsilon === state.epsilon && mode.eta === state.eta;
    byId('mode-text').textContent = !mode ?
        'There is no mode of its own: every eigenvalue is the same, or none is known.' :
        exact ? `Arrows: velocities of the slowest mode, eigenvalue ${told(mode.eigenvalue, 5)}.` :
                `No mode is kept at this point: arrows show that of ε = ${flexibility(epsilon[mode.epsilon])}, ` +
            `η = ${flexibility(eta[mode.eta])}.`;
    picture.arrows = mode && arrowsOf(mode);
    scene.draw();
  }

  function arrowsOf(mode) {
    if (!velocities.has(mode)) velocities.set(mode, unpacked(mode.velocities));
    const packed = velocities.get(mode), d = data.dimension, copies = packed.length / d;
    const [x, y, z, u, v, w] = Array.from({length: 6}, () => new Float32Array(copies));
    for (let i = 0; i < grains.x.length; ++i)
      for (let k = start[i]; k < start[i + 1]; ++k) {
        [x[k], y[k], z[k]] = [grains.x[i], grains.y[i], grains.z[i]];
        [u[k], v[k]] = [packed[d * k] / 32767, packed[d * k + 1] / 32767];
        if (space) w[k] = packed[d * k + 2] / 32767;
      }
    return {x, y, z, u, v, w};
  }

  function meaningOf(point) {
    const rate = point.subdominant;
    const rigid = point.unit === 0 ? '' :
                                     `ρ(B) itself is 1: ${plural(point.unit, 'eigenvalue')} of 1 belong to ` +
            'self-stresses across the interface, which no iteration changes. The value above leaves them out. ';
    if (counts.interface === 0) return `The interface is empty (${counts.why_empty}): there is nothing to iterate.`;
    if (!(rate > 1e-14)) return rigid + 'One iteration solves the problem.';
    if (rate >= 1)
      return rigid + `The iteration diverges: in the end every iteration multiplies the error by ` +
          `${told(rate, 4)}.`;
    return rigid + `In the end ${told(-1 / Math.log10(rate), 3)} iterations bring one more decimal digit.`;
  }

  function certificateOf(point) {
    const between = ([from, to]) => `[${toldBound(from, 12, -1)}, ${toldBound(to, 12, 1)}]`;
    const ends = point.low === null ? '' : `Spectrum from ${ratio(point.low, 5)} to ${ratio(point.high, 5)}. `;
    const error = counts.interface === 0 ? '' : `An eigenvalue lies within ${told(point.residual, 2)} of each end. `;
    const proof = point.certified ?
        `Proved by counts: the lowest is in ${between(point.certified.low)}, the highest in ` +
            `${between(point.certified.high)}, and none lies further out.` :
        '';
    const open = point.converged ? '' :
        `This point did not converge: its radius is not proved${point.failure ? ` (${point.failure})` : ''}. `;
    return open + ends + error + proof;
  }

  function bestText() {
    const best = grid().best[state.epsilon];
    byId('best').hidden = !best;
    if (!best) return;
    byId('go-best').hidden = best.status !== 'interior' || !eta.some(Number.isFinite);
    const words = {
      interior: () => `Best η at this ε: ${flexibility(best.eta)}, where ρ = ${ratio(best.radius, 6)}; the generic ` +
          `algorithm has ${told(best.generic_radius, 6)}. The enriched one converges for ` +
          `${best.convergent_from > 0 ? 'η above ' + told(best.convergent_from) + ' 1/kg' : 'every η'} and beats the ` +
          `generic one for ${best.better_from > 0 ? 'η above ' + told(best.better_from) + ' 1/kg' : 'every η'}.`,
      eta_to_zero: () => 'The smaller η, the smaller ρ: there is no best value above 0.',
      eta_to_infinity: () => 'No enriched algorithm beats the generic one.',
      no_interface: () => 'There is no interface, hence nothing to optimise.',
      already_exact: () => 'The generic algorithm converges in one iteration already.',
      not_converged: () => 'The best η is not known: a spectrum on the way did not converge.',
    };
    byId('best-text').textContent = words[best.status]();
  }

  const curve = (points, values) => points.map((p, i) => [values[i], p.subdominant]);

  function drawCurves() {
    const here = pointAt(state.epsilon, state.eta).subdominant;
    const overEta = curve(eta.map((_, h) => pointAt(state.epsilon, h)), eta);
    const overEpsilon = curve(epsilon.map((_, e) => pointAt(e, state.eta)), epsilon);
    const highest = Math.max(...overEta.map((p) => p[1]), ...overEpsilon.map((p) => p[1]));
    const y = {kind: 'linear', label: 'ρ', range: [0, Math.min(2, Math.max(1.1, 1.05 * highest))]};
    const rules = [[1, 'above: the iteration diverges']];
    const best = grid().best[state.epsilon];
    byId('along-eta-title').textContent = `ρ over η, at ε = ${flexibility(epsilon[state.epsilon])}`;
    byId('along-epsilon-title').textContent = `ρ over ε, at η = ${flexibility(eta[state.eta])}`;
    const enriched = {name: 'enriched, η', points: overEta, colour: '#0050a0', mark: 'round'};
    const generic = {
      name: 'generic, η = ∞',
      dash: '6 4',
      colour: ink,
      points: eta.includes(Infinity) ? eta.map((h) => [h, overEta.at(-1)[1]]) : []
    };
    drawChart(byId('along-eta'), {
      label: 'Spectral radius over η',
      x: {kind: 'log', label: 'η, 1/kg'},
      y,
      rules,
      series: [enriched, generic],
      marker: [eta[state.eta], here],
      pick: (value) => go({eta: eta.indexOf(value)}),
      places: best && best.status === 'interior' ? [[best.eta, 'best η']] : []
    });
    const series = [{name: `η = ${told(eta[state.eta])}`, points: overEpsilon, colour: '#0050a0', mark: 'round'}];
    if (eta.includes(Infinity) && eta[state.eta] !== Infinity)
      series.push({
        name: 'generic, η = ∞',
        dash: '6 4',
        colour: ink,
        points: curve(epsilon.map((_, e) => pointAt(e, eta.length - 1)), epsilon)
      });
    drawChart(byId('along-epsilon'), {
      label: 'Spectral radius over ε',
      x: {kind: 'log', label: 'ε, 1/kg'},
      y,
      rules,
      series,
      marker: [epsilon[state.epsilon], here],
      pick: (value) => go({epsilon: epsilon.indexOf(value)})
    });
  }

  function fillTable() {
    const cell = (name, words) => element(name, name === 'th' ? {scope: 'col'} : {}, words);
    const head = element('tr', {}, ...['η, 1/kg', 'ρ', 'residual', 'converged'].map((words) => cell('th', words)));
    byId('table').replaceChildren(head, ...eta.map((value, h) => {
      const point = pointAt(state.epsilon, h);
      return element(
          'tr', {}, cell('td', told(value)), cell('td', ratio(point.subdominant, 7)),
          cell('td', told(point.residual, 2)), cell('td', point.converged ? 'yes' : 'no'));
    }));
  }

  function setSlider(id, values, words) {
    const slider = byId(id);
    slider.max = values.length - 1;
    slider.value = state[id];
    slider.disabled = values.length < 2;
    slider.setAttribute('aria-valuetext', words);
    byId(id + '-value').textContent = words;
  }

  function go(change) {
    Object.assign(state, change);
    const point = pointAt(state.epsilon, state.eta);
    setSlider('epsilon', epsilon, flexibility(epsilon[state.epsilon]));
    setSlider('eta', eta, flexibility(eta[state.eta]));
    byId('rho').textContent = ratio(point.subdominant, 7);
    byId('meaning').textContent = meaningOf(point);
    byId('certificate').textContent = certificateOf(point);
    byId('certificate').classList.toggle('warning', !point.converged);
    byId('result').classList.toggle('diverges', point.subdominant >= 1);
    bestText();
    drawCurves();
    if (byId('numbers').open) fillTable();
    if ('grid' in change) showContacts();
    showMode();
  }

  function addSets() {
    const names = {
      all: 'all contacts, linear law',
      active: 'active contacts, by the paper\'s rule (nonsmooth at ε = 0)',
      unilateral: 'contacts that carry in the unilateral problem (nonsmooth at ε = 0)'
    };
    byId('sets').hidden = data.grids.length < 2;
    byId('sets').append('Stage 1 works with');
    data.grids.forEach(({contacts}, g) => {
      const button = element('input', {type: 'radio', name: 'set', value: contacts});
      button.checked = g === 0;
      button.addEventListener('change', () => go({grid: g}));
      byId('sets').append(element('label', {}, button, names[contacts]));
    });
  }

  function addFactsOfProblem(list) {
    const {ranks} = problem, range = ([from, to]) => from === to ? told(from) : `${told(from)} to ${told(to)}`;
    if (problem.title) fact(list, 'Title', problem.title);
    fact(list, 'Velocities of bodies', String(problem.velocities));
    fact(list, 'Links', `${problem.links}, the normal and ${space ? 'two tangents' : 'the tangent'} of each contact`);
    fact(list, 'Friction', range(problem.friction));
    fact(list, 'W_nn', `${range(problem.normal_delassus)} 1/kg`);
    fact(list, 'Entries of W', String(problem.entries));
    fact(list, 'Connected pieces', String(problem.pieces));
    fact(
        list, 'Rank of W',
        !ranks ? 'not computed: too many contacts' :
                 `${ranks.rank}, with ${plural(ranks.rigid_modes, 'rigid mode')} and hyperstaticity ` +
                `${ranks.hyperstaticity}, ${ranks.unit} of it across the interface`);
    for (const one of problem.impulses)
      fact(
          list, `Impulses, ${one.name}`,
          `natural map ${told(one.residual, 3)}; ${one.open} contacts open, ${one.stick} stick, ${one.slide} slide`);
  }

  function addFacts() {
    const list = byId('facts'),
          sharedText = counts.shared.map((s) => `${grainsText(s.grains)} by ${s.multiplicity}`).join(', ');
    fact(list, problem ? 'Bodies' : 'Grains', `${counts.grains}, ${counts.isolated} of them touch nothing`);
    fact(list, 'Contacts', `${counts.contacts}, coordination number ${told(counts.coordination, 3)}`);
    for (const {contacts, active, rule, certain} of data.grids)
      if (contacts !== 'all')
        fact(
            list, `Contacts, ${contacts}`,
            `${unpacked(active).reduce((sum, one) => sum + one, 0)}, ${rule}` +
                (certain ? '' : '; impulses were not found to 10⁻⁸, so the choice is uncertain'));
    fact(list, 'Subdomains', String(data.subdomains));
    fact(list, problem ? 'Shared bodies' : 'Shared grains', sharedText || 'none');
    fact(list, 'Interface unknowns', String(counts.interface));
    if (problem) {
      addFactsOfProblem(list);
    } else {
      fact(list, 'Rattlers', String(counts.rattlers));
      fact(list, 'Solid fraction', told(counts.solid_fraction, 3));
    }
    fact(list, 'W, mean of W_nn', `${told(scale)} 1/kg, the scale of ε and η`);
    const kept = data.grids.reduce((sum, g) => sum + g.modes.length, 0);
    const asked = data.grids.reduce((sum, g) => sum + g.modes_asked, 0);
    const points = data.grids.reduce((sum, g) => sum + g.points.length, 0);
    const modes =
        asked < points ? `modes of all but ${kept} of the ${points} points, so that the file stays small; ` : '';
    byId('left-out').textContent =
        `Left out: ${modes}radii between the points, and relaxation. Coordinates, masses and ` +
        'impulses have seven digits, velocities of modes four; radii have all digits.';
  }

  function addLayers() {
    if (!drawn) return;
    const sample = (colour) => element('circle', {cx: 17, cy: 9, r: 8, fill: colour, stroke: ink});
    const stroke = (width, dash) => element(
        'line', {x1: 1, y1: 9, x2: 34, y2: 9, stroke: ink, 'stroke-width': width, 'stroke-dasharray': dash ?? 'none'});
    addSwitch(scene, 'contacts', 'contacts');
    addSwitch(scene, 'labels', 'numbers of subdomains');
    addSwitch(scene, 'hatching', 'hatching');
    addSwitch(scene, 'mode', 'slowest mode');
    const times = (value) => 'times ' + told(2 ** value, 2);
    addRange(scene, 'amplitude', 'length of arrows', {min: -3, max: 5, step: 0.5, value: 0}, times, (value) => {
      scene.amplitude = 2 ** value;
    });
    addSpaceTools(scene, 60);
    byId('layers').after(element('p', {id: 'mode-text', role: 'status'}));
    const shared = sample(palette[0]);
    shared.setAttribute('stroke-width', 3);
    addToLegend(
        problem ? 'body, at the mean of the points of its contacts, coloured and hatched by subdomain' :
                  'grain, coloured and hatched by subdomain',
        sample(palette[0]));
    addToLegend(
        `shared ${Grain.toLowerCase()}: thick rim, a part for each copy`, shared,
        element('path', {d: 'M17,1a8,8 0 0 1 0,16z', fill: palette[1]}));
    addToLegend(impulses ? 'contact of Stage 1 in compression, thick as its impulse' : 'contact of Stage 1', stroke(4));
    if (impulses) addToLegend('the same in tension', stroke(3, '6 3'));
    if (data.grids.length > 1 || data.grids[0].contacts !== 'all')
      addToLegend('contact left out of Stage 1', stroke(1, '2 3'));
    addToLegend(
        'velocity of a copy in the slowest mode, relative',
        element('path', {d: 'M2,9h22', stroke: modeInk, 'stroke-width': 2}),
        element('path', {d: 'M34,9l-10,-5v10z', fill: modeInk}));
  }

  byId('picture-title').textContent = problem ? 'The contact network' : 'The packing';
  byId('picture').hidden = !drawn;
  if (problem) byId('whole').textContent = 'Whole network';
  byId('lead').textContent = `${grainsText(counts.grains)}, ${plural(counts.contacts, 'contact')}, ` +
      `${plural(data.subdomains, 'subdomain')}: the spectral radius ρ of the contraction operator of the two-stage ` +
      'domain decomposition, and the error that it is slowest to remove.' +
      (drawn ? '' : ' The file of this contact problem has no places of bodies or contacts: there is no picture.');
  addSets();
  addFacts();
  addLayers();
  if (drawn) listen(scene, byId('scene'), describe);
  for (const id of ['epsilon', 'eta'])
    byId(id).addEventListener('input', (event) => go({[id]: Number(event.target.value)}));
  byId('go-best').addEventListener('click', () => {
    const best = Math.log(grid().best[state.epsilon].eta), far = (h) => Math.abs(Math.log(eta[h]) - best);
    go({eta: [...eta.keys()].filter((h) => eta[h] < Infinity).reduce((a, b) => (far(b) < far(a) ? b : a), 0)});
  });
  byId('numbers').addEventListener('toggle', fillTable);
  byId('picture').addEventListener('submit', (event) => event.preventDefault());
  new ResizeObserver(drawCurves).observe(byId('figures'));
  go({grid: 0, epsilon: Math.floor(epsilon.length / 2)});
  if (drawn) scene.whole();
}
