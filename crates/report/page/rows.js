// Rows of the timing diagram, drawn from lists of edges: whatever the zoom, no pulse is thinner than a line.

const LANE = 18; // height of a row (CSS pixels)
const LANE_SHARED = 15; // height of each lane where several traces share a row
const PULSE = 1.5; // least width of a pulse
const SPARK = 30; // height of a row that is a small curve

// What colours mean, read again whenever the theme changes.
function readTheme() {
  const style = getComputedStyle(document.documentElement);
  const colour = (name) => style.getPropertyValue(`--${name}`).trim();
  const theme = { font: '11px system-ui, sans-serif', small: '10px system-ui, sans-serif' };
  for (const name of ['ink', 'muted', 'grid', 'line', 'panel', 'in', 'out', 'both', 'limit', 'good', 'bad', 'box', 'cursor']) {
    theme[name] = colour(name);
  }
  theme.traces = [0, 1, 2, 3, 4, 5].map((index) => colour(`trace-${index}`));
  theme.states = {};
  for (const state of STATES) theme.states[state] = colour(`state-${state.toLowerCase()}`);
  return theme;
}

const STATES = [
  'Disabled', 'Standstill', 'Homing', 'Stopping', 'DiscreteMotion', 'ContinuousMotion', 'SynchronizedMotion', 'ErrorStop',
];

// Where scans are: `x` of a scan in a plot of `width` pixels that shows `view`.
const scale = (view, width) => (scan) => ((scan - view.min) / (view.max - view.min)) * width;

// A canvas of this size in CSS pixels, cleared, with its context.
function fresh(canvas, width, height) {
  const ratio = window.devicePixelRatio || 1;
  const [wide, high] = [Math.max(1, Math.round(width * ratio)), Math.max(1, Math.round(height * ratio))];
  if (canvas.width !== wide || canvas.height !== high) {
    canvas.width = wide;
    canvas.height = high;
    canvas.style.width = `${width}px`;
    canvas.style.height = `${height}px`;
  }
  const context = canvas.getContext('2d');
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return context;
}

// Calls `each(start, end, value)` for every stretch of a column that the view shows.
function stretches(column, rows, view, each) {
  const { scans, values } = column.edges;
  for (let at = Math.max(0, lastAtMost(scans, view.min)); at < scans.length && scans[at] <= view.max; at++) {
    each(scans[at], at + 1 < scans.length ? scans[at + 1] : rows, values[at]);
  }
}

// A Boolean: a line that is low or high, and filled while it is high.
function drawWave(context, column, rows, view, box, colour) {
  const x = scale(view, box.width);
  const low = box.top + box.height - 3.5, high = box.top + 3.5;
  const end = Math.min(box.width, x(rows));
  context.strokeStyle = colour;
  context.fillStyle = colour;
  context.lineWidth = 1;
  context.globalAlpha = 0.45;
  context.beginPath();
  context.moveTo(Math.max(0, x(0)), low);
  context.lineTo(end, low);
  context.stroke();
  const lines = new Path2D();
  let painted = -1, drawn = -1;
  stretches(column, rows, view, (from, to, value) => {
    const start = x(from);
    // An edge is a line of its own, but one a pixel will do.
    if (from > 0 && start >= 0 && start - drawn >= 0.5) {
      lines.moveTo(start, low);
      lines.lineTo(start, high);
      drawn = start;
    }
    if (!value) return;
    const left = Math.max(start, 0), right = Math.min(Math.max(x(to), start + PULSE), box.width);
    if (right <= painted) return;
    context.globalAlpha = 0.22;
    context.fillRect(Math.max(left, painted), high, right - Math.max(left, painted), low - high);
    lines.moveTo(left, high);
    lines.lineTo(right, high);
    painted = right;
  });
  context.globalAlpha = 1;
  context.lineWidth = PULSE;
  context.stroke(lines);
}

