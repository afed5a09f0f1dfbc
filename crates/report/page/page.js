// The page: the view all plots share, the cursor, events, theme, printing.

const LETTERS = 'ABCDEF';
const EVENTS_SHOWN = 400; // rows of the list at once
const ZOOM = 0.8; // what a step leaves of the view
const LEAST_SPAN = 8; // scans

// What every part of the page looks at.
const shared = {
  traces: [], scans: 0, cycleNs: 0, view: { min: 0, max: 1 }, cursor: null, width: 0, ticks: [], theme: null, numbers: null,
  groups: [], filter: '', marks: [],
};

const find = (selector) => document.querySelector(selector);

// The same text once more would have the page laid out anew.
function write(selector, text) {
  const place = find(selector);
  if (place.textContent !== text) place.textContent = text;
}

// Time of a scan, exact: whole nanoseconds, told in seconds.
function timeText(scan) {
  const ns = BigInt(scan) * BigInt(shared.cycleNs);
  const rest = String(ns % 1000000000n).padStart(9, '0').replace(/0+$/, '');
  return `${ns / 1000000000n}${rest ? `.${rest}` : ''} s`;
}

function blocks() {
  return shared.groups.filter((group) => !group.folded).flatMap((group) => group.blocks)
    .filter((block) => !block.element.hidden);
}

// Draws what is on the screen, or all of it; the rest when it comes into sight.
let scheduled = false;
function schedule() {
  if (scheduled) return;
  scheduled = true;
  requestAnimationFrame(() => {
    scheduled = false;
    paint(false);
  });
}

function paint(all) {
  shared.ticks = ticks(shared.view, Math.max(2, shared.width / 110));
  for (const block of blocks()) {
    if (all || block.seen) {
      if (block.stale) block.draw();
      block.stale = false;
      if (shared.cursor !== null) block.tell(shared.cursor);
    }
  }
  drawRuler();
  drawOverview();
  placeMarks();
  placeCursor();
}

function stale() {
  for (const group of shared.groups) for (const block of group.blocks) block.stale = true;
  schedule();
}

const watcher = new IntersectionObserver((entries) => {
  for (const entry of entries) entry.target.block.seen = entry.isIntersecting;
  schedule();
}, { rootMargin: '200px' });

// Shows scans `min` to `max`, as far as there are any.
function setView(min, max) {
  const span = Math.min(Math.max(max - min, LEAST_SPAN), shared.scans);
  const start = Math.min(Math.max(min, 0), shared.scans - span);
  shared.view = { min: start, max: start + span };
  stale();
  listEvents();
}

function zoom(factor, around) {
  const { min, max } = shared.view;
  const middle = around === undefined ? (min + max) / 2 : around;
  setView(middle - (middle - min) * factor, middle + (max - middle) * factor);
}

function setCursor(scan) {
  shared.cursor = Math.min(Math.max(Math.round(scan), 0), shared.scans - 1);
  write('#scan', `scan ${shared.cursor}`);
  write('#time', timeText(shared.cursor));
  const { min, max } = shared.view;
  if (shared.cursor < min || shared.cursor > max) setView(shared.cursor - (max - min) / 2, shared.cursor + (max - min) / 2);
  markEvents();
  schedule();
}
shared.goTo = setCursor;

// The lines of the marks, at the start of their scans.
function placeMarks() {
  const x = scale(shared.view, shared.width);
  [...find('#marks').children].forEach((line, at) => {
    const place = x(shared.marks[at]);
    line.style.left = `${find('#board').plotLeft + place}px`;
    line.hidden = place < 0 || place > shared.width;
  });
}

function placeCursor() {
  const line = find('#cursor');
  line.hidden = shared.cursor === null;
  if (shared.cursor === null) return;
  const x = scale(shared.view, shared.width)(shared.cursor);
  line.style.left = `${find('#board').plotLeft + x}px`;
  line.hidden = x < 0 || x > shared.width;
}

