// Plan lines: one JSON object a line, as `standstill plan` takes them, and the plans beside each other.

import { element } from './board.js';
import { chart } from './chart.js';

const LIMITS = '"limits": {"velocity": 200, "acceleration": 2000, "jerk": 50000, "snap": 4000000}';
const EXAMPLE = ['sequential', 'grid', 'overlapped', 'online', 's-curve']
  .map((method) => `{"id": "${method}", "Ts": 0.001, "target": 40, "method": "${method}", ${method === 's-curve' ? LIMITS.replace(', "snap": 4000000', '') : LIMITS}}`)
  .join('\n');

const STEPS = 24; // points of a segment

// The course of a plan: a state at each of some times, from its segments.
function course({ segments }) {
  const points = [];
  let at = 0;
  for (const { duration, velocity, acceleration, jerk, snap } of segments) {
    for (let step = 0; step <= STEPS; step++) {
      const t = (duration * step) / STEPS;
      points.push([at + t, velocity + t * (acceleration + t * (jerk / 2 + (t * snap) / 6)), acceleration + t * (jerk + (t * snap) / 2), jerk + t * snap, snap]);
    }
    at += duration;
  }
  return points;
}

const number = (value) => (typeof value === 'number' ? String(Number(value.toPrecision(7))) : value === null || value === undefined ? '–' : String(value));

function table(answers) {
  const heads = ['line', 'id', 'method', 'duration (s)', 'scans', 'peak velocity', 'peak acceleration', 'peak jerk', 'peak snap', 'switching times (s)'];
  const rows = answers.map((answer, at) => {
    const head = element('th', { scope: 'row', textContent: typeof answer.id === 'string' ? answer.id : JSON.stringify(answer.id) });
    const swatch = element('td', { className: `t${at % 6}` }, element('span', { className: 'dot' }));
    if (answer.error) {
      const { code, field, nearest, message } = answer.error;
      const near = nearest === undefined ? '' : `; nearest: ${JSON.stringify(nearest)}`;
      return element('tr', {}, swatch, head, element('td', { colSpan: heads.length - 2, className: 'bad', textContent: `${code}${field ? ` (${field})` : ''}: ${message}${near}` }));
    }
    const { method, duration, scans, peak, segments } = answer;
    let time = 0;
    const times = segments.map((segment) => number(time += segment.duration)).join(', ');
    const cells = [method, duration, scans, peak.velocity, peak.acceleration, peak.jerk, peak.snap, times];
    return element('tr', {}, swatch, head, ...cells.map((cell) => element('td', { textContent: number(cell) })));
  });
  return element('table', {}, element('thead', {}, element('tr', {}, ...heads.map((head) => element('th', { scope: 'col', textContent: head })))),
    element('tbody', {}, ...rows));
}

// Fills the panel. `plan(lines)` answers lines with lines.
export function makePlans(panel, plan) {
  const lines = element('textarea', { id: 'lines', value: EXAMPLE, rows: 8, spellcheck: false, wrap: 'off' });
  const [shown, trouble] = [element('div', { className: 'table', tabIndex: 0, role: 'region', ariaLabel: 'Plans' }), element('p', { className: 'trouble', hidden: true, role: 'alert' })];
  const titles = ['Velocity', 'Acceleration', 'Jerk', 'Snap'];
  const canvases = titles.map((title) => element('canvas', { className: 'chart', role: 'img', ariaLabel: `${title} of the plans over time` }));
  panel.append(element('section', { className: 'card' },
    element('label', { htmlFor: 'lines', textContent: 'Lines to plan, one JSON object each, as `standstill plan` takes them:' }), lines, trouble, shown),
  element('section', { className: 'card charts' }, ...canvases));
  let answers = [];
  const draw = () => {
    const courses = answers.map((answer) => (answer.segments ? course(answer) : []));
    canvases.forEach((canvas, at) => chart(canvas, courses.map((points, index) => ({ colour: `trace-${index % 6}`, points: points.map((point) => [point[0], point[at + 1]]) })), titles[at]));
  };
  let last = 0;
  const run = async () => {
    const mine = ++last;
    const told = await plan(lines.value);
    if (mine !== last) return;
    answers = told.split('\n').filter(Boolean).map((line) => JSON.parse(line));
    const refused = answers.find((answer) => answer.refused);
    trouble.hidden = !refused;
    trouble.textContent = refused ? refused.refused : '';
    if (refused) return;
    shown.replaceChildren(table(answers));
    draw();
    panel.dataset.plans = String(answers.length);
  };
  const again = () => run().catch((error) => {
    trouble.hidden = false;
    trouble.textContent = error.message;
  });
  lines.addEventListener('input', again);
  panel.addEventListener('seen', draw);
  new ResizeObserver(draw).observe(panel);
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', draw);
  document.querySelector('#theme').addEventListener('change', () => requestAnimationFrame(draw));
  again();
}
