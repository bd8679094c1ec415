// The page of draw. Data: one JSON document, made by draw_page.cpp, in #data. Positions and numbers are levels of
// 16 bits of their range; 65535: absent.
'use strict';
(() => {
  const data = JSON.parse(document.getElementById('data').textContent);
  const $ = id => document.getElementById(id);
  const kAbsent = 65535, kLevels = 65534, kGrey = 256, n = data.beads, frames = data.titles.length;
  const solid = data.box.dimension === 3, {lower, upper, boundary, tilt} = data.box;

  // ---- numbers ----
  function numbersOf(part) {
    const text = atob(part.levels.slice(part.levels.indexOf(',') + 1)), levels = new Uint16Array(text.length / 2);
    for (let k = 0; k < levels.length; ++k) levels[k] = text.charCodeAt(2 * k) | text.charCodeAt(2 * k + 1) << 8;
    const step = (part.high - part.low) / kLevels;
    return {levels, at: k => levels[k] === kAbsent ? NaN : part.low + step * levels[k], low: part.low, high: part.high};
  }
  const vectorsOf = part => ({x: numbersOf(part.x), y: solid ? numbersOf(part.y) : null, z: numbersOf(part.z)});
  const vectorAt = (part, k) => [part.x.at(k), solid ? part.y.at(k) : 0, part.z.at(k)];
  function wholesOf(uri) {
    const text = atob(uri.slice(uri.indexOf(',') + 1)), numbers = new Uint32Array(text.length / 4);
    for (let k = 0; k < numbers.length; ++k) for (let b = 0; b < 4; ++b) numbers[k] += text.charCodeAt(4 * k + b) * 256 ** b;
    return numbers;
  }
  const positions = vectorsOf(data.position), x = positions.x, z = positions.z;
  const velocity = data.velocity ? vectorsOf(data.velocity.value) : null;
  const contacts = data.contacts ? {bead: wholesOf(data.contacts.bead), line: vectorsOf(data.contacts.line), force: numbersOf(data.contacts.force)} : null;
  const number = data.colour ? numbersOf(data.colour) : null, unit = data.colour ? data.colour.unit.replace('sigma', 'σ') : '';
  const radius = i => typeof data.radius === 'number' ? data.radius : data.radius[i];
  const largest = typeof data.radius === 'number' ? data.radius : data.radius.reduce((a, b) => Math.max(a, b), 0);
  const mapped = number ? (() => {
    const [low, high] = data.colour.range, span = high - low;
    return k => {
      const value = number.at(k);
      if (Number.isNaN(value)) return kGrey;
      return span > 0 ? Math.round(255 * Math.min(1, Math.max(0, (value - low) / span))) : 128;
    };
  })() : null;

  // ---- view: in 2D x to the right and z up; in 3D in perspective from a distance of three diagonals ----
  const shifts = [0, 1, 2].map(a => data.cells.map(c => c[a]));
  const least = values => values.reduce((a, b) => Math.min(a, b)), most = values => values.reduce((a, b) => Math.max(a, b));
  const bottom = Math.min(least(shifts[2]), z.low - largest);
  const top = boundary[2] === 'open' ? z.high + largest + 1 : Math.min(upper[2], z.high + largest + 1);
  const low = [Math.min(lower[0] + least(shifts[0]), x.low - largest), lower[1] + least(shifts[1]), bottom];
  const high = [Math.max(upper[0] + most(shifts[0]), x.high + largest), upper[1] + most(shifts[1]), top];
  const centre = low.map((l, a) => (l + high[a]) / 2), distance = 3 * Math.hypot(...low.map((l, a) => high[a] - l));
  const state = {frame: 0, playing: null, zoom: 1, turn: Math.PI / 6, tilt: Math.PI / 12, pan: [0, 0], tracks: data.tracks, vectors: true, contacts: true};
  function turned(r) {
    const d = r.map((v, a) => v - centre[a]);
    if (!solid) return [d[0], d[2], 1, 0];
    const right = Math.cos(state.turn) * d[0] + Math.sin(state.turn) * d[1], back = -Math.sin(state.turn) * d[0] + Math.cos(state.turn) * d[1];
    const up = Math.cos(state.tilt) * d[2] + Math.sin(state.tilt) * back, depth = Math.cos(state.tilt) * back - Math.sin(state.tilt) * d[2];
    const larger = distance / Math.max(distance + depth, distance / 10);
    return [right * larger, up * larger, larger, depth];
  }
  const canvas = $('cell'), pen = canvas.getContext('2d');
  let scale = 1, origin = [0, 0];  // px of the canvas for sigma, and of the centre
  function fit() {
    const ratio = window.devicePixelRatio || 1, box = canvas.getBoundingClientRect();
    canvas.width = Math.max(1, Math.round(box.width * ratio));
    canvas.height = Math.max(1, Math.round(box.height * ratio));
    const corners = [];
    for (let k = 0; k < 8; ++k) corners.push(turned([0, 1, 2].map(a => k >> a & 1 ? high[a] : low[a])));
    const wide = 2 * most(corners.map(c => Math.abs(c[0]))), tall = 2 * most(corners.map(c => Math.abs(c[1])));
    scale = state.zoom * Math.min((canvas.width - 16) / wide, (canvas.height - 44) / tall);
    origin = [canvas.width / 2 + state.pan[0] * ratio, (canvas.height - 28) / 2 + state.pan[1] * ratio];
    $('window').dataset.view = JSON.stringify({scale: scale / ratio, x: origin[0] / ratio, y: origin[1] / ratio, centre});
  }
  function project(r) {
    const [right, up, larger, depth] = turned(r);
    return {x: origin[0] + scale * right, y: origin[1] - scale * up, scale: scale * larger, depth};
  }
  const bead = (frame, i) => vectorAt(positions, frame * n + i);

  // ---- drawing ----
  let shown = [];  // beads of the frame on the canvas, the farthest first
  function line(a, b, kind, width) {
    if (kind === 'open') return;
    const p = project(a), q = project(b);
    pen.lineWidth = width;
    pen.strokeStyle = kind === 'wall' ? ink() : getComputedStyle(document.body).getPropertyValue('--line');
    pen.beginPath();
    pen.moveTo(p.x, p.y);
    pen.lineTo(q.x, q.y);
    pen.stroke();
  }
  const ink = () => getComputedStyle(document.body).getPropertyValue('--ink');
  function drawCell() {
    const [sx, sy, plate] = data.cells[state.frame], px = window.devicePixelRatio || 1;
    const foot = (right, back, height) => {
      const lean = Math.tan(tilt[right ? 1 : 0] * Math.PI / 180) * (height - plate);
      return [sx + (right ? upper[0] + lean : lower[0] - lean), sy + (back ? upper[1] : lower[1]), height];
    };
    if (!solid) {
      for (const right of [false, true]) line(foot(right, false, plate), foot(right, false, top), boundary[0], 2 * px);
      line(foot(false, false, plate), foot(true, false, plate), boundary[2], 3 * px);
      if (top >= upper[2]) line(foot(false, false, top), foot(true, false, top), boundary[2], 2 * px);
      return;
    }
    for (const side of [false, true]) {
      for (const back of [false, true]) line(foot(side, back, plate), foot(side, back, top), 'wall', px);
      for (const height of [plate, top]) {
        line(foot(side, false, height), foot(side, true, height), 'wall', px);
        line(foot(false, side, height), foot(true, side, height), 'wall', px);
      }
    }
  }
  // A step over a periodic boundary is left out.
  function drawTracks() {
    const first = Math.max(0, state.frame - state.tracks);
    const jump = [0, 1, 2].map(a => boundary[a] === 'periodic' ? (upper[a] - lower[a]) / 2 : Infinity);
    pen.strokeStyle = getComputedStyle(document.body).getPropertyValue('--quiet');
    pen.lineWidth = window.devicePixelRatio || 1;
    pen.beginPath();
    for (let i = 0; i < n; ++i)
      for (let k = first; k < state.frame; ++k) {
        const from = bead(k, i), to = bead(k + 1, i);
        if (Number.isNaN(from[0] + to[0]) || from.some((v, a) => Math.abs(v - to[a]) > jump[a])) continue;
        const p = project(from), q = project(to);
        pen.moveTo(p.x, p.y);
        pen.lineTo(q.x, q.y);
      }
    pen.stroke();
  }
  function drawBeads() {
    shown = [];
    for (let i = 0; i < n; ++i) {
      const r = bead(state.frame, i);
      if (Number.isNaN(r[0])) continue;
      const p = project(r);
      shown.push({i, r, x: p.x, y: p.y, size: radius(i) * p.scale, depth: p.depth, colour: mapped ? mapped(state.frame * n + i) : -1});
    }
    if (solid) shown.sort((a, b) => b.depth - a.depth);
    pen.strokeStyle = 'rgba(0, 0, 0, .45)';
    for (const b of shown) {
      pen.beginPath();
      pen.arc(b.x, b.y, b.size, 0, 2 * Math.PI);
      pen.fillStyle = b.colour < 0 ? '#96bede' : data.map[b.colour];
      pen.fill();
      pen.lineWidth = Math.max(0.5, 0.06 * b.size);
      pen.stroke();
    }
  }
  // Lines from centre to centre, or to the wall, as wide as the force; a light rim keeps them readable on dark beads.
  function drawContacts() {
    const lines = [], most = contacts.force.high;
    for (let k = data.contacts.first[state.frame]; k < data.contacts.first[state.frame + 1] && most > 0; ++k) {
      const from = bead(state.frame, contacts.bead[k]), line = vectorAt(contacts.line, k);
      if (Number.isNaN(from[0])) continue;
      const a = project(from), b = project(from.map((v, c) => v + line[c])), width = data.contacts.widest * a.scale * contacts.force.at(k) / most;
      if (width >= 0.25) lines.push([a, b, Math.max(1, width)]);
    }
    for (const [colour, more] of [['#ebebeb', 2], ['#1e1e1e', 0]]) {
      pen.strokeStyle = colour;
      for (const [a, b, width] of lines) {
        pen.lineWidth = width + more;
        pen.beginPath();
        pen.moveTo(a.x, a.y);
        pen.lineTo(b.x, b.y);
        pen.stroke();
      }
    }
    return lines.length;
  }
  function drawVectors() {
    const stretch = data.velocity.longest / data.velocity.fastest, ratio = window.devicePixelRatio || 1;
    let drawn = 0;
    pen.strokeStyle = '#c82828';
    pen.lineWidth = 1.3 * ratio;
    pen.beginPath();
    for (let i = 0; i < n && data.velocity.fastest > 0; ++i) {
      const from = bead(state.frame, i), v = vectorAt(velocity, state.frame * n + i);
      if (Number.isNaN(from[0] + v[0])) continue;
      const a = project(from), b = project(from.map((r, c) => r + stretch * v[c])), along = Math.atan2(b.y - a.y, b.x - a.x);
      const head = Math.min(0.35 * Math.hypot(b.x - a.x, b.y - a.y), 7 * ratio);
      pen.moveTo(a.x, a.y);
      pen.lineTo(b.x, b.y);
      for (const side of [-0.45, 0.45]) {
        pen.moveTo(b.x, b.y);
        pen.lineTo(b.x - head * Math.cos(along + side), b.y - head * Math.sin(along + side));
      }
      ++drawn;
    }
    pen.stroke();
    return drawn;
  }
  function drawScaleBar() {
    const mm = data.sigma_mm, per = mm || 1, room = canvas.width / 4 / (scale / per), decade = Math.pow(10, Math.floor(Math.log10(room)));
    const length = [5, 2, 1].map(s => s * decade).find(l => l <= room * (1 + 1e-9)), ratio = window.devicePixelRatio || 1;
    const px = length * scale / per, y = canvas.height - 10 * ratio;
    pen.fillStyle = ink();
    pen.fillRect(8 * ratio, y - 3 * ratio, px, 3 * ratio);
    pen.font = `${13 * ratio}px system-ui, sans-serif`;
    pen.fillText(`${+length.toPrecision(3)} ${mm ? 'mm' : 'σ'}`, 14 * ratio + px, y);
    $('window').dataset.scaleBar = length;
  }
  function draw() {
    fit();
    pen.clearRect(0, 0, canvas.width, canvas.height);
    drawCell();
    if (state.tracks > 0) drawTracks();
    drawBeads();
    document.body.dataset.contacts = contacts && state.contacts ? drawContacts() : 0;
    document.body.dataset.vectors = velocity && state.vectors ? drawVectors() : 0;
    drawScaleBar();
    $('frame').value = state.frame;
    $('frame-label').textContent = `${data.numbers[state.frame]}: ${data.titles[state.frame]}`;
    document.body.dataset.frame = state.frame;
    document.body.dataset.shown = shown.length;
  }

  // ---- controls ----
  function show(frame) {
    state.frame = (frame + frames) % frames;
    draw();
    if (pointer) readOut(pointer);
  }
  function play(on) {
    if (state.playing) clearInterval(state.playing);
    state.playing = on ? setInterval(() => show(state.frame + 1), 1000 / Number($('speed').value)) : null;
    $('play').textContent = on ? 'Pause' : 'Play';
  }
  const options = (id, values, chosen, words) => {
    const all = [...new Set([...values, chosen])].sort((a, b) => a - b);
    $(id).replaceChildren(...all.map(v => { const o = document.createElement('option'); o.value = v; o.textContent = words(v); return o; }));
    $(id).value = chosen;
  };
  options('speed', [1, 2, 5, 10, 25, 50], data.speed, v => `${v} frames/s`);
  options('tracks', [0, 5, 20, 100], data.tracks, v => v ? `${v} frames` : 'none');
  $('frame').max = frames - 1;
  $('frame').addEventListener('input', () => show(Number($('frame').value)));
  $('play').addEventListener('click', () => play(!state.playing));
  $('speed').addEventListener('change', () => play(Boolean(state.playing)));
  $('tracks').addEventListener('change', () => { state.tracks = Number($('tracks').value); draw(); });
  for (const [id, present] of [['vectors', velocity], ['contacts', contacts]]) {
    $('with-' + id).hidden = !present;
    $(id).addEventListener('change', () => { state[id] = $(id).checked; draw(); });
  }
  function zoom(factor, at) {
    const box = canvas.getBoundingClientRect(), before = state.zoom;
    state.zoom = Math.min(64, Math.max(1, factor));
    // The point under the pointer stays; the view begins in the middle.
    const away = [at[0] - box.width / 2, at[1] - (box.height - 28 / (window.devicePixelRatio || 1)) / 2];
    state.pan = state.zoom === 1 ? [0, 0] : state.pan.map((p, a) => away[a] - (away[a] - p) * state.zoom / before);
    const named = [...$('zoom').options].find(o => Number(o.value) === state.zoom);
    $('zoom').value = named ? named.value : '';
    draw();
  }
  $('zoom').addEventListener('change', () => { const box = canvas.getBoundingClientRect(); zoom(Number($('zoom').value), [box.width / 2, box.height / 2]); });
  let pointer = null, dragged = null;
  const place = event => { const box = canvas.getBoundingClientRect(); return [event.clientX - box.left, event.clientY - box.top]; };
  function readOut(at) {
    const ratio = window.devicePixelRatio || 1, px = at.map(v => v * ratio);
    const under = shown.findLast(b => Math.hypot(b.x - px[0], b.y - px[1]) <= b.size);
    if (!under) { $('readout').textContent = ''; return; }
    const place = (solid ? [0, 1, 2] : [0, 2]).map(a => `${'xyz'[a]} ${under.r[a].toFixed(3)}`).join(', ');
    const value = number ? number.at(state.frame * n + under.i) : NaN;
    const said = !number ? '' : Number.isNaN(value) ? `, ${data.colour.name} not known` : `, ${data.colour.name} ${+value.toPrecision(4)} ${unit}`;
    $('readout').textContent = `bead ${under.i}: ${place} σ${said}`;
  }
  canvas.addEventListener('pointerdown', event => { dragged = {at: place(event), pan: state.pan, turn: state.turn, tilt: state.tilt}; canvas.setPointerCapture(event.pointerId); });
  canvas.addEventListener('pointermove', event => {
    pointer = place(event);
    if (dragged) {
      const by = [pointer[0] - dragged.at[0], pointer[1] - dragged.at[1]];
      if (solid && !event.shiftKey) {
        state.turn = dragged.turn + by[0] / 150;
        state.tilt = Math.min(Math.PI / 2, Math.max(-Math.PI / 2, dragged.tilt + by[1] / 150));
      } else {
        state.pan = dragged.pan.map((p, a) => p + by[a]);
      }
      draw();
    }
    readOut(pointer);
  });
  for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, () => { dragged = null; });
  canvas.addEventListener('pointerleave', () => { pointer = null; });
  canvas.addEventListener('wheel', event => { event.preventDefault(); zoom(state.zoom * Math.exp(-event.deltaY / 400), place(event)); }, {passive: false});
  document.addEventListener('keydown', event => {
    if (event.target.closest('input, select, button') || event.ctrlKey || event.metaKey) return;
    if (event.key === ' ') play(!state.playing);
    else if (event.key === 'ArrowRight') show(state.frame + 1);
    else if (event.key === 'ArrowLeft') show(state.frame - 1);
    else return;
    event.preventDefault();
  });
  if (data.colour) {
    const bar = document.createElement('span'), [from, to] = data.colour.range;
    bar.className = 'bar';
    bar.id = 'colour-bar';
    bar.style.background = `linear-gradient(to right, ${data.map.slice(0, 256).filter((c, k) => k % 15 === 0).join(', ')})`;
    $('key').append(`${data.colour.name}${unit ? ', ' + unit : ''}: ${+from.toPrecision(4)} `, bar, ` ${+to.toPrecision(4)}`);
    if (number.levels.some((level, k) => level === kAbsent && x.levels[k] !== kAbsent)) {
      const grey = document.createElement('span'), mark = document.createElement('i');
      grey.className = 'keyed';
      mark.style.background = data.map[kGrey];
      grey.append(mark, 'not known');
      $('key').append(' ', grey);
    }
  }
  const scaleOf = (what, value, unit) => {
    const text = document.createElement('span');
    text.className = 'keyed';
    text.textContent = `${what}: ${+value.toPrecision(3)} ${unit}`;
    $('key').append(' ', text);
  };
  if (velocity) scaleOf('longest arrow', data.velocity.fastest, 'σ/t0');
  if (contacts) scaleOf('widest line', contacts.force.high, 'm g');
  $('hint').textContent = `Space: play or pause; arrows: one frame; wheel: zoom; drag: ${solid ? 'turn, with Shift move' : 'move'}; point at a bead for its numbers.`;
  document.body.classList.add('live');
  window.addEventListener('resize', draw);
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', draw);
  draw();
  document.body.dataset.ready = 'yes';
})();
