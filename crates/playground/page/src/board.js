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

// What of a trace decides which blocks there are: of limits whether there are some, of constants that they are.
function shapeOf(trace) {
  const columns = trace.columns.map(({ name, kind, edges }) => [name, kind, Boolean(edges), Boolean(edges) && edges.scans.length === 1]);
  const { claims, cams, ...header } = trace.header;
  const axes = header.axes.map((axis) => ({ ...axis, limits: Object.entries(axis.limits).filter(([, limit]) => limit !== null).map(([name]) => name) }));
  const onCams = [...new Set((cams || []).map(({ slave }) => slave))];
  return JSON.stringify([trace.rows, { ...header, axes }, claims.length > 0, onCams, columns]);
}

// Tells the blocks of axes that have other limits than before, and which these axes are.
function relimit(before, axes) {
  const changed = axes.filter((axis, at) => JSON.stringify(axis.limits) !== JSON.stringify(before[at].limits));
  for (const axis of changed) {
    const group = shared.groups.find((group) => group.title === axis.name);
    for (const block of group ? group.blocks : []) if (block.limit) block.limit(axis);
  }
  return new Set(changed.map((axis) => axis.name));
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
let claimsShown = '';

// Shows a run in place of the one before; the view and the cursor stay where they are as far as they can. Unless it `isRest`,
// another run is on its way: then curves and rows follow, claims and events do not.
export function show(told, reals, view, isRest) {
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
    const limited = relimit(old.header.axes, trace.header.axes);
    Object.assign(old, { events: trace.events, header: trace.header });
    for (const block of shared.groups.flatMap((group) => group.blocks)) {
      if (!block.names.some((name) => changed.has(name) || limited.has(name.slice(0, name.indexOf('.'))))) continue;
      if (block.refill) block.refill();
      block.stale = true;
    }
    for (const group of shared.groups) group.tellStill();
    const claims = JSON.stringify(trace.header.claims);
    if (isRest && claims !== claimsShown) {
      claimsShown = claims;
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
    claimsShown = JSON.stringify(trace.header.claims);
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
    if (isRest) listEvents();
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

export { setTheme, setCursor, element, shared, write };