// States, names and numbers: a box for every stretch, with its text where there is room.
function drawBoxes(context, column, rows, view, box, theme, colour) {
  const x = scale(view, box.width);
  const top = box.top + 2.5, height = box.height - 5;
  context.font = theme.small;
  context.textBaseline = 'middle';
  let crowded = -1;
  stretches(column, rows, view, (from, to, value) => {
    const left = Math.max(x(from), 0), right = Math.min(x(to), box.width);
    if (right <= crowded) return;
    const text = entryText(column, value);
    const state = column.role === 'state' ? theme.states[text] : null;
    const width = Math.max(right - left, PULSE);
    context.fillStyle = state || theme.box;
    context.fillRect(left, top, width, height);
    context.fillStyle = state ? theme.ink : colour;
    context.globalAlpha = state ? 0.55 : 0.8;
    if (from > 0 || state) context.fillRect(left, top, 1, height);
    context.globalAlpha = 1;
    crowded = left + PULSE;
    if (right - left < 14) return;
    const shown = column.kind === 'real' ? compact(value) : text;
    const room = right - left - 8, wide = context.measureText(shown).width;
    if (wide > room) return;
    context.fillStyle = theme.ink;
    context.textAlign = 'left';
    context.fillText(shown, left + 5, top + height / 2 + 0.5);
  });
}

// A number that changes all the time: a curve between its least and its greatest value in view.
function drawSpark(context, column, rows, view, box, colour) {
  const values = column.reals, x = scale(view, box.width);
  const first = Math.max(0, Math.floor(view.min)), last = Math.min(rows - 1, Math.ceil(view.max));
  let least = Infinity, greatest = -Infinity;
  for (let scan = first; scan <= last; scan++) {
    if (!Number.isFinite(values[scan])) continue;
    least = Math.min(least, values[scan]);
    greatest = Math.max(greatest, values[scan]);
  }
  const height = (value) => box.top + box.height - 4 - ((value - least) / (greatest - least || 1)) * (box.height - 8);
  context.strokeStyle = colour;
  context.lineWidth = 1.25;
  context.beginPath();
  const step = Math.max(1, Math.floor((last - first) / (2 * box.width)));
  for (let scan = first; scan <= last; scan += step) {
    let [low, high] = [values[scan], values[scan]];
    for (let next = scan; next < scan + step && next <= last; next++) {
      low = Math.min(low, values[next]);
      high = Math.max(high, values[next]);
    }
    if (!Number.isFinite(low) || !Number.isFinite(high)) continue;
    context.lineTo(x(scan), height(low));
    if (high !== low) context.lineTo(x(scan), height(high));
  }
  context.stroke();
}

// A claim: the scans it speaks of, where it came true, where it failed.
function drawClaim(context, claim, scans, view, box, theme) {
  const x = scale(view, box.width), middle = box.top + box.height / 2;
  const colour = claim.verdict === 'passed' ? theme.good : theme.bad;
  const [from, to] = claim.scans || [0, scans - 1];
  const left = Math.max(0, x(from)), right = Math.min(box.width, Math.max(x(to + 1), x(from) + PULSE));
  if (right > 0 && left < box.width) {
    context.globalAlpha = claim.scans ? 0.35 : 0.12;
    context.fillStyle = colour;
    context.fillRect(left, middle - 2, right - left, 4);
    context.globalAlpha = 1;
  }
  context.strokeStyle = colour;
  context.fillStyle = colour;
  context.lineWidth = 2;
  if (claim.held !== undefined) {
    context.beginPath();
    context.arc(x(claim.held), middle, 3.5, 0, 2 * Math.PI);
    context.fill();
  }
  for (const { scan } of claim.failures || []) {
    if (scan === undefined) continue;
    const place = x(scan);
    context.beginPath();
    context.moveTo(place - 4, middle - 4);
    context.lineTo(place + 4, middle + 4);
    context.moveTo(place - 4, middle + 4);
    context.lineTo(place + 4, middle - 4);
    context.stroke();
  }
}

// A number for a label: six significant digits are plenty there.
function compact(value) {
  if (!Number.isFinite(value)) return realText(value);
  const size = Math.abs(value);
  if (size !== 0 && (size >= 1e7 || size < 1e-4)) return value.toExponential(3).replace(/\.?0+e\+?/, 'e');
  return String(Number(value.toPrecision(6)));
}

// Scans at round numbers, about `count` of them in view.
function ticks(view, count) {
  const span = view.max - view.min;
  let step = 1;
  for (let ten = 1; step * count < span; ten *= 10) {
    for (const factor of [1, 2, 5]) {
      step = ten * factor;
      if (step * count >= span) break;
    }
  }
  const found = [];
  for (let scan = Math.ceil(view.min / step) * step; scan <= view.max; scan += step) found.push(scan);
  return found;
}
