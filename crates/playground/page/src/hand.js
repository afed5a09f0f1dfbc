// An axis led by hand: the target follows the pointer, and orders 2, 3 and 4 follow it, planned anew in every frame, each with a
// load on a spring beneath.

import { element } from './board.js';
import { chart, colours, fresh } from './chart.js';

const CYCLE = 0.001; // s
const LENGTH = 100; // u, the way from left to right
const MEMORY = 3; // s of curves
const ORDERS = [2, 3, 4];
const WHAT = { 2: 'no jerk limit', 3: 'jerk limit', 4: 'jerk and snap limit' };

const SLIDERS = [
  { name: 'velocity', label: 'Velocity', unit: 'u/s', from: 10, to: 1000, value: 200 },
  { name: 'acceleration', label: 'Acceleration', unit: 'u/s²', from: 50, to: 20000, value: 1500 },
  { name: 'jerk', label: 'Jerk', unit: 'u/s³', from: 500, to: 1000000, value: 9000 },
  { name: 'snap', label: 'Snap', unit: 'u/s⁴', from: 5000, to: 50000000, value: 150000 },
  { name: 'frequency', label: 'Spring', unit: 'Hz', from: 1, to: 30, value: 6 },
];

// A spring of 6 Hz swings with a period of 167 ms; at these limits the acceleration takes as long to come, which cancels most of it.
// Fills the panel. `hand(request)` takes the axes a frame further.
export function makeHand(panel, hand) {
  const stage = element('canvas', { className: 'stage', tabIndex: 0, role: 'img', id: 'stage',
    ariaLabel: 'Three axes that follow the pointer; left and right arrow keys move the target' });
  const told = element('p', { className: 'facts', id: 'hand-told' });
  const values = {};
  const sliders = SLIDERS.map(({ name, label, unit, from, to, value }) => {
    const output = element('output', { htmlFor: `hand-${name}` });
    // Limits span decades: the slider moves in their logarithm.
    const slider = element('input', { id: `hand-${name}`, type: 'range', min: Math.log(from), max: Math.log(to), step: 'any', value: Math.log(value) });
    const take = () => {
      values[name] = Number(Math.exp(Number(slider.value)).toPrecision(3));
      output.textContent = `${values[name]} ${unit}`;
      slider.setAttribute('aria-valuetext', output.textContent);
    };
    slider.addEventListener('input', take);
    take();
    return element('label', { htmlFor: `hand-${name}`, className: 'slider' }, element('span', { textContent: label }), slider, output);
  });
  const charts = ['Position of the load behind its axis', 'Acceleration'].map((title) => ({ title,
    canvas: element('canvas', { className: 'chart', role: 'img', ariaLabel: `${title} of the three axes over the last seconds` }) }));
  panel.append(element('section', { className: 'card' },
    element('p', { className: 'help', textContent: 'Move over the picture, or press ← → on it: the target is where the pointer is. Beneath each axis hangs a load on a spring.' }),
    stage, told, element('div', { className: 'sliders' }, ...sliders)),
  element('section', { className: 'card charts' }, ...charts.map(({ canvas }) => canvas)));

  let target = LENGTH / 4;
  let axes = ORDERS.map((order) => ({ order, state: [target, 0, 0, 0], load: [target, 0], duration: 0 }));
  let before = null;
  let past = [];
  let time = 0;
  let on = false;
  let last = 0;

  const bounds = () => Object.fromEntries(['velocity', 'acceleration', 'jerk', 'snap'].map((name) => [name, values[name]]));

  function draw() {
    const colour = colours();
    const { context, width, height } = fresh(stage);
    const x = (place) => 20 + (place / LENGTH) * (width - 40);
    context.font = '12px system-ui, sans-serif';
    context.strokeStyle = colour('cursor');
    context.setLineDash([4, 4]);
    context.beginPath();
    context.moveTo(x(target), 0);
    context.lineTo(x(target), height);
    context.stroke();
    context.setLineDash([]);
    axes.forEach(({ order, state, load }, at) => {
      const rail = 34 + (at * (height - 10)) / ORDERS.length;
      context.strokeStyle = colour('line');
      context.lineWidth = 1;
      context.beginPath();
      context.moveTo(x(0), rail);
      context.lineTo(x(LENGTH), rail);
      context.stroke();
      context.fillStyle = context.strokeStyle = colour(`trace-${at}`);
      context.fillText(`order ${order}: ${WHAT[order]}`, x(0), rail - 18);
      context.fillRect(x(state[0]) - 16, rail - 8, 32, 16);
      const [from, to] = [x(state[0]), x(load[0])];
      context.lineWidth = 1.5;
      context.beginPath();
      context.moveTo(from, rail + 8);
      for (let turn = 1; turn < 8; turn++) context.lineTo(from + ((to - from) * turn) / 8 + (turn % 2 ? 5 : -5), rail + 8 + (turn * 22) / 8);
      context.lineTo(to, rail + 30);
      context.stroke();
      context.beginPath();
      context.arc(to, rail + 36, 7, 0, 2 * Math.PI);
      context.fill();
    });
    const line = (read) => ORDERS.map((order, at) => ({ colour: `trace-${at}`, points: past.map((point) => [point.time - time + MEMORY, read(point.axes[at])]) }));
    chart(charts[0].canvas, line(({ state, load }) => load[0] - state[0]), charts[0].title, MEMORY);
    chart(charts[1].canvas, line(({ state }) => state[2]), charts[1].title, MEMORY);
    told.textContent = axes.map(({ order, duration }) => `order ${order}: there in ${(duration * 1000).toFixed(0)} ms`).join(' · ');
  }

  async function frame(now) {
    if (!on) return;
    // At most a twentieth of a second at once, however long the frame took.
    const scans = Math.round(Math.min(Math.max(now - last, 0), 50) / (CYCLE * 1000));
    last = now;
    const limits = bounds();
    const request = {
      cycle: CYCLE, scans, target, limits, before: before || limits,
      load: { rate: 2 * Math.PI * values.frequency, damping: 0.03 }, axes: axes.map(({ order, state, load }) => ({ order, state, load })),
    };
    before = limits;
    try {
      const answer = await hand(request);
      if (answer.axes) {
        axes = answer.axes.map((axis, at) => ({ order: ORDERS[at], ...axis }));
        time += scans * CYCLE;
        past.push({ time, axes });
        past = past.filter((point) => point.time > time - MEMORY);
        panel.dataset.frames = String(Number(panel.dataset.frames || 0) + 1);
      } else {
        told.textContent = answer.refused;
      }
      draw();
    } catch (error) {
      told.textContent = error.message;
    }
    requestAnimationFrame(frame);
  }

  const go = () => {
    if (on) return;
    on = true;
    last = performance.now();
    requestAnimationFrame(frame);
  };
  panel.addEventListener('seen', go);
  panel.addEventListener('unseen', () => { on = false; });
  stage.addEventListener('pointermove', (event) => {
    const box = stage.getBoundingClientRect();
    target = Math.min(Math.max(((event.clientX - box.left - 20) / (box.width - 40)) * LENGTH, 0), LENGTH);
  });
  stage.addEventListener('keydown', (event) => {
    const by = { ArrowLeft: -LENGTH / 4, ArrowRight: LENGTH / 4 }[event.key];
    if (by === undefined) return;
    target = Math.min(Math.max(target + by, 0), LENGTH);
    event.preventDefault();
    event.stopPropagation();
  });
}