// The scale of scans and time above the plots.
function drawRuler() {
  const height = 30, context = fresh(find('#ruler'), shared.width + MARGIN, height);
  const x = scale(shared.view, shared.width), { theme } = shared;
  context.font = theme.font;
  let free = -Infinity;
  for (const tick of shared.ticks) {
    const place = Math.round(x(tick)) + 0.5;
    context.strokeStyle = theme.line;
    context.beginPath();
    context.moveTo(place, height - 5);
    context.lineTo(place, height);
    context.stroke();
    const [number, time] = [String(tick), timeText(tick)];
    const wide = Math.max(context.measureText(number).width, context.measureText(time).width);
    const left = Math.min(Math.max(0, place - wide / 2), shared.width + MARGIN - wide);
    if (left < free + 8) continue;
    free = left + wide;
    context.textAlign = 'center';
    context.fillStyle = theme.ink;
    context.fillText(number, left + wide / 2, 10);
    context.fillStyle = theme.muted;
    context.fillText(time, left + wide / 2, 22);
  }
  const place = shared.cursor === null ? -1 : x(shared.cursor);
  if (place < 0 || place > shared.width) return;
  context.fillStyle = theme.cursor;
  context.beginPath();
  context.moveTo(place - 4, height - 6);
  context.lineTo(place + 5, height - 6);
  context.lineTo(place + 0.5, height);
  context.fill();
}

// The whole run in a strip: events, failed claims, and what of it is in view.
function drawOverview() {
  const height = 16, context = fresh(find('#overview'), shared.width, height);
  const x = scale({ min: 0, max: shared.scans }, shared.width), { theme } = shared;
  context.fillStyle = theme.box;
  context.fillRect(0, 3, shared.width, height - 6);
  context.fillStyle = theme.muted;
  context.globalAlpha = 0.6;
  let last = -1;
  for (const event of shared.events) {
    const place = Math.round(x(event.scan));
    if (place === last) continue;
    last = place;
    context.fillRect(place, 5, 1, height - 10);
  }
  context.globalAlpha = 1;
  context.fillStyle = theme.bad;
  for (const { failures } of shared.traces.flatMap((trace) => trace.header.claims)) {
    for (const { scan } of failures || []) if (scan !== undefined) context.fillRect(Math.round(x(scan)) - 1, 3, 2, height - 6);
  }
  context.fillStyle = theme.cursor;
  for (const scan of shared.marks) context.fillRect(Math.round(x(scan)) - 1, 0, 3, height);
  const [left, right] = [x(shared.view.min), x(shared.view.max)];
  context.fillStyle = theme.traces[0];
  context.globalAlpha = 0.18;
  context.fillRect(left, 1, Math.max(right - left, 3), height - 2);
  context.globalAlpha = 1;
  context.strokeStyle = theme.traces[0];
  context.strokeRect(left + 0.5, 1.5, Math.max(right - left - 1, 3), height - 3);
}

// A name that may go on in the next line behind an underscore.
const breakable = (name) => name.split(/(?<=_)/).flatMap((part, at) => (at > 0 ? [element('wbr'), part] : [part]));

// The events in view, each a link to its scan. Rows that say the same as before stay: a page may be told new events many times a second.
function listEvents() {
  const { min, max } = shared.view;
  const wanted = shared.filter.toLowerCase();
  const inView = shared.events.filter((event) => event.scan >= Math.floor(min) && event.scan <= max
    && (!wanted || `${event.subject} ${event.text}`.toLowerCase().includes(wanted)));
  const list = find('#list'), several = shared.traces.length > 1;
  const shown = inView.slice(0, EVENTS_SHOWN);
  shown.forEach((event, at) => {
    const [row, said] = [list.children[at], `${event.trace.letter} ${event.scan} ${event.subject} ${event.text}`];
    if (row && row.said === said) {
      row.event = event;
      return;
    }
    const fresh = element('button', { className: 'event', type: 'button' },
      element('span', { className: 'scan', textContent: event.scan }),
      element('span', { className: 'subject', style: several ? `color: var(--trace-${event.trace.index})` : '' },
        ...breakable(several ? `${event.trace.letter} ${event.subject}` : event.subject)),
      element('span', { className: 'what', textContent: event.text }));
    Object.assign(fresh, { event, said });
    fresh.addEventListener('click', () => setCursor(fresh.event.scan));
    if (row) row.replaceWith(fresh);
    else list.append(fresh);
  });
  while (list.children.length > shown.length) list.lastChild.remove();
  const more = inView.length - shown.length;
  find('#more').textContent = more > 0 ? `${more} more in view: zoom in to see them` : '';
  find('#count').textContent = inView.length === shared.events.length ? `${inView.length}` : `${inView.length} of ${shared.events.length} in view`;
  markEvents();
}

