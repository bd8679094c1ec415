// The interactive half of the report. Data: one JSON document, made by report_data.cpp, in #data.
// Two things are drawn: graphs (plotly) and beads (SVG in camera pixels, pixel centres at whole numbers).
'use strict';
(() => {
  const data = JSON.parse(document.getElementById('data').textContent);
  const $ = id => document.getElementById(id);
  const runs = data.runs, matches = data.matches;

  // Okabe and Ito's colours; every colour has a shape or a dash of its own as well.
  const phaseColour = {'co-moving': '#0072B2', bouncing: '#E69F00', convecting: '#D55E00', undetermined: '#9A9A9A'};
  const onsetColour = {bouncing: '#0072B2', convecting: '#D55E00'};  // as in the figures for print
  const phaseSymbol = {'co-moving': 'circle', bouncing: 'square', convecting: 'triangle-up', undetermined: 'x-thin'};
  // Colours of the theme, from page.css: light, dark, or as the system says.
  const themed = name => getComputedStyle(document.documentElement).getPropertyValue('--' + name).trim();
  const sideColour = {};
  const structures = [['undefined', '#FFFFFF', 'under 2 bonds'], ['hexagonal', '#009E73', 'hexagonal'],
                      ['square', '#D55E00', 'square'], ['other', '#E8E0C8', 'other']];
  const coordinations = {0: ['#FFFFFF', 'at a surface'], 5: ['#0072B2', '5 neighbours'], 6: ['#E8E0C8', '6'], 7: ['#D55E00', '7'], other: ['#CC79A7', 'other']};
  const viridis = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];
  function viridisAt(x) {
    const y = 4 * Math.min(1, Math.max(0, x)), i = Math.min(3, Math.floor(y)), w = y - i;
    return 'rgb(' + [0, 1, 2].map(c => Math.round((1 - w) * viridis[i][c] + w * viridis[i + 1][c])).join(',') + ')';
  }

  // ---- graphs ----
  const base = () => ({font: {family: 'system-ui, "Segoe UI", Helvetica, Arial, sans-serif', size: 13, color: themed('ink')},
                margin: {l: 58, r: 12, t: 32, b: 46}, paper_bgcolor: themed('paper'), plot_bgcolor: themed('paper'), hovermode: 'closest',
                hoverlabel: {bgcolor: themed('faint'), font: {color: themed('ink')}},
                legend: {orientation: 'h', y: -0.18, yanchor: 'top', x: 0}});
  const axis = (title, more) => Object.assign(
    {title: {text: title, standoff: 8}, gridcolor: themed('grid'), linecolor: themed('quiet'), zeroline: false, ticks: 'outside', showline: true, automargin: true}, more);
  const plain = text => String(text).replace(/[&<>%]/g, c => `&#${c.charCodeAt(0)};`);  // Plotly's text has tags and %{...}
  function graph(id, traces, layout) {
    const config = {responsive: true, displaylogo: false, modeBarButtonsToRemove: ['select2d', 'lasso2d', 'autoScale2d'],
                    toImageButtonOptions: {format: 'svg', filename: id}};
    return Plotly.react(id, traces, Object.assign(base(), layout), config);
  }
  const interval = r => r && r.interval ? [r.value - r.interval.low, r.interval.high - r.value] : [0, 0];
  const present = r => r && r.value !== undefined && r.value !== null;

  function niceKm(omega2, low, high) {  // K_m = Gamma^2/omega^2: marks at whole numbers of it, at their Gamma
    const top = high * high / omega2, step = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100].find(s => top / s <= 7) || 200;
    const marks = [];
    for (let k = 0; k <= top; k += step) if (Math.sqrt(k * omega2) >= low) marks.push(Math.round(k / step) * step);
    return {tickvals: marks.map(k => Math.sqrt(k * omega2)), ticktext: marks.map(k => String(+k.toPrecision(3)))};
  }

  // The onsets that bound the shaded regions: those of a sweep, else of the simulations, else of the experiments.
  function shadingOnsets() {
    for (const fits of [b => b.sweep, b => b.side === 'simulation', () => true]) {
      const some = data.boundaries.filter(fits);
      if (some.length) return some.filter(b => b.of === some[0].of);
    }
    return [];
  }

  // [n_l, low, high] of an onset for every N_l, in order; an open side extends to the edge of the graph.
  const limitsOf = (onsets, kind, y) => onsets.filter(b => b.onset === kind).sort((p, q) => p.n_l - q.n_l).map(b => b.gamma !== null ? [b.n_l, b.low, b.high]
    : [b.n_l, b.below === null ? y[0] : b.below, b.above === null ? y[1] : b.above]);

  // The regions of the phases as shapes. Between them the phase is not determined: the intervals of the onsets stay blank.
  function regions(x, y) {
    const onsets = shadingOnsets(), bounce = limitsOf(onsets, 'bouncing', y), convect = limitsOf(onsets, 'convecting', y);
    // Between the data of several heights, and over the whole graph for one.
    const line = (limits, side) => [[x[0], limits[0][side]], ...limits.map(l => [l[0], l[side]]), [x[1], limits[limits.length - 1][side]]];
    const flat = level => [[x[0], level], [x[1], level]];
    const shapes = [];
    const region = (phase, lower, upper) => shapes.push({type: 'path', layer: 'below', line: {width: 0}, fillcolor: phaseColour[phase], opacity: 0.16,
      path: 'M' + lower.concat([...upper].reverse()).map(p => p.join(',')).join('L') + 'Z'});
    if (bounce.length) region('co-moving', flat(y[0]), line(bounce, 1));
    // Where an onset has no lower end, the phase below it is not known.
    const atLeast = (limits, least) => limits.map((l, i) => [l[0], Math.max(l[1], least.length === limits.length ? least[i][2] : l[1]), l[2]]);
    if (bounce.length && convect.length) region('bouncing', line(bounce, 2), line(atLeast(convect, bounce), 1));
    if (convect.length) region('convecting', line(convect, 2), flat(y[1]));
    return {shapes, of: onsets.length ? onsets[0].of : ''};
  }

  // Runs at one N_l and Gamma lie side by side: the experiments to the left, the simulations to the right. Offsets in units of N_l.
  // A group is at most `widest` wide.
  function spread(most, widest) {
    const groups = new Map(), offset = runs.map(() => 0);
    runs.forEach((r, i) => {
      const key = `${r.n_l.toPrecision(2)} ${r.gamma.toFixed(2)}`;
      groups.set(key, (groups.get(key) || []).concat(i));
    });
    for (const group of groups.values()) {
      group.sort((a, b) => (runs[a].side > runs[b].side) - (runs[a].side < runs[b].side) || a - b);
      const step = Math.min(most, widest / Math.max(1, group.length - 1));
      group.forEach((i, k) => { offset[i] = (k - (group.length - 1) / 2) * step; });
    }
    return offset;
  }

  function drawDiagram() {
    const all = runs.concat(data.sweep), nl = all.map(r => r.n_l).concat(data.boundaries.map(b => b.n_l)), gammas = all.map(r => r.gamma);
    const ends = data.boundaries.filter(b => b.gamma !== null).flatMap(b => [b.low, b.high]);
    const wide = Math.max(4, 0.12 * (Math.max(...nl) - Math.min(...nl)));
    const x = [Math.max(0, Math.min(...nl) - wide), Math.max(...nl) + wide];
    const pixel = (x[1] - x[0]) / Math.max(100, $('phase-diagram').clientWidth - 116);
    // What lies beside a height must not be taken for the next height.
    const heights = [...new Set(nl)].sort((a, b) => a - b), gaps = heights.slice(1).map((h, i) => h - heights[i]).filter(g => g > 0.1 * heights[0]);
    const gap = Math.min(...gaps, Infinity), offset = spread(19 * pixel, 0.45 * gap), aside = Math.min(46 * pixel, 0.36 * gap);
    const low = Math.min(...gammas, ...ends), high = Math.max(...gammas, ...ends), pad = Math.max(0.1, 0.1 * (high - low));
    const y = [Math.max(0, low - pad), high + pad];
    const oneHeight = heights.length < 2 || !gaps.length;
    const traces = [], shaded = regions(oneHeight ? x : [heights[0], heights[heights.length - 1]], y);
    const onsetOf = {bouncing: 'bouncing', convecting: 'convection'};
    for (const kind of ['bouncing', 'convecting'])
      for (const key of new Set(data.boundaries.filter(b => b.onset === kind).map(b => b.of))) {
        const of = data.boundaries.filter(b => b.onset === kind && b.of === key && (b.gamma !== null || b.below !== null || b.above !== null));
        if (!of.length) continue;
        const side = of[0].side, colour = onsetColour[kind], open = side === 'experiment' ? '-open' : '';
        const shift = (of[0].sweep ? 0 : side === 'experiment' ? -1 : 1) * aside;
        const place = b => b.gamma !== null ? b.gamma : b.below !== null ? b.below : b.above;
        traces.push({x: of.map(b => Math.max(x[0], b.n_l + shift)), y: of.map(place), mode: of.length > 1 ? 'lines+markers' : 'markers', name: `onset of ${onsetOf[kind]}, ${plain(key)}`,
          text: of.map(b => b.gamma !== null ? `Γ = ${+b.gamma.toPrecision(3)} [${+b.low.toPrecision(3)}, ${+b.high.toPrecision(3)}]` : b.below !== null ? `Γ above ${b.below}` : `Γ below ${b.above}`),
          hovertemplate: `onset of ${onsetOf[kind]}, ${plain(key)}<br>%{text}<extra></extra>`,
          error_y: {type: 'data', symmetric: false, array: of.map(b => b.gamma !== null ? b.high - b.gamma : 0), arrayminus: of.map(b => b.gamma !== null ? b.gamma - b.low : 0), width: 7, thickness: 1.6, color: colour},
          line: {color: colour, width: 1.4, dash: kind === 'bouncing' ? 'dot' : 'solid'},
          marker: {size: 11, symbol: of.map(b => b.gamma !== null ? (kind === 'bouncing' ? 'diamond' : 'pentagon') + open : b.below !== null ? 'arrow-up' : 'arrow-down'),
                   color: colour, line: {width: 1.5, color: colour}}});
      }
    // The points of a sweep lie at the N_l of its onsets: over their bars.
    for (const start of new Set(data.sweep.map(p => p.start)))
      for (const phase of Object.keys(phaseColour)) {
        const of = data.sweep.filter(p => p.start === start && p.phase === phase);
        if (of.length) traces.push({x: of.map(p => p.n_l), y: of.map(p => p.gamma), mode: 'markers', name: `sweep ${plain(start)}, ${phase}`,
          hovertemplate: `sweep, ${plain(start)}: ${phase}<br>Nₗσ %{x:.3g}, Γ %{y:.4g}<extra></extra>`,
          marker: {size: data.sweep.length > 200 ? 7 : 11, symbol: phaseSymbol[phase] + (phase === 'undetermined' ? '-open' : ''), color: phaseColour[phase],
            line: {width: 1, color: themed('ink')}}});
      }
    const chosen = shown();
    traces.push({x: chosen.map(i => runs[i].n_l + offset[i]), y: chosen.map(i => runs[i].gamma), mode: 'markers', name: 'shown', hoverinfo: 'skip',
      marker: {size: 25, symbol: 'circle-open', color: themed('ink'), line: {width: 2}}});
    for (const side of ['experiment', 'simulation'])
      for (const phase of Object.keys(phaseColour)) {
        const of = runs.map((r, i) => i).filter(i => runs[i].side === side && runs[i].phase === phase);
        if (!of.length) continue;
        const open = side === 'experiment';
        traces.push({x: of.map(i => runs[i].n_l + offset[i]), y: of.map(i => runs[i].gamma), customdata: of,
          mode: 'markers', name: `${side}, ${phase}`, text: of.map(i => plain(runs[i].name)),
          hovertemplate: `${side}: ${phase}<br>%{text}<br>Γ = %{y:.4g}<extra>click to look</extra>`,
          marker: {size: 14, symbol: phaseSymbol[phase] + (open || phase === 'undetermined' ? '-open' : ''), color: phaseColour[phase],
                   line: {width: 2, color: open || phase === 'undetermined' ? phaseColour[phase] : themed('ink')}}});
      }
    const omegas = runs.map(r => r.omega), one = omegas.length > 0 && omegas.every(w => Math.abs(w - omegas[0]) <= 1e-3 * omegas[0]);
    const layout = {height: 480, showlegend: false, xaxis: axis('N<sub>l</sub> σ', {range: x}), yaxis: axis('Γ = A ω² / g', {range: y}), shapes: shaded.shapes,
                    margin: {l: 58, r: one ? 58 : 12, t: 32, b: 46}};
    if (one && runs.length) {
      traces.push({x: [x[0]], y: [y[0]], yaxis: 'y2', mode: 'markers', marker: {opacity: 0}, hoverinfo: 'skip', showlegend: false});
      layout.yaxis2 = axis('K<sub>m</sub> = A² ω² / σ g', Object.assign({overlaying: 'y', side: 'right', range: y, matches: 'y', showgrid: false},
                                                                niceKm(omegas[0] ** 2, Math.max(0, y[0]), y[1])));
    }
    const glyphs = {'co-moving': '●', bouncing: '■', convecting: '▲', undetermined: '×'}, key = $('diagram-key');
    key.replaceChildren();
    const entry = (glyph, colour, text) => {
      const item = document.createElement('span'), mark = document.createElement('b');
      item.className = 'keyed';
      mark.style.color = colour;
      mark.textContent = glyph + ' ';
      item.append(mark, text);
      key.append(item);
    };
    for (const phase of Object.keys(glyphs)) if (all.some(r => r.phase === phase)) entry(glyphs[phase], phaseColour[phase], phase);
    if (data.boundaries.some(b => b.onset === 'bouncing')) entry('◆', onsetColour.bouncing, 'onset of bouncing');
    if (data.boundaries.some(b => b.onset === 'convecting')) entry('⬟', onsetColour.convecting, 'onset of convection');
    $('diagram-words').textContent = (runs.length ? 'Open symbols: experiments. Filled: simulations, which are the twins where they start from the filmed packing; runs at one drive lie side by side. Click one, or use the arrow keys, to show its bed; the ring marks what is shown. ' : '') +
      (data.boundaries.length ? 'Onsets: bar, interval; arrow, the onset lies beyond. ' : '') +
      (shaded.of ? `Shaded: the phases between the onsets of: ${shaded.of}; blank: undecided.` : '');
    $('phase-diagram').setAttribute('aria-label', 'Phase diagram. ' + matches.map(m => `Gamma ${+m.gamma.toPrecision(3)}: ` +
      m.experiments.concat(m.simulations).map(i => `${runs[i].side} ${runs[i].phase}`).join(', ')).join('. '));
    graph('phase-diagram', traces, layout).then(element => {
      element.removeAllListeners('plotly_click');
      element.on('plotly_click', event => {
        const run = event.points.map(p => p.customdata).find(r => r !== undefined && r !== null);
        if (run !== undefined) show(run);
      });
    });
  }

  function drawThresholds() {
    for (const [name, bound, word] of [['s_b', 1 / 30, 'σ/30'], ['s_c', 1, 'σ']]) {
      const gammas = runs.map(r => r.gamma), low = Math.min(...gammas) - 0.1, high = Math.max(...gammas) + 0.1;
      const traces = [{x: [low, high], y: [bound, bound], mode: 'lines', name: word, hoverinfo: 'skip', line: {color: '#D55E00', dash: 'dash', width: 1.5}}];
      for (const side of ['experiment', 'simulation']) {
        const of = runs.map((r, i) => i).filter(i => runs[i].side === side && present(runs[i].results[name]))
          .sort((a, b) => runs[a].gamma - runs[b].gamma);
        const bars = of.map(i => interval(runs[i].results[name])), value = k => runs[of[k]].results[name].value;
        const drawn = v => Math.max(1e-5, v);  // a logarithmic axis cannot show zero
        const starts = new Set(of.map(i => runs[i].start));
        for (const start of starts) {
          const some = of.map((i, k) => k).filter(k => runs[of[k]].start === start);
          traces.push({x: some.map(k => runs[of[k]].gamma), y: some.map(k => drawn(value(k))), customdata: some.map(k => of[k]),
            mode: 'lines+markers', name: starts.size > 1 ? `${side}, ${plain(start)}` : side,
            text: some.map(k => `${side}, ${plain(runs[of[k]].name)}<br>Γ = ${+runs[of[k]].gamma.toPrecision(4)}, ${name} = ${+value(k).toPrecision(4)} σ`),
            hovertemplate: '%{text}<extra></extra>',
            error_y: {type: 'data', symmetric: false, width: 5, thickness: 1.2,
              array: some.map(k => drawn(value(k) + bars[k][1]) - drawn(value(k))), arrayminus: some.map(k => drawn(value(k)) - drawn(value(k) - bars[k][0]))},
            line: {color: sideColour[side], width: 1.2, dash: side === 'experiment' ? 'dash' : 'solid'},
            marker: {size: side === 'experiment' ? 10 : 7, symbol: side === 'experiment' ? 'circle-open' : 'circle', line: {width: 2}, color: sideColour[side]}});
        }
      }
      graph('curve-' + name, traces, {height: 340, xaxis: axis('Γ = A ω² / g', {range: [low, high]}),
        yaxis: axis(name.replace('_', '<sub>') + '</sub> / σ', {type: 'log', exponentformat: 'power', dtick: 1, minor: {ticks: 'outside', ticklen: 3, dtick: 'D1'}})}).then(element =>
          element.on('plotly_click', event => { if (event.points[0].customdata !== undefined) show(event.points[0].customdata); }));
    }
  }

  // ---- the chosen point ----
  const state = {match: 0, experiment: null, simulation: null, moment: 0, playing: null, view: null};
  const shown = () => [state.experiment, state.simulation].filter(i => i !== null);
  const at = m => m.cycle === null ? m.step : m.cycle + m.fraction;

  // The last frame of a run at a phase of a cycle that the other one shows too; without one, its last frame.
  function lastShared(lead, other) {
    const same = (m, o) => m.cycle !== null && m.cycle === o.cycle && Math.abs(m.fraction - o.fraction) < 1e-9;
    const shared = other ? lead.moments.findLastIndex(m => other.moments.some(o => same(m, o))) : -1;
    return Math.max(0, shared >= 0 ? shared : lead.moments.length - 1);
  }

  function show(run) {
    const m = matches.findIndex(x => x.experiments.includes(run) || x.simulations.includes(run));
    const match = matches[m];
    state.match = m;
    state.experiment = match.experiments.includes(run) ? run : match.experiments.length ? match.experiments[0] : null;
    state.simulation = match.simulations.includes(run) ? run : match.simulations.length ? match.simulations[0] : null;
    state.view = null;
    const lead = runs[state.experiment !== null ? state.experiment : state.simulation];
    state.moment = lastShared(lead, state.experiment !== null && state.simulation !== null ? runs[state.simulation] : null);
    $('moment').max = Math.max(0, lead.moments.length - 1);
    $('moment').value = state.moment;
    $('which').value = String(run);
    $('point-title').textContent = `Γ = ${+match.gamma.toPrecision(4)}, Nₗσ = ${+lead.n_l.toPrecision(4)}: ` +
      shown().map(i => `${runs[i].side} ${runs[i].phase}`).join(', ');
    drawMoment();
    drawSeries();
    drawDiagram();
    for (const row of document.querySelectorAll('tr[data-run]')) row.classList.toggle('chosen', shown().includes(Number(row.dataset.run)));
    document.body.dataset.run = run;
  }

  // The place of cell coordinates in both panels, so that they have one scale: in the picture of the experiment, if it has one.
  function commonCamera() {
    const filmed = shown().map(i => runs[i]).find(r => r.camera);
    if (filmed) return filmed.camera;
    let top = 4;
    for (const i of shown()) for (const m of runs[i].moments) for (const z of m.z) if (z !== null) top = Math.max(top, z / 1000 + 1.5);
    const box = runs[shown()[0]].box, width = box[1] - box[0], s = 20;
    top = Math.min(top, 3 * width);
    return {s, ox: s - box[0] * s, oy: (top + 0.5) * s, w: Math.round((width + 2) * s), h: Math.round((top + 2.5) * s)};
  }

  // What both panels show: the common picture, and above it what the beds of both sides need; single beads that fly out of a bed do not count.
  function field(camera) {
    const heights = shown().flatMap(i => runs[i].moments.flatMap(m => m.z.filter(z => z !== null))).sort((a, b) => a - b);
    const top = heights.length ? heights[Math.floor(0.99 * (heights.length - 1))] / 1000 + 0.7 : 0;
    const row = Math.min(-0.5, camera.oy - camera.s * top);
    return [-0.5, row, camera.w, camera.h - 0.5 - row];
  }

  const scales = {q6: [0.3125, 0.7408], psi6: [0, 1]};
  function colourOf(m, i, by) {
    if (by === 'q6' || by === 'psi6') {
      const v = m[by][i];
      return v < 0 ? '#FFFFFF' : viridisAt((v / 100 - scales[by][0]) / (scales[by][1] - scales[by][0]));
    }
    if (by === 'structure') return structures[m.structure[i]][1];
    if (by === 'coordination') return (coordinations[m.coordination[i]] || coordinations.other)[0];
    return 'none';
  }

  const svgNs = 'http://www.w3.org/2000/svg';
  function make(tag, attributes, parent) {
    const element = document.createElementNS(svgNs, tag);
    for (const key in attributes) element.setAttribute(key, attributes[key]);
    if (parent) parent.appendChild(element);
    return element;
  }

  // One circle per bead, its outer edge at the true radius: filled; or, over a camera frame, a ring that leaves the bead in sight.
  function beads(parent, run, m, camera, colour, look) {
    for (let i = 0; i < m.x.length; ++i) {
      if (m.x[i] === null) continue;
      const r = run.radius ? run.radius[i] / 1000 : 0.5, line = look === 'ring' ? 0.4 * r : 0.05;
      const circle = make('circle', {cx: (camera.ox + camera.s * m.x[i] / 1000).toFixed(2), cy: (camera.oy - camera.s * m.z[i] / 1000).toFixed(2),
        r: ((r - line / 2) * camera.s).toFixed(2), fill: look === 'disc' ? colour(i) : 'none', stroke: look === 'disc' ? '#222' : colour(i),
        'stroke-width': (line * camera.s).toFixed(2)}, parent);
      if (look === 'dashed') circle.setAttribute('stroke-dasharray', `${0.16 * camera.s} ${0.1 * camera.s}`);
      else make('title', {}, circle).textContent =
        `bead ${i}: q6 ${m.q6[i] < 0 ? '–' : m.q6[i] / 100}, ψ6 ${m.psi6[i] < 0 ? '–' : m.psi6[i] / 100}, ${m.bonds[i]} bonds`;
    }
  }

  // Indices of the frames of a film: the phases of the last cycle of which several are kept, the beginnings of all cycles, or
  // all frames. Without phases: all.
  function filmed(which) {
    const lead = runs[state.experiment !== null ? state.experiment : state.simulation], all = lead.moments.map((m, k) => k);
    const cycles = lead.moments.map(m => m.cycle), last = cycles.findLast(c => c !== null && cycles.filter(d => d === c).length > 1);
    const some = which === 'cycle' ? all.filter(k => cycles[k] === last) : which === 'strobe' ? all.filter(k => lead.moments[k].fraction === 0) : all;
    return some.length > 1 ? some : all;
  }

  // The frame that is nearest in its cycle, and of these the nearest in time.
  function nearest(run, when) {
    const off = m => { const cycles = Math.abs(at(m) - when); return Math.abs(cycles - Math.round(cycles)); };
    let best = 0;
    run.moments.forEach((m, k) => {
      const closer = off(m) - off(run.moments[best]);
      if (closer < -1e-9 || (closer < 1e-9 && Math.abs(at(m) - when) < Math.abs(at(run.moments[best]) - when) - 1e-9)) best = k;
    });
    return best;
  }

  function panel(side, index, when) {
    const box = $('panel-' + side);
    box.hidden = index === null;
    if (index === null) return;
    const run = runs[index], svg = box.querySelector('svg'), camera = commonCamera();
    svg.replaceChildren();
    if (!run.moments.length) { box.querySelector('figcaption').textContent = `${run.name}: no frames are kept in this report.`; return; }
    const m = run.moments[nearest(run, when)];
    const view = state.view || field(camera);
    svg.setAttribute('viewBox', view.join(' '));
    svg.setAttribute('aria-label', `${side}, ${m.label}`);
    const raw = $('layer-raw').checked && m.picture;
    if (raw) {
      const own = run.camera || camera, k = camera.s / own.s;
      make('image', {href: m.picture, x: camera.ox - k * (own.ox + 0.5), y: camera.oy - k * (own.oy + 0.5), width: k * own.w, height: k * own.h,
        preserveAspectRatio: 'none', class: 'raw'}, svg);
    }
    const by = $('colour').value;
    if ($('layer-found').checked) {
      const group = make('g', {class: 'found'}, svg);
      beads(group, run, m, camera, i => by === 'none' ? '#009E73' : colourOf(m, i, by), raw ? 'ring' : 'disc');
    }
    const other = side === 'experiment' ? state.simulation : state.experiment;
    if ($('layer-other').checked && other !== null && runs[other].moments.length) {
      const group = make('g', {class: 'other'}, svg), o = runs[other];
      beads(group, o, o.moments[nearest(o, when)], camera, () => '#CC79A7', 'dashed');
    }
    if ($('layer-tracks').checked) {
      const group = make('g', {class: 'tracks', fill: 'none', stroke: '#D55E00', 'stroke-width': 0.09 * camera.s, 'stroke-linejoin': 'round'}, svg);
      const past = run.moments.filter(x => at(x) <= at(m) && x.fraction === 0);
      if (past[past.length - 1] !== m) past.push(m);
      for (const i of run.tracers) {
        const points = past.filter(x => x.x[i] !== null && x.x[i] !== undefined)
          .map(x => `${(camera.ox + camera.s * x.x[i] / 1000).toFixed(2)},${(camera.oy - camera.s * x.z[i] / 1000).toFixed(2)}`);
        if (points.length > 1) make('polyline', {points: points.join(' ')}, group);
        if (points.length) {
          const [cx, cy] = points[points.length - 1].split(',');
          make('circle', {cx, cy, r: 0.12 * camera.s, fill: '#D55E00', stroke: 'none'}, group);
        }
      }
    }
    const left = camera.ox + camera.s * run.box[0], right = camera.ox + camera.s * run.box[1], floor = camera.oy - camera.s * m.plate;
    make('path', {d: `M${left} -0.5V${floor}H${right}V-0.5`, fill: 'none', 'stroke-width': 0.12 * camera.s,
                  'stroke-dasharray': run.periodic ? `${0.4 * camera.s}` : 'none', class: 'walls'}, svg);
    box.querySelector('figcaption').textContent = `${side}: ${run.name}, ${m.label}` +
      ($('layer-raw').checked && !m.picture ? ' (no camera frame kept)' : '') +
      (run.side === 'simulation' && raw ? ' (frame by the synthetic camera)' : '');
  }

  function drawMoment() {
    const lead = runs[state.experiment !== null ? state.experiment : state.simulation];
    const m = lead.moments[state.moment], when = m ? at(m) : 0;
    $('moment-label').textContent = m ? m.label : 'no frames';
    panel('experiment', state.experiment, when);
    panel('simulation', state.simulation, when);
    drawKey();
  }

  function drawKey() {
    const by = $('colour').value, key = $('key');
    key.replaceChildren();
    const chip = (colour, text) => {
      const item = document.createElement('span');
      item.className = 'keyed';
      const dot = document.createElement('i');
      dot.style.background = colour;
      item.append(dot, text);
      key.append(item);
    };
    if (scales[by]) {
      const bar = document.createElement('span');
      bar.className = 'bar';
      bar.style.background = 'linear-gradient(90deg,' + [0, 0.25, 0.5, 0.75, 1].map(viridisAt).join(',') + ')';
      const [low, high] = scales[by];
      key.append(by === 'q6' ? `q6 ${low} (least a plane allows) ` : 'ψ6 0 ', bar, by === 'q6' ? ` ${high} (hexagonal)` : ' 1 (hexagonal)');
      chip('#FFFFFF', 'under 2 bonds');
    }
    if (by === 'structure') structures.forEach(s => chip(s[1], s[2]));
    if (by === 'coordination') for (const c of Object.values(coordinations)) chip(c[0], c[1]);
    if ($('layer-tracks').checked) chip('#D55E00', 'tracers and their way since the first frame shown');
    if ($('layer-other').checked) chip('#CC79A7', 'the other side (dashed)');
  }

  function drawSeries() {
    const s_k = [], s_j = [];
    for (const i of shown()) {
      const run = runs[i], r = run.results.s_k, j = run.results.s_j;
      const look = {mode: 'lines+markers', name: run.side, line: {color: sideColour[run.side], width: 1.6, dash: run.side === 'experiment' ? 'dash' : 'solid'},
                    marker: {size: 6, symbol: run.side === 'experiment' ? 'circle-open' : 'circle'}};
      if (present(r)) s_k.push(Object.assign({x: r.value.map((v, k) => k / r.value.length), y: r.value}, look));
      if (present(j)) s_j.push(Object.assign({x: j.value.map((v, k) => k), y: j.value}, look));
    }
    const length = Math.max(1, ...s_j.map(t => t.x.length - 1));
    s_j.push({x: [0, length], y: [1, 1], mode: 'lines', name: 'σ', hoverinfo: 'skip', line: {color: '#D55E00', dash: 'dash', width: 1.5}});
    graph('series-s_k', s_k, {height: 300, xaxis: axis('phase k / N<sub>k</sub>', {range: [-0.02, 1]}), yaxis: axis('s(k) / σ')});
    graph('series-s_j', s_j, {height: 300, xaxis: axis('cycle j'), yaxis: axis('s<sub>j</sub> / σ', {rangemode: 'tozero'})});
    const fields = shown().filter(i => runs[i].convection);
    const longest = Math.max(1e-12, ...fields.map(i => longestStep(runs[i].convection)));
    // One frame for both sides: the cells and their fields together.
    const frame = [Math.min(...fields.map(i => Math.min(runs[i].box[0], runs[i].convection.extent[0]))), Math.max(...fields.map(i => Math.max(runs[i].box[1], runs[i].convection.extent[1]))),
                   Math.min(0, ...fields.map(i => runs[i].convection.extent[2])), Math.max(...fields.map(i => runs[i].convection.extent[3])) + 0.5];
    for (const side of ['experiment', 'simulation']) drawConvection(side, state[side], longest, frame);
  }

  const speedAt = (field, k) => field.u[k] === null ? 0 : Math.hypot(field.u[k], field.w[k]);
  const longestStep = field => field ? field.u.reduce((most, u, k) => Math.max(most, speedAt(field, k)), 0) : 0;

  // Mean displacement per cycle and cell as arrows, where the results hold it: [rows][columns][x, z], NaN where no bead passed.
  // `longest`, of both sides, is as long as a cell of the field allows, so that arrows of one length mean the same on both.
  // `frame` [x0, x1, z0, z1] is the same for both sides. The line is the outline of the cell.
  function drawConvection(side, index, longest, frame) {
    const box = $('convection-' + side), field = index === null ? null : runs[index].convection;
    box.hidden = !field;
    if (!field) return;
    const svg = box.querySelector('svg'), cell = runs[index].box;
    svg.replaceChildren();
    const [x0, x1, z0, z1] = field.extent, width = x1 - x0, height = z1 - z0;
    svg.setAttribute('viewBox', `${frame[0] - 2} ${-frame[3] - 1.6} ${frame[1] - frame[0] + 3} ${frame[3] - frame[2] + 3.6}`);
    svg.setAttribute('aria-label', `${side}: convection field, longest displacement ${longestStep(field).toPrecision(3)} sigma per cycle`);
    make('path', {d: `M${cell[0]} ${-frame[3]}V${-frame[2]}H${cell[1]}V${-frame[3]}`, fill: 'none', 'stroke-width': 0.1, class: 'outline', 'stroke-dasharray': runs[index].periodic ? '0.4' : 'none'}, svg);
    const label = (text, x, y, anchor) => { make('text', {x, y, 'text-anchor': anchor}, svg).textContent = text; };
    const step = span => [1, 2, 5, 10, 20, 50, 100].find(s => span / s <= 5) || 200;
    const dX = step(frame[1] - frame[0]), dZ = step(frame[3] - frame[2]);
    for (let v = Math.ceil(frame[0] / dX) * dX; v <= frame[1] + 1e-9; v += dX) {
      make('path', {d: `M${v} ${-frame[2]}v0.3`, 'stroke-width': 0.06, class: 'tick'}, svg);
      label(String(v), v, -frame[2] + 1, 'middle');
    }
    for (let v = Math.ceil(frame[2] / dZ) * dZ; v <= frame[3] + 1e-9; v += dZ) {
      make('path', {d: `M${frame[0]} ${-v}h-0.3`, 'stroke-width': 0.06, class: 'tick'}, svg);
      label(String(v), frame[0] - 0.5, -v + 0.25, 'end');
    }
    label('x / σ', (frame[0] + frame[1]) / 2, -frame[2] + 1.8, 'middle');
    label('z / σ', frame[0] - 1.8, -frame[3] - 0.9, 'start');
    const dx = width / field.columns, dz = height / field.rows;
    const gain = 0.9 * Math.min(dx, dz) / longest;
    for (let row = 0; row < field.rows; ++row)
      for (let column = 0; column < field.columns; ++column) {
        const k = row * field.columns + column;
        if (field.u[k] === null) continue;
        const u = gain * field.u[k], w = gain * field.w[k], cx = x0 + (column + 0.5) * dx, cz = z0 + (row + 0.5) * dz;
        const speed = speedAt(field, k) / longest, length = Math.hypot(u, w);
        const ex = cx + u / 2, ez = cz + w / 2, h = 0.35 * length, angle = Math.atan2(w, u);
        const wing = turn => `${(ex - h * Math.cos(angle + turn)).toFixed(3)} ${(-(ez - h * Math.sin(angle + turn))).toFixed(3)}`;
        make('path', {d: `M${(cx - u / 2).toFixed(3)} ${(-(cz - w / 2)).toFixed(3)}L${ex.toFixed(3)} ${(-ez).toFixed(3)}M${wing(0.5)}L${ex.toFixed(3)} ${(-ez).toFixed(3)}L${wing(-0.5)}`,
          fill: 'none', stroke: viridisAt(0.85 * speed), 'stroke-width': Math.min(dx, dz) * 0.07, 'stroke-linecap': 'round'}, svg);
      }
    make('path', {d: `M${frame[1] - Math.min(dx, dz) * 0.9} ${-frame[3] - 0.8}h${0.9 * Math.min(dx, dz)}`, 'stroke-width': 0.12, class: 'tick'}, svg);
    label(`${longest.toPrecision(2)} σ`, frame[1] - Math.min(dx, dz) * 0.9 - 0.3, -frame[3] - 0.55, 'end');
    box.querySelector('figcaption').textContent = `${side}: mean displacement per cycle; the longest arrow is ${longestStep(field).toPrecision(3)} σ${shown().length > 1 ? ', both sides on one scale' : ''}. Line: the cell.`;
  }

  // ---- zoom: the wheel, a drag; a double click goes back ----
  function zoomable(svg) {
    const place = event => {
      const box = svg.getBoundingClientRect(), v = svg.viewBox.baseVal, k = Math.min(box.width / v.width, box.height / v.height);
      return [v.x + (event.clientX - box.x - (box.width - k * v.width) / 2) / k, v.y + (event.clientY - box.y - (box.height - k * v.height) / 2) / k, k];
    };
    svg.addEventListener('wheel', event => {
      if (!event.ctrlKey && !state.view && event.deltaY > 0) return;  // the page scrolls on
      event.preventDefault();
      const v = svg.viewBox.baseVal, [px, py] = place(event), f = event.deltaY > 0 ? 1.25 : 0.8;
      state.view = [px + f * (v.x - px), py + f * (v.y - py), f * v.width, f * v.height];
      drawMoment();
    }, {passive: false});
    let from = null;
    svg.addEventListener('pointerdown', event => { if (state.view) { from = place(event); svg.setPointerCapture(event.pointerId); } });
    svg.addEventListener('pointermove', event => {
      if (!from || !state.view) return;
      const [px, py] = place(event);
      state.view = [state.view[0] + from[0] - px, state.view[1] + from[1] - py, state.view[2], state.view[3]];
      drawMoment();
    });
    svg.addEventListener('pointerup', () => { from = null; });
    svg.addEventListener('dblclick', () => { state.view = null; drawMoment(); });
  }

  // ---- tables: a click on a heading sorts, a button saves ----
  function tables() {
    for (const table of document.querySelectorAll('table[data-name]')) {
      const cell = (row, k) => (row.cells[k].dataset.value || row.cells[k].innerText).trim();
      table.querySelectorAll('th').forEach((head, k) => {
        head.tabIndex = 0;
        const sort = () => {
          const down = head.getAttribute('aria-sort') === 'ascending';
          table.querySelectorAll('th').forEach(h => h.removeAttribute('aria-sort'));
          head.setAttribute('aria-sort', down ? 'descending' : 'ascending');
          const rows = [...table.tBodies[0].rows], number = t => t === '' || isNaN(parseFloat(t)) ? null : parseFloat(t);
          rows.sort((a, b) => {
            const s = cell(a, k), t = cell(b, k), x = number(s), y = number(t);
            if (x === null !== (y === null)) return x === null ? 1 : -1;  // what is absent comes last
            return (down ? -1 : 1) * (x !== null ? x - y : s.localeCompare(t));
          });
          table.tBodies[0].append(...rows);
        };
        head.addEventListener('click', sort);
        head.addEventListener('keydown', event => { if (event.key === 'Enter') sort(); });
      });
      const button = document.createElement('button');
      button.className = 'csv';
      button.textContent = 'Save as CSV';
      button.addEventListener('click', () => {
        const quoted = t => /[",\n]/.test(t) ? '"' + t.replace(/"/g, '""') + '"' : t;
        const lines = [...table.rows].map(row => [...row.cells].map((c, k) => quoted(cell(row, k).replace(/\s*\n\s*/g, '; '))).join(','));
        const link = document.createElement('a');
        link.href = URL.createObjectURL(new Blob([lines.join('\n') + '\n'], {type: 'text/csv'}));
        link.download = table.dataset.name + '.csv';
        link.click();
        setTimeout(() => URL.revokeObjectURL(link.href), 1000);
      });
      table.closest('.scroll').before(button);
      for (const row of table.tBodies[0].rows)
        if (row.dataset.run !== undefined) {
          row.classList.add('choosable');
          row.tabIndex = 0;
          const choose = () => { show(Number(row.dataset.run)); $('point').scrollIntoView({behavior: 'smooth'}); };
          row.addEventListener('click', choose);
          row.addEventListener('keydown', event => { if (event.key === 'Enter') choose(); });
        }
    }
  }

  // ---- begin ----
  runs.forEach((r, i) => $('which').add(new Option(`Γ = ${+r.gamma.toPrecision(4)}, ${r.side}: ${r.name} (${r.phase})`, i)));
  $('which').addEventListener('change', () => show(Number($('which').value)));
  $('moment').addEventListener('input', () => { state.moment = Number($('moment').value); drawMoment(); });
  for (const id of ['layer-raw', 'layer-found', 'layer-other', 'layer-tracks', 'colour']) $(id).addEventListener('change', drawMoment);
  $('play').addEventListener('click', () => {
    if (state.playing) { clearInterval(state.playing); state.playing = null; $('play').textContent = 'Play'; return; }
    $('play').textContent = 'Stop';
    state.playing = setInterval(() => {
      const film = filmed($('film').value);
      if (!film.length) return;
      state.moment = film[(film.indexOf(state.moment) + 1) % film.length];
      $('moment').value = state.moment;
      drawMoment();
    }, 160);
  });
  for (const svg of document.querySelectorAll('.beads')) zoomable(svg);
  document.body.classList.add('live');
  tables();

  // ---- sections: a link of the contents opens its section; all are open in print ----
  const opened = () => {
    const section = location.hash.length > 1 && document.getElementById(decodeURIComponent(location.hash.slice(1)));
    if (section && section.matches('details')) { section.open = true; section.scrollIntoView(); }
  };
  window.addEventListener('hashchange', opened);
  for (const link of document.querySelectorAll('nav a')) link.addEventListener('click', () => setTimeout(opened, 0));
  for (const section of document.querySelectorAll('details.section'))
    section.addEventListener('toggle', () => { for (const plot of section.querySelectorAll('.js-plotly-plot')) if (section.open) Plotly.Plots.resize(plot); });
  window.addEventListener('beforeprint', () => { for (const section of document.querySelectorAll('details.section')) section.open = true; });

  // ---- only the real differences, unless the switch says otherwise ----
  const onlyReal = $('only-real');
  if (onlyReal) {
    const follow = () => document.querySelector('table[data-name=differences]').classList.toggle('only-real', onlyReal.checked);
    onlyReal.addEventListener('change', follow);
    follow();
  }

  // ---- theme ----
  function paint() {
    Object.assign(sideColour, {experiment: themed('experiment'), simulation: themed('simulation')});
    drawDiagram();
    if (!runs.length) return;
    drawThresholds();
    if (shown().length) drawSeries();
  }
  const system = matchMedia('(prefers-color-scheme: dark)'), root = document.documentElement;
  const dark = () => root.dataset.theme ? root.dataset.theme === 'dark' : system.matches;
  const name = () => { $('theme').textContent = dark() ? 'Light' : 'Dark'; $('theme').setAttribute('aria-label', `${dark() ? 'light' : 'dark'} colours`); };
  $('theme').hidden = false;
  $('theme').addEventListener('click', () => { root.dataset.theme = dark() ? 'light' : 'dark'; name(); paint(); });
  system.addEventListener('change', () => { name(); paint(); });
  name();

  // ---- the arrow keys on the diagram go from run to run, in the order of the drive ----
  $('phase-diagram').addEventListener('keydown', event => {
    const step = {ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1}[event.key];
    if (!step || !runs.length) return;
    event.preventDefault();
    const order = runs.map((r, i) => i).sort((a, b) => runs[a].gamma - runs[b].gamma || a - b);
    show(order[(order.indexOf(Number(document.body.dataset.run)) + step + order.length) % order.length]);
  });

  $('point').hidden = !runs.length;  // a diagram of a sweep only
  document.querySelector('.opening').classList.toggle('both', runs.length > 0);
  paint();
  if (runs.length) {
    const differ = matches.findIndex(m => m.verdict === 'differ'), both = matches.filter(m => m.experiments.length && m.simulations.length);
    const first = differ >= 0 ? matches[differ] : both.length ? both[both.length - 1] : matches[matches.length - 1];
    show(first.experiments.concat(first.simulations)[0]);
  }
  document.body.dataset.ready = 'yes';
})();
