// Below this the build puts the diagram of reports, in front of it this: how a run of the playground gets there.

// What a run left, as the diagram has traces: `told` and `reals` as the worker gives them.
function traceOf(told, reals) {
  const rows = told.rows;
  const columns = told.columns.map(({ name, kind, role, is_time: isTime, reals: at, scans, values }) => {
    const dot = name.indexOf('.');
    const column = { name, subject: dot < 0 ? '' : name.slice(0, dot), signal: name.slice(dot + 1), kind, role, isTime };
    if (at !== undefined) {
      column.reals = reals.subarray(at, at + rows);
      column.edges = realEdges(column.reals);
    } else if (kind === 'name') {
      column.names = [...new Set(values)];
      const places = new Map(column.names.map((text, place) => [text, place]));
      column.edges = { scans, values: values.map((text) => places.get(text)) };
    } else {
      column.edges = { scans, values };
    }
    return column;
  });
  return { ...told.trace, index: 0, letter: 'A', rows, columns, byName: new Map(columns.map((column) => [column.name, column])) };
}

const areSame = (one, other) => one.length === other.length && one.every((value, at) => Object.is(value, other[at]));

// Whether a column is drawn as the one before.
function isSame(one, other) {
  if (one.reals || other.reals) return Boolean(one.reals && other.reals) && areSame(one.reals, other.reals);
  return areSame(one.edges.scans, other.edges.scans) && areSame(one.edges.values, other.edges.values)
    && (one.names === undefined || areSame(one.names, other.names));
}

// What of a trace decides which blocks there are.
function shapeOf(trace) {
  const columns = trace.columns.map((column) => {
    const still = column.edges && column.edges.scans.length === 1;
    return [column.name, column.kind, still, still ? entryText(column, column.edges.values[0]) : Boolean(column.edges)];
  });
  const { claims, cams, ...header } = trace.header;
  const onCams = [...new Set((cams || []).map(({ slave }) => slave))];
  return JSON.stringify([trace.rows, header, claims.length > 0, onCams, columns]);
}

// Puts a group on the board, as the one of its name before was.
function settle(group, folded, hidden) {
  group.title = group.element.querySelector('.title').textContent;
  if (folded.has(group.title)) group.element.querySelector('.fold').click();
  for (const block of group.blocks) {
    block.hidden = hidden.has(block.names[0]);
    block.element.block = block;
    watcher.observe(block.element);
  }
}

// The state of the diagram that outlives a run: what is folded and hidden.
function remembered() {
  return {
    folded: new Set(shared.groups.filter((group) => group.folded).map((group) => group.title)),
    hidden: new Set(shared.groups.flatMap((group) => group.blocks).filter((block) => block.hidden).map((block) => block.names[0])),
  };
}

let wired = false;
let lastShape = '';

// Shows a run in place of the one before; the view and the cursor stay where they are as far as they can.
export function show(told, reals, view) {
  const trace = traceOf(told, reals);
  const shape = shapeOf(trace);
  const same = shape === lastShape;
  lastShape = shape;
  const before = shared.scans;
  if (same) {
    // The same blocks with other numbers: nothing is made anew while a number is dragged.
    const [old] = shared.traces;
    const changed = new Set(trace.columns.filter((column) => !isSame(old.byName.get(column.name), column)).map(({ name }) => name));
    for (const column of trace.columns) Object.assign(old.byName.get(column.name), column);
    const claims = JSON.stringify(old.header.claims) !== JSON.stringify(trace.header.claims);
    Object.assign(old, { events: trace.events, header: trace.header });
    for (const block of shared.groups.flatMap((group) => group.blocks)) {
      if (!block.names.some((name) => changed.has(name))) continue;
      if (block.refill) block.refill();
      block.stale = true;
    }
    if (claims) {
      const { folded, hidden } = remembered();
      const at = shared.groups.findIndex((group) => group.title === 'Claims' && group.blocks.every((block) => block.gutter.classList.contains('wide')));
      const [group] = claimGroups(shared);
      shared.groups[at].element.replaceWith(group.element);
      shared.groups[at] = group;
      settle(group, folded, hidden);
    }
  } else {
    shared.traces = [trace];
    shared.scans = trace.rows;
    shared.cycleNs = trace.header.cycle_ns;
    shared.numbers = Float64Array.from({ length: trace.rows }, (_, scan) => scan);
  }
  shared.events = trace.events.map(([scan, subject, text]) => ({ trace: shared.traces[0], scan, subject, text }));
  shared.theme = shared.theme || readTheme();
  const marks = told.why.filter((reason) => reason.scan !== null).map((reason) => Math.min(reason.scan, trace.rows - 1));
  shared.marks = [...new Set(marks)];
  find('#marks').replaceChildren(...shared.marks.map((scan) => element('div', { className: 'mark-line', title: `scan ${scan}` })));
  find('#diagram').hidden = false;
  if (!same) {
    const { folded, hidden } = remembered();
    watcher.disconnect();
    shared.groups = makeGroups(shared);
    for (const group of shared.groups) settle(group, folded, hidden);
    find('#groups').replaceChildren(...shared.groups.map((group) => group.element));
  }
  if (!wired) {
    wired = true;
    wire();
  }
  if (view) shared.view = { min: view.min, max: view.max };
  else if (before !== shared.scans) shared.view = { min: 0, max: shared.scans };
  if (!same) {
    shared.refresh();
    layOut();
  }
  if (same && !view) {
    listEvents();
    schedule();
  } else {
    setView(shared.view.min, shared.view.max);
  }
  const cursor = view && view.cursor !== undefined ? view.cursor : shared.cursor;
  setCursor(cursor === null || (before === 0 && !view) ? shared.marks[0] || 0 : cursor);
}

// What a link keeps of the view.
export function viewed() {
  return { min: shared.view.min, max: shared.view.max, cursor: shared.cursor };
}

export { setTheme, setCursor, element, shared };