function markEvents() {
  for (const row of find('#list').children) row.classList.toggle('now', row.event.scan === shared.cursor);
}

// To the next scan after the cursor (or before it) in which something happened.
function jump(direction) {
  const from = shared.cursor === null ? -1 : shared.cursor;
  const scans = shared.events.map((event) => event.scan);
  const next = direction > 0 ? scans.find((scan) => scan > from) : scans.filter((scan) => scan < from).pop();
  if (next !== undefined) setCursor(next);
}

// Widths, after a change of the window, the theme or what is shown.
function layOut() {
  const board = find('#board'), sample = find('#overview').parentElement;
  const style = getComputedStyle(board);
  const gutter = parseFloat(style.getPropertyValue('--gutter'));
  board.laidOut = board.clientWidth;
  board.plotLeft = gutter + AXIS;
  board.style.setProperty('--axis', `${AXIS}px`);
  shared.width = Math.max(120, Math.floor(sample.parentElement.clientWidth - gutter - AXIS - MARGIN));
  stale();
}

shared.refresh = () => {
  const wanted = shared.filter.toLowerCase();
  let hidden = 0;
  for (const group of shared.groups) {
    let shown = 0;
    for (const block of group.blocks) {
      const matches = block.names.some((name) => name.toLowerCase().includes(wanted));
      block.element.hidden = block.hidden || !matches;
      shown += block.element.hidden ? 0 : 1;
      hidden += block.hidden ? 1 : 0;
    }
    group.element.hidden = shown === 0 && (wanted !== '' || group.blocks.length > 0);
  }
  find('#show').hidden = hidden === 0;
  find('#show').textContent = `Show ${hidden} hidden`;
  stale();
};

function setTheme(name) {
  if (name === 'auto') delete document.documentElement.dataset.theme;
  else document.documentElement.dataset.theme = name;
  shared.theme = readTheme();
  for (const group of shared.groups) for (const block of group.blocks) if (block.redraw) block.redraw();
  stale();
}

