// SPDX-License-Identifier: GPL-3.0-or-later
// The page of a run: force chains of the steps drawn, indicators over iterations and steps, energies, contacts.

const indicators = [
  {column: 'natural_map', name: 'natural map', colour: '#0050a0', mark: 'round'},
  {column: 'zeta', name: 'ζ', colour: '#9a5b00', dash: '7 3', mark: 'square'},
  {column: 'gluing', name: 'gluing', colour: '#5c2a80', dash: '2 3', mark: 'open'},
  {column: 'interface_change', name: 'interface change', colour: '#00664c', dash: '9 3 2 3', mark: 'triangle'},
  {column: 'quad_dv', name: 'Quad/DV', colour: '#a0246e', dash: '12 3', mark: 'round'},
  {column: 'mean_dv_over_r', name: '|mean DV over r|', colour: '#545454', dash: '4 4', mark: 'square'},
  // Drawn only if it ends the iterations.
  {column: 'quad_dvr', name: 'Quad/DVR', colour: '#000000', mark: 'open', criterion: true},
  {column: 'qm_16', name: 'QM/16', colour: '#000000', mark: 'open', criterion: true},
  {column: 'normal_change', name: 'Σ|Δrₙ|/Σrₙ', colour: '#000000', mark: 'open', criterion: true},
];

