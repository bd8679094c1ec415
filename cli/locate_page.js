// The page of locate --view. Data: one JSON document, made by locate_view.cpp, in #data. A candidate is a list:
// x, y, radius, score, darkness, interior, ring share, index of its verdict, flag.
'use strict';
(() => {
  const data = JSON.parse(document.getElementById('data').textContent);
  const $ = id => document.getElementById(id);
  const sets = data.sets, run = sets[0], verdicts = data.verdicts;
  const verdictOf = word => verdicts.findIndex(v => v.word === word);
  const kBead = verdictOf('bead'), kWrongRadius = verdictOf('wrong radius'), kBright = verdictOf('bright inside'),
        kUnexplained = verdictOf('unexplained'), kOverlaps = verdictOf('overlaps'), kOutside = verdictOf('outside');
  const kRounding = 1e-3;  // px, of the stored radii
  const [X, Y, R, SCORE, DARKNESS, INTERIOR, SHARE, VERDICT, FLAG] = [0, 1, 2, 3, 4, 5, 6, 7, 8];
  const state = {set: 0, frame: 0, sizes: [...run.diameters], score: run.judge.min_score};

  // ---- the judge of the program (imaging/refine/judge.cpp) on the stored candidates ----
  function alone(c, set, sizes, score) {
    const j = set.judge;
    if (!sizes.some(d => Math.abs(c[R] - d / 2) <= j.radius_tolerance * d / 2 + kRounding)) return kWrongRadius;
    if (j.min_interior !== null && c[INTERIOR] < j.min_interior) return kBright;
    if (c[SCORE] < score) return kUnexplained;
    return c[VERDICT] === kOutside ? kOutside : kBead;
  }

  // Of two discs that overlap too far, the one with the larger score stays.
  function forbidOverlaps(list, verdict, set) {
    const among = list.map((c, k) => k).filter(k => verdict[k] === kBead);
    const cell = 2 * among.reduce((most, k) => Math.max(most, list[k][R]), 1), grid = new Map(), clashes = [];
    const place = (i, j) => i + ' ' + j;
    for (const k of among) {
      const c = list[k], i = Math.floor(c[X] / cell), j = Math.floor(c[Y] / cell);
      for (let u = i - 1; u <= i + 1; ++u)
        for (let v = j - 1; v <= j + 1; ++v)
          for (const other of grid.get(place(u, v)) || []) {
            const o = list[other];
            if (Math.hypot(c[X] - o[X], c[Y] - o[Y]) >= c[R] + o[R] - set.judge.max_overlap * Math.min(c[R], o[R])) continue;
            clashes.push(c[SCORE] > o[SCORE] ? [k, other] : [other, k]);
          }
      const here = grid.get(place(i, j));
      if (here) here.push(k); else grid.set(place(i, j), [k]);
    }
    clashes.sort((a, b) => list[b[0]][SCORE] - list[a[0]][SCORE] || a[1] - b[1]);
    for (const [better, lesser] of clashes) if (verdict[better] === kBead) verdict[lesser] = kOverlaps;
  }

  // Candidates that were dropped for a reason that the sliders do not change keep their verdict.
  function findFixed(set) {
    set.fixed = set.frames.map(list => {
      const own = list.map(c => alone(c, set, set.diameters, set.judge.min_score));
      const fixed = list.map((c, k) => c[VERDICT] !== kBead && c[VERDICT] !== own[k] && !(c[VERDICT] === kOverlaps && own[k] === kBead));
      // Dropped by the evidence of the picture, which is examined only if no diameter is stated.
      const unlike = list.map((c, k) => set.judge.drop_outliers && c[VERDICT] === kUnexplained && own[k] === kBead);
      const again = own.map((v, k) => fixed[k] ? list[k][VERDICT] : v);
      forbidOverlaps(list, again, set);
      list.forEach((c, k) => { if (c[VERDICT] === kOverlaps && again[k] === kBead) fixed[k] = true; });
      return {fixed, unlike};
    });
  }
  sets.forEach(findFixed);

  const same = (a, b) => a.length === b.length && a.every((d, k) => Math.abs(d - b[k]) < 0.005);
  // Otherwise the command states the discs: another score alone would change the choice of the settings.
  const asInRun = () => state.set === 0 && same(state.sizes, run.diameters) && state.score === run.judge.min_score;

  function judged(set, frame) {
    const list = set.frames[frame], {fixed, unlike} = set.fixed[frame];
    // At the settings of a set and its score, what the program said.
    if (same(state.sizes, set.diameters) && state.score === set.judge.min_score) return list.map(c => c[VERDICT]);
    const released = k => unlike[k] && !asInRun();
    const verdict = list.map((c, k) => fixed[k] && !released(k) ? c[VERDICT] : alone(c, set, state.sizes, state.score));
    forbidOverlaps(list, verdict, set);
    return verdict;
  }

  // ---- drawing ----
  const svgOf = (name, attributes, parent) => {
    const element = document.createElementNS('http://www.w3.org/2000/svg', name);
    for (const key in attributes) element.setAttribute(key, attributes[key]);
    if (parent) parent.append(element);
    return element;
  };
  function words(c, verdict, set) {
    const v = verdicts[verdict], limit = verdict === kWrongRadius ? ` (sizes ${state.sizes.map(d => d.toFixed(2)).join(', ')} px ± ${(100 * set.judge.radius_tolerance).toFixed(0)} %)`
      : verdict === kUnexplained && c[SCORE] < state.score ? ` (score below ${state.score})` : '';
    return `${v.word}: ${v.meaning}${limit}${c[FLAG] ? ', ' + c[FLAG] : ''}; x ${c[X]}, y ${c[Y]} px, diameter ${(2 * c[R]).toFixed(2)} px, ` +
      `score ${c[SCORE]}, darkness ${c[DARKNESS]}, interior ${c[INTERIOR]}, ring share ${c[SHARE]}`;
  }
  function classOf(c, verdict) {
    const now = verdict === kBead, then = c[VERDICT] === kBead;
    if (state.set !== 0 || now === then) return now ? 'kept' : 'dropped';
    return now ? 'gained' : 'lost';
  }
  const classWords = {kept: 'bead', dropped: 'dropped', gained: 'kept now, dropped in the run', lost: 'dropped now, a bead in the run'};

  function drawFrame(verdict) {
    const f = data.frames[state.frame], set = sets[state.set], svg = $('picture');
    svg.replaceChildren();
    svg.setAttribute('viewBox', `${f.x - 0.5} ${f.y - 0.5} ${f.width} ${f.height}`);
    svg.style.width = 100 * Number($('zoom').value) + '%';
    svg.style.maxHeight = $('zoom').value === '1' ? '41rem' : 'none';
    svgOf('image', {class: 'raw', href: $('layer-residual').checked ? f.residual : f.picture, x: f.x - 0.5, y: f.y - 0.5, width: f.width, height: f.height, preserveAspectRatio: 'none'}, svg);
    const dropped = svgOf('g', {}, svg), kept = svgOf('g', {}, svg), counts = {};
    set.frames[state.frame].forEach((c, k) => {
      const kind = classOf(c, verdict[k]), isKept = verdict[k] === kBead;
      counts[kind] = (counts[kind] || 0) + 1;
      if (!$(isKept ? 'layer-kept' : 'layer-dropped').checked) return;
      const circle = svgOf('circle', {class: kind, cx: c[X], cy: c[Y], r: c[R], 'data-verdict': verdicts[verdict[k]].word}, isKept ? kept : dropped);
      svgOf('title', {}, circle).textContent = words(c, verdict[k], set);
    });
    const why = {};
    verdict.forEach(v => { if (v !== kBead) why[verdicts[v].word] = (why[verdicts[v].word] || 0) + 1; });
    $('key').replaceChildren(...Object.keys(classWords).filter(kind => counts[kind]).map(kind => {
      const item = document.createElement('span'), mark = document.createElement('i');
      item.className = 'keyed';
      mark.className = kind;
      item.append(mark, `${counts[kind]} ${classWords[kind]}`);
      return item;
    }), Object.keys(why).length ? 'Reasons: ' + Object.keys(why).map(w => `${w} ${why[w]}`).join(', ') : '');
    $('frame-label').textContent = `frame ${f.number}`;
  }

  function histogram(id, values, kept, limits, low, high, name) {
    const wide = 460, tall = 120, left = 44, below = 22, n = 40, svg = $(id), span = high - low || 1;
    const bars = Array.from({length: n}, () => [0, 0]);
    values.forEach((v, k) => { if (v >= low && v <= high) bars[Math.min(n - 1, Math.floor(n * (v - low) / span))][kept[k] ? 0 : 1]++; });
    const most = Math.max(1, ...bars.map(b => b[0] + b[1]));
    svg.replaceChildren();
    svg.setAttribute('viewBox', `0 0 ${left + wide + 8} ${tall + below + 6}`);
    svg.setAttribute('aria-label', `histogram of the ${name}: ${kept.filter(Boolean).length} kept, ${kept.filter(k => !k).length} dropped`);
    const x = v => left + wide * (v - low) / span, y = count => 6 + tall * (1 - count / most);
    bars.forEach(([a, b], k) => {
      const at = {x: left + wide * k / n, width: wide / n - 1};
      if (a) svgOf('rect', {...at, class: 'bar-kept', y: y(a), height: y(0) - y(a)}, svg);
      if (b) svgOf('rect', {...at, class: 'bar-dropped', y: y(a + b), height: y(a) - y(a + b)}, svg);
    });
    svgOf('line', {x1: left, x2: left + wide, y1: y(0), y2: y(0)}, svg);
    for (const v of limits) if (v >= low && v <= high) svgOf('line', {class: 'limit', x1: x(v), x2: x(v), y1: 6, y2: y(0)}, svg);
    for (let k = 0; k <= 4; ++k) svgOf('text', {x: x(low + span * k / 4), y: tall + below, 'text-anchor': k === 4 ? 'end' : 'middle'}, svg).textContent = +(low + span * k / 4).toPrecision(3);
    svgOf('text', {x: left - 4, y: 16, 'text-anchor': 'end'}, svg).textContent = most;
    svgOf('text', {x: left - 4, y: y(0), 'text-anchor': 'end'}, svg).textContent = 0;
  }

  function command() {
    const set = sets[state.set];
    const discs = asInRun() ? data.given : ` --diameter ${state.sizes.map(d => d.toFixed(2)).join(' ')} --${set.bright ? 'bright' : 'dark'} --refine ${set.refine}`;
    return data.command + discs + (state.score === data.usual_score ? '' : ` --min-explained ${state.score}`);
  }

  function draw() {
    const set = sets[state.set], verdict = data.frames.map((f, k) => judged(set, k));
    const all = set.frames.flat(), kept = verdict.flat().map(v => v === kBead);
    drawFrame(verdict[state.frame]);
    const diameters = all.map(c => 2 * c[R]), tolerance = set.judge.radius_tolerance;
    const limits = state.sizes.flatMap(d => [d * (1 - tolerance), d, d * (1 + tolerance)]);
    const ends = diameters.concat(limits);
    histogram('histogram-diameter', diameters, kept, limits, ends.reduce((a, b) => Math.min(a, b)), ends.reduce((a, b) => Math.max(a, b)), 'diameters');
    histogram('histogram-score', all.map(c => c[SCORE]), kept, [state.score], 0, 1, 'scores');
    const before = run.frames.flat().filter(c => c[VERDICT] === kBead).length, now = kept.filter(Boolean).length;
    $('count').textContent = `${now} beads in the frames of this page; the run found ${before}.`;
    $('command').textContent = command();
    $('score-label').textContent = state.score.toFixed(2);
    $('polarity').value = set.bright ? 'bright' : 'dark';
    for (const row of document.querySelectorAll('#tried tr[data-set]')) row.classList.toggle('chosen', Number(row.dataset.set) === state.set);
    document.body.dataset.kept = now;
  }

  // ---- controls ----
  const everySize = sets.flatMap(s => s.diameters);
  const range = [Math.max(3, 0.5 * Math.min(...everySize)), Math.min(400, 2 * Math.max(...everySize))];
  // The first slider stays where it is dragged from.
  function sizeSliders(keepFirst) {
    const first = keepFirst ? [...$('sizes').children].slice(0, 1) : [];
    $('sizes').replaceChildren(...state.sizes.map((d, k) => {
      if (k < first.length) return first[0];
      const line = document.createElement('div'), label = document.createElement('label'), slider = document.createElement('input'), out = document.createElement('output');
      line.className = 'controls';
      Object.assign(slider, {type: 'range', min: range[0].toFixed(2), max: range[1].toFixed(2), step: '0.01', id: `size-${k}`});
      slider.value = d;
      out.textContent = d.toFixed(2) + ' px';
      label.append(k ? `diameter ${k + 1} ` : 'diameter ', slider);
      line.append(label, out);
      slider.addEventListener('input', () => {
        state.sizes[k] = Number(slider.value);
        out.textContent = state.sizes[k].toFixed(2) + ' px';
        if (k === 0) takeNearestSet();
        draw();
      });
      return line;
    }));
  }
  // Beyond the tolerance of a set, the candidates of the nearest set of that polarity are shown, if it is nearer.
  function takeNearestSet() {
    const d = state.sizes[0], away = s => Math.abs(Math.log(d / s.diameters[0])), now = sets[state.set];
    if (Math.abs(d - now.diameters[0]) <= now.judge.radius_tolerance * now.diameters[0]) return;
    let best = state.set;
    sets.forEach((s, k) => { if (s.bright === now.bright && away(s) < away(sets[best]) - 1e-9) best = k; });
    if (best === state.set) return;
    state.set = best;
    state.sizes = [d, ...sets[best].diameters.slice(1)];
    sizeSliders(true);
  }
  function choose(k, score) {
    Object.assign(state, {set: k, sizes: [...sets[k].diameters]});
    if (score !== undefined) state.score = score;
    $('score').value = state.score;
    sizeSliders();
    draw();
  }
  $('frame').max = data.frames.length - 1;
  $('frame').addEventListener('input', () => { state.frame = Number($('frame').value); draw(); });
  $('score').addEventListener('input', () => { state.score = Number($('score').value); draw(); });
  $('polarity').addEventListener('change', () => choose(Math.max(0, sets.findIndex(s => s.bright === ($('polarity').value === 'bright')))));
  $('reset').addEventListener('click', () => choose(0, run.judge.min_score));
  for (const id of ['zoom', 'layer-kept', 'layer-dropped', 'layer-residual']) $(id).addEventListener('change', draw);
  $('picture').addEventListener('mouseover', event => {
    const circle = event.target.closest('circle');
    if (circle) $('readout').textContent = circle.querySelector('title').textContent;
  });
  for (const row of document.querySelectorAll('#tried tr[data-set]')) {
    row.classList.add('choosable');
    row.tabIndex = 0;
    row.addEventListener('click', () => choose(Number(row.dataset.set)));
    row.addEventListener('keydown', event => { if (event.key === 'Enter') choose(Number(row.dataset.set)); });
  }
  $('copy').addEventListener('click', () => {
    // A page from a file has no clipboard interface in every browser, so the selection is copied.
    getSelection().selectAllChildren($('command'));
    $('copied').textContent = document.execCommand('copy') ? 'copied' : 'selected; copy it with the keyboard';
  });
  document.body.classList.add('live');
  $('readout').textContent = 'Point at a circle for its numbers and its verdict.';
  choose(0, run.judge.min_score);
  document.body.dataset.ready = 'yes';
})();