// Pointer: moving puts the cursor, dragging zooms into what was drawn over, dragging with Shift moves the view.
function listen(board) {
  let drag = null;
  const scanAt = (event) => {
    const x = event.clientX - board.getBoundingClientRect().left - board.plotLeft;
    return { x, scan: shared.view.min + (x / shared.width) * (shared.view.max - shared.view.min) };
  };
  const inPlot = (event) => scanAt(event).x >= -4 && scanAt(event).x <= shared.width + 4;
  const select = find('#select');
  board.addEventListener('pointermove', (event) => {
    const { x, scan } = scanAt(event);
    if (drag && drag.pan) {
      const moved = ((drag.x - x) / shared.width) * (drag.view.max - drag.view.min);
      setView(drag.view.min + moved, drag.view.max + moved);
    } else if (drag) {
      const [left, right] = [Math.min(x, drag.x), Math.max(x, drag.x)].map((place) => Math.min(Math.max(place, 0), shared.width));
      select.hidden = right - left < 4;
      select.style.left = `${board.plotLeft + left}px`;
      select.style.width = `${right - left}px`;
    }
    if ((drag || inPlot(event)) && event.target.id !== 'overview') setCursor(Math.min(Math.max(scan, shared.view.min), shared.view.max));
  });
  board.addEventListener('pointerdown', (event) => {
    if (event.button > 1 || !inPlot(event) || event.target.id === 'overview' || event.target.closest('button')) return;
    board.focus({ preventScroll: true });
    drag = { ...scanAt(event), pan: event.shiftKey || event.button === 1 || event.pointerType === 'touch', view: shared.view };
    board.setPointerCapture(event.pointerId);
    event.preventDefault();
  });
  board.addEventListener('pointerup', (event) => {
    if (!drag) return;
    const [from, to] = [drag.scan, scanAt(event).scan].sort((one, other) => one - other);
    if (!drag.pan && !select.hidden) setView(from, to);
    select.hidden = true;
    drag = null;
  });
  board.addEventListener('dblclick', (event) => inPlot(event) && setView(0, shared.scans));
  board.addEventListener('wheel', (event) => {
    if (!inPlot(event)) return;
    const { min, max } = shared.view;
    if (event.ctrlKey || event.metaKey) {
      zoom(event.deltaY < 0 ? ZOOM : 1 / ZOOM, scanAt(event).scan);
    } else if (event.shiftKey || Math.abs(event.deltaX) > Math.abs(event.deltaY)) {
      const by = ((event.deltaX || event.deltaY) / shared.width) * (max - min);
      setView(min + by, max + by);
    } else {
      return;
    }
    event.preventDefault();
  }, { passive: false });
  const overview = find('#overview');
  const pan = (event) => {
    if (event.buttons === 0) return;
    const middle = ((event.clientX - overview.getBoundingClientRect().left) / shared.width) * shared.scans;
    const half = (shared.view.max - shared.view.min) / 2;
    setView(middle - half, middle + half);
  };
  overview.addEventListener('pointerdown', (event) => {
    overview.setPointerCapture(event.pointerId);
    pan(event);
  });
  overview.addEventListener('pointermove', pan);
}

const KEYS = {
  ArrowLeft: (event) => setCursor((shared.cursor || 0) - (event.shiftKey ? 10 : 1)),
  ArrowRight: (event) => setCursor((shared.cursor || 0) + (event.shiftKey ? 10 : 1)),
  Home: () => setCursor(0),
  End: () => setCursor(shared.scans - 1),
  '+': () => zoom(ZOOM * ZOOM, shared.cursor === null ? undefined : shared.cursor),
  '-': () => zoom(1 / ZOOM / ZOOM, shared.cursor === null ? undefined : shared.cursor),
  0: () => setView(0, shared.scans),
  n: () => jump(1),
  p: () => jump(-1),
};

function wire() {
  const board = find('#board');
  listen(board);
  document.addEventListener('keydown', (event) => {
    if (event.composedPath()[0].closest('input, select, textarea, [contenteditable]') || event.ctrlKey || event.metaKey || event.altKey) return;
    const act = KEYS[event.key];
    if (!act) return;
    act(event);
    event.preventDefault();
  });
  for (const button of document.querySelectorAll('.goto')) button.addEventListener('click', () => setCursor(Number(button.dataset.scan)));
  find('#in').addEventListener('click', () => zoom(0.5, shared.cursor === null ? undefined : shared.cursor));
  find('#out').addEventListener('click', () => zoom(2, shared.cursor === null ? undefined : shared.cursor));
  find('#fit').addEventListener('click', () => setView(0, shared.scans));
  find('#previous').addEventListener('click', () => jump(-1));
  find('#next').addEventListener('click', () => jump(1));
  find('#theme').addEventListener('change', (event) => setTheme(event.target.value));
  find('#filter').addEventListener('input', (event) => {
    shared.filter = event.target.value.trim();
    shared.refresh();
    listEvents();
  });
  find('#show').addEventListener('click', () => {
    for (const group of shared.groups) for (const block of group.blocks) block.hidden = false;
    shared.refresh();
  });
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => setTheme(find('#theme').value));
  // Only another width moves the plots: what is told below them may take more room or less many times a second.
  new ResizeObserver(() => board.clientWidth !== board.laidOut && layOut()).observe(board);
  window.addEventListener('beforeprint', () => {
    document.documentElement.classList.add('printing');
    setTheme('light');
    layOut();
    paint(true);
  });
  window.addEventListener('afterprint', () => {
    document.documentElement.classList.remove('printing');
    setTheme(find('#theme').value);
    layOut();
  });
}