function showRun() {
  const space = data.dimension === 3, grain = space ? 'sphere' : 'disk', Grain = space ? 'Sphere' : 'Disk';
  const radius = unpacked(data.disks.radius), mass = unpacked(data.disks.mass), {solver} = data;
  const summary = Object.fromEntries(data.summary.map((column) => [column.name, column.values]));
  const iterations = Object.fromEntries(data.iterations.map((column) => [column.name, column.values]));
  const shown = data.steps.map(opened);
  const colours = coloursOf(
      data.subdomains, radius.length * shown.length,
      (k) => shown[Math.floor(k / radius.length)].holders[k % radius.length]);
  const full = fullThickness(), jam = '#c8009a';  // of the contacts of a step without a solution
  // The directions along which boundaries move freely; a body, such as a clump, has all of them.
  const directions = ['x', 'y', 'z', 'spin_x', 'spin_y', 'spin'];
  const free = data.free.map((along) => directions.filter((_, k) => along[k]));
  const isBody = (boundary) => free[boundary].length === (space ? 6 : 3);
  const picture = {
    x: shown[0].x,
    y: shown[0].y,
    z: shown[0].z,
    space,
    radius,
    colours,
    walls: [],
    lines: [],
    arrows: null,
    holders: (i) => shown[place].holders[i],
    special: (i) => data.disks.driven_by[i] >= 0 && !isBody(data.disks.driven_by[i])
  };
  let place = shown.length - 1, timer = 0;

  byId('figures').append(byId('run').content);
  const scene = createScene(byId('scene'), picture);
  byId('scene').setAttribute('aria-label', `Picture of ${plural(radius.length, grain)} and their force chains`);

  // A step with its arrays, and the subdomains that hold each disk: those of its contacts.
  function opened(step) {
    const contacts = Object.fromEntries(Object.entries(step.contacts).map(([key, array]) => [key, unpacked(array)]));
    const holders = Array.from(radius, () => []);
    for (let k = 0; k < contacts.a.length; ++k)
      for (const body of [contacts.a[k], contacts.b[k]]) {
        const e = solver.decomposes ? contacts.subdomain[k] : 0;
        if (body < radius.length && !holders[body].includes(e)) holders[body].push(e);
      }
    return {
      step: step.step,
      time: step.time,
      x: unpacked(step.x),
      y: unpacked(step.y),
      z: space ? unpacked(step.z) : new Float32Array(radius.length),
      walls: step.walls,
      contacts,
      holders
    };
  }

  // The thickest line stands for the impulse that one contact in a hundred exceeds, over all steps drawn.
  function fullThickness() {
    const all = shown.flatMap(({contacts}) => Array.from(contacts.normal, Math.abs)).sort((a, b) => a - b);
    return all.length ? all[Math.floor(0.99 * (all.length - 1))] || 1 : 1;
  }

  function showChains() {
    const {contacts: c, x, y, z, walls} = shown[place], d = data.dimension;
    const centre = (i) => [x[i], y[i], z[i]], point = (k) => [...c.point.subarray(d * k, d * k + d), 0].slice(0, 3);
    const ends = (k) => {
      const from = centre(c.a[k]);
      return [...from, ...nearestImage(from, c.b[k] < radius.length ? centre(c.b[k]) : point(k))];
    };
    const size = (k) => Math.abs(c.normal[k]) / full;
    const numbers = Array.from(c.a.keys()), pulls = (k) => c.normal[k] < 0, slides = (k) => c.status[k] >= 2;
    Object.assign(picture, {
      x,
      y,
      z,
      walls,
      lines: [
        ...lineGroups(numbers.filter((k) => !pulls(k) && !slides(k)), ends, size, {colour: ink}),
        ...lineGroups(numbers.filter((k) => !pulls(k) && slides(k)), ends, size, {colour: '#8a1c00', dash: [6, 3]}),
        ...lineGroups(numbers.filter(pulls), ends, size, {colour: '#0050a0', dash: [2, 2]}),
        ...lineGroups(numbers.filter((k) => c.stress[k] > 0), ends, (k) => c.stress[k], {colour: jam}),
      ]
    });
    scene.changed();
  }

  function describe(i) {
    const held = shown[place].holders[i], driver = data.disks.driven_by[i];
    const kind = driver < 0 ? `mass ${told(mass[i])} kg` :
        isBody(driver) ? `${grain} of body ${data.boundaries[driver]}` :
                         `${grain} of boundary ${data.boundaries[driver]}`;
    const where = !solver.decomposes ? '' :
        held.length === 0            ? ', carries nothing' :
        held.length === 1            ? `, subdomain ${held[0]}` :
                                       `, shared by subdomains ${held.join(', ')}`;
    return `${Grain} ${i}: ${kind}, radius ${told(radius[i])} m${where}`;
  }

  // Older trajectories lack these columns. `closing`: if it is proved that the step has no solution.
  const lacksRoom = (row) => (summary.no_room?.[row] ?? 0) > 0, closing = (row) => summary.closing_speed?.[row] ?? null;
  const endsHere = () => place === shown.length - 1 && data.ended.startsWith('impossible: ');
  const rowOf = (step) => summary.step.indexOf(step);
  const overSteps = (column, scaled = (v) => v) =>
      summary.step.map((step, row) => [step, scaled(summary[column][row])]);
  const has = (column) => summary[column].some((value) => value !== null && value !== 0);
  const fromZero = (...columns) => [0, 1.05 * Math.max(1, most(columns.flatMap((column) => summary[column])))];
  const criterion = indicators.find(({column}) => column === solver.criterion)?.name;
  const drawn = indicators.filter((one) => !one.criterion || one.column === solver.criterion);
  const tolerance = criterion ? [[solver.tolerance, `tolerance of ${criterion}`]] : [];

  const size = (v) => (v === null ? null : Math.abs(v));  // mean DV over r has a sign

  function drawIterations(step) {
    const rows = (iterations.step ?? []).map((s, row) => (s === step ? row : -1)).filter((row) => row >= 0);
    byId('iterations').hidden = rows.length === 0;
    byId('no-iterations').textContent = rows.length ?
        '' :
        iterations.step ?
        'The table of iterations has no row of this step.' :
        'The iterations were not recorded, or not handed over: nscdd simulate --convergence FILE writes them, and ' +
            'nscdd report --convergence FILE shows them here.';
    if (!rows.length) return;
    const series =
        drawn.filter(({column}) => rows.some((row) => size(iterations[column][row]) > 0))
            .map((one) => ({
                   ...one,
                   points: rows.map((row) => [iterations.iteration[row], size(iterations[one.column][row])])
                 }));
    drawChart(byId('iterations'), {
      label: `Indicators over the iterations of step ${step}`,
      x: {kind: 'log', label: 'iteration'},
      y: {kind: 'log', label: 'indicator'},
      series,
      rules: tolerance,
      rulesLeft: true
    });
  }

  function draw() {
    const {step} = shown[place], x = {kind: 'linear', label: 'step', whole: true}, marker = [step];
    const pick = (value) => go(nearest(value));
    drawIterations(step);
    drawChart(byId('criteria'), {
      label: 'Indicators at the end of each step',
      x,
      y: {kind: 'log', label: 'indicator'},
      series: drawn.filter(({column}) => summary[column].some((v) => size(v) > 0))
                  .map((one) => ({...one, points: overSteps(one.column, size)})),
      marker,
      pick,
      rules: tolerance,
      rulesLeft: true
    });
    drawChart(byId('effort'), {
      label: 'Iterations of each step',
      x,
      y: {kind: 'linear', label: 'iterations', range: fromZero('iterations')},
      series: [{name: 'iterations', points: overSteps('iterations'), colour: '#0050a0', mark: 'round'}],
      marker,
      pick
    });
    let work = 0, lost = 0;
    const sumWork = overSteps('boundary_work', (v) => (work += v ?? 0));
    const sinceFirst = (v) => (v === null ? null : v - summary.potential[0]);
    const sumLost = overSteps('dissipation', (v) => (lost += v ?? 0));
    drawChart(byId('energy'), {
      label: 'Energies over the steps',
      x,
      y: {kind: 'linear', label: 'J'},
      marker,
      pick,
      series: [
        {name: 'kinetic', points: overSteps('kinetic'), colour: '#0050a0', mark: 'round'},
        ...(has('potential') ? [{
          name: 'potential, since step 1',
          points: overSteps('potential', sinceFirst),
          colour: '#00664c',
          dash: '9 3 2 3',
          mark: 'triangle'
        }] :
                               []),
        {name: 'work of boundaries so far', points: sumWork, colour: '#9a5b00', dash: '7 3', mark: 'square'},
        {name: 'dissipated so far', points: sumLost, colour: '#5c2a80', dash: '2 3', mark: 'open'}
      ]
    });
    drawChart(byId('contacts'), {
      label: 'Contacts over the steps',
      x,
      marker,
      pick,
      y: {kind: 'linear', label: 'contacts', range: fromZero('active', 'stick', 'slide')},
      series: [
        {name: 'with an impulse', points: overSteps('active'), colour: '#0050a0', mark: 'round'},
        {name: 'stick', points: overSteps('stick'), colour: '#00664c', dash: '9 3 2 3', mark: 'triangle'},
        {name: 'slide', points: overSteps('slide'), colour: '#9a5b00', dash: '7 3', mark: 'square'}
      ]
    });
  }

  const nearest = (step) => [...shown.keys()].reduce(
      (a, b) => (Math.abs(shown[b].step - step) < Math.abs(shown[a].step - step) ? b : a));

  function stepText() {
    const {step, contacts} = shown[place], row = rowOf(step);
    const proof =
        (closing(row) === null ? '' : ` No solution exists: contacts that jam close at ${told(closing(row))} m/s.`) +
        (endsHere() ? ` The run ended in ${data.ended.slice(12)}.` : '');
    if (row < 0) return 'This is the state that the run began with. It has no contacts yet.' + proof;
    const carrying = contacts.normal.filter((r) => r !== 0).length, narrow = lacksRoom(row) && closing(row) === null;
    const how = {
      converged: 'its criteria are met',
      stalled: 'the criterion no longer fell',
      maximum_reached: 'the iterations allowed were used up'
    }[data.status[row]] ??
        data.status[row];
    return `${plural(summary.iterations[row], 'iteration')}; ${how}. Natural map ${told(summary.natural_map[row], 3)}` +
        `${summary.gluing[row] ? ', gluing ' + told(summary.gluing[row], 3) : ''}. ` +
        `${plural(carrying, 'contact')} of ${summary.contacts[row]} carry an impulse, ${summary.slide[row]} slide. ` +
        `Largest overlap ${told(summary.overlap_maximum[row], 3)} m.` +
        `${narrow ? ' Contacts close although impulses have grown: the boundaries may leave no room.' : ''}` + proof;
  }

  function go(next) {
    place = next;
    const {step, time} = shown[place], words = `step ${step}, ${told(time)} s`;
    Object.assign(byId('step'), {max: shown.length - 1, value: place, disabled: shown.length < 2});
    byId('step').setAttribute('aria-valuetext', words);
    byId('step-value').textContent = words;
    byId('step-text').textContent = stepText();
    const row = rowOf(step);
    const wrong = row >= 0 && (data.status[row] !== 'converged' || lacksRoom(row));
    byId('result').classList.toggle('diverges', wrong || endsHere());
    draw();
    showChains();
  }

  // Who asks for less motion gets one step a second.
  function play() {
    const playing = timer === 0, calm = matchMedia('(prefers-reduced-motion: reduce)').matches;
    clearInterval(timer);
    timer = playing ? setInterval(() => go((place + 1) % shown.length), calm ? 1000 : 250) : 0;
    byId('play').setAttribute('aria-pressed', playing);
    byId('result').setAttribute('aria-live', playing ? 'off' : 'polite');  // not four texts a second
    byId('play').textContent = playing ? 'Stop' : 'Play';
  }

  function addLegend() {
    const stroke = (width, colour, dash) => element(
        'line',
        {x1: 1, y1: 9, x2: 34, y2: 9, stroke: colour, 'stroke-width': width, 'stroke-dasharray': dash ?? 'none'});
    const disk = (fill, width = 1) =>
        element('circle', {cx: 17, cy: 9, r: 7, fill, stroke: ink, 'stroke-width': width});
    addSwitch(scene, 'contacts', 'force chains');
    if (colours.length > 1) addSwitch(scene, 'labels', 'numbers of subdomains');
    if (colours.length > 1) addSwitch(scene, 'hatching', 'hatching');
    addSpaceTools(scene, 40);
    addToLegend('compression, sticks', stroke(5, ink));
    addToLegend('compression, slides', stroke(4, '#8a1c00', '6 3'));
    addToLegend('tension', stroke(4, '#0050a0', '2 2'));
    if (shown.some(({contacts}) => contacts.stress.some((s) => s > 0)))
      addToLegend('a step has no solution: self-stress of the contacts that jam', stroke(5, jam));
    addToLegend(colours.length > 1 ? `${grain}, coloured and hatched by subdomain` : grain, disk(palette[0]));
    if (colours.length > 1) addToLegend(`shared ${grain}: thick rim`, disk(palette[0], 3));
    addToLegend(`${grain} of a boundary, or one that carries nothing`, disk(idle));
  }

  function addFacts() {
    const list = byId('facts'), drivers = data.disks.driven_by.filter((boundary) => boundary >= 0);
    const inBodies = drivers.filter(isBody).length, bodies = free.filter((_, boundary) => isBody(boundary)).length;
    fact(
        list, Grain + 's',
        `${radius.length - drivers.length} free, ${
            bodies ? `${inBodies} of ${plural(bodies, 'body', 'bodies')}, ` :
                     ''}${drivers.length - inBodies} of boundaries`);
    const named = data.boundaries.map((name, k) => (free[k].length ? `${name} (free: ${free[k].join(', ')})` : name));
    fact(list, 'Boundaries', named.filter((_, k) => !isBody(k)).join(', ') || 'none');
    fact(
        list, 'Algorithm',
        solver.algorithm + (solver.decomposes ? `, ${plural(colours.length, 'subdomain')}` : ', undivided'));
    fact(
        list, 'Criterion',
        !criterion ? 'none: every step makes all its iterations' :
                     `${criterion} to ${told(solver.tolerance)}` +
                (solver.decomposes ? `, gluing to ` + told(solver.gluing_tolerance) : ''));
    const each = summary.step.length ? `, of ${told(summary.time.at(-1) / summary.step.length)} s` : '';
    fact(list, 'Steps', `${summary.step.length}${each}`);
    fact(list, 'How it ended', data.ended);
    const converged = data.status.filter((status) => status === 'converged').length;
    fact(list, 'Steps that converged', `${converged} of ${data.status.length}`);
    const narrow = data.status.filter((_, row) => lacksRoom(row)).length;
    if (narrow)
      fact(
          list, 'Steps that may have no room',
          `${narrow} of ${data.status.length}: contacts close although impulses have grown far beyond what drives the ` +
              'step; no impulses may be a solution, and more iterations do not help');
    fact(list, 'Iterations in all', String(summary.iterations.reduce((sum, n) => sum + n, 0)));
    byId('left-out').textContent = `Left out: ${
                                       shown.length < data.kept ?
                                           `the pictures of ${data.kept - shown.length} ` +
                                               `of the ${data.kept} steps that the trajectory keeps, ` :
                                           ''}contacts without an impulse, rotations and velocities. ` +
        'Coordinates and impulses have seven digits.';
  }

  byId('picture-title').textContent = 'Force chains';
  byId('lead').textContent =
      `A run of ${plural(summary.step.length, 'step')} with ${plural(radius.length, grain)}: how ` +
      'its steps converged, and the impulses that they ended with.';
  addLegend();
  addFacts();
  listen(scene, byId('scene'), describe);
  byId('step').addEventListener('input', (event) => go(Number(event.target.value)));
  byId('play').addEventListener('click', play);
  byId('play').disabled = shown.length < 2;
  new ResizeObserver(draw).observe(byId('figures'));
  go(place);
  scene.whole();
}
