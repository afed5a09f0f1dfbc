// The board: every block of the diagram, with its gutter of names and values left of its plot.
// A block has `element`, `draw(shared)`, `tell(scan)` and `names`, what the filter looks at.

// An element with these properties and children. Texts become text, never markup.
function element(tag, properties, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties || {})) {
    if (name in made) made[name] = value;
    else made.setAttribute(name, value);
  }
  made.append(...children.filter((child) => child !== null && child !== undefined));
  return made;
}

// A value in the gutter, one line for each trace that has the signal.
function readings(lines) {
  const spans = lines.map((line) => element('output', { className: 'reading', style: `color: ${line.tint || 'inherit'}` }));
  const tell = (scan) => lines.forEach((line, at) => {
    const text = textAt(line.column, scan, line.rows);
    if (spans[at].textContent !== text) {
      spans[at].textContent = text;
      spans[at].title = text;
    }
  });
  return { spans, tell };
}

const DIRECTIONS = { input: ['in', 'input'], output: ['out', 'output'], in_out: ['i/o', 'in-out'], variable: ['var', 'input variable'] };

function roleColour(theme, role) {
  return { input: theme.in, variable: theme.in, in_out: theme.both }[role] || theme.out;
}

// A block that hides itself on demand.
function hideable(block, shared) {
  const button = element('button', { className: 'hide', type: 'button', title: `Hide ${block.names[0]}`, textContent: '×' });
  button.addEventListener('click', () => {
    block.hidden = true;
    shared.refresh();
  });
  block.gutter.append(button);
  return block;
}

// A row of the timing diagram: the same signal of each trace that has it, a lane each.
function rowBlock(lines, shared) {
  const { column } = lines[0];
  const spark = column.kind === 'real' && lines.some((line) => !line.column.edges);
  const lane = spark ? SPARK : lines.length > 1 ? LANE_SHARED : LANE;
  const height = lane * lines.length + (lines.length > 1 ? 4 : 0);
  const canvas = element('canvas', {});
  const { spans, tell } = readings(lines);
  const direction = DIRECTIONS[column.role];
  const gutter = element('div', { className: 'gutter' },
    direction ? element('span', { className: `role ${column.role}`, title: direction[1], textContent: direction[0] }) : element('span', { className: 'role' }),
    element('span', { className: 'name', title: column.name, textContent: column.signal + (column.isTime ? ' (ns)' : '') }),
    element('span', { className: 'readings' }, ...spans));
  const plot = element('div', { className: 'plot row', style: `height: ${height}px` }, canvas);
  const block = {
    gutter, names: [column.name], tell,
    element: element('div', { className: 'block', role: 'group', ariaLabel: column.name }, gutter, plot),
    draw() {
      const width = shared.width, theme = shared.theme;
      const context = fresh(canvas, width, height);
      drawGrid(context, shared, height);
      lines.forEach((line, at) => {
        const box = { top: lines.length > 1 ? 2 + at * lane : 0, height: lane, width };
        const colour = lines.length > 1 ? theme.traces[line.trace.index] : roleColour(theme, column.role);
        if (line.column.kind === 'bool') drawWave(context, line.column, line.rows, shared.view, box, colour);
        else if (line.column.edges) drawBoxes(context, line.column, line.rows, shared.view, box, theme, colour);
        else drawSpark(context, line.column, line.rows, shared.view, box, colour);
      });
    },
  };
  return hideable(block, shared);
}

function drawGrid(context, shared, height) {
  const x = scale(shared.view, shared.width);
  context.strokeStyle = shared.theme.grid;
  context.lineWidth = 1;
  context.beginPath();
  for (const tick of shared.ticks) {
    context.moveTo(Math.round(x(tick)) + 0.5, 0);
    context.lineTo(Math.round(x(tick)) + 0.5, height);
  }
  context.stroke();
}

// A panel of curves.
function curveBlock(axis, panel, lines, shared) {
  const limits = limitsOf(panel, axis);
  const { spans, tell } = readings(lines);
  const unit = axis.unit ? ` (${axis.unit}${panel.per})` : '';
  const several = shared.traces.length > 1;
  const rows = lines.map((line, at) => {
    const swatch = element('span', { className: line.actual ? 'swatch actual' : 'swatch', style: `color: ${line.tint}` });
    const label = line.actual ? 'actual' : several ? line.trace.letter : 'set';
    return element('div', { className: 'series' }, swatch, element('span', { className: 'label', textContent: label }), spans[at]);
  });
  const bound = limits.length === 0 ? null : element('div', { className: 'bound', title: 'limits of the axis' });
  const tellLimits = () => {
    if (bound) bound.textContent = `limit ${limitText(limits)}`;
  };
  tellLimits();
  const gutter = element('div', { className: 'gutter tall' },
    element('div', { className: 'name', title: `${axis.name}.${panel.title}${unit}`, textContent: panel.title },
      element('span', { className: 'unit', textContent: unit })), ...rows, bound);
  const plot = element('div', { className: 'plot', style: `height: ${CURVE}px` });
  let made = null;
  const block = {
    gutter, names: lines.map((line) => line.column.name), tell,
    element: element('div', { className: 'block curve', role: 'group', ariaLabel: `${axis.name}.${panel.title}` }, gutter, plot),
    draw() {
      const width = shared.width + AXIS + MARGIN;
      if (made === null) {
        made = makePlot(plot, width, shared.scans, lines, limits, shared);
      } else if (made.width !== width) {
        made.setSize({ width, height: CURVE });
      } else {
        made.setScale('x', { min: shared.view.min, max: shared.view.max });
      }
    },
    redraw: () => made && made.redraw(false, true),
    // The axis has other limits now.
    limit(axis) {
      limits.splice(0, limits.length, ...limitsOf(panel, axis));
      tellLimits();
    },
    // The columns hold other numbers now; they are drawn when the block is.
    refill: () => made && made.setData([shared.numbers, ...lines.map((line) => plotted(line.column, line.rows, shared.scans))], false),
  };
  return hideable(block, shared);
}

function limitText(limits) {
  const [first, second] = limits;
  if (limits.length === 2 && first === -second) return `±${realText(Math.abs(first))}`;
  const sizes = [...new Set(limits.map(Math.abs))];
  if (limits.length === 4 && sizes.length === 2) return sizes.map((size) => `±${realText(size)}`).join(', ');
  return limits.map(realText).join(' .. ');
}

function claimBlock(claim, trace, shared) {
  const canvas = element('canvas', {});
  const passed = claim.verdict === 'passed';
  const label = element('button', { className: `claim ${claim.verdict}`, type: 'button',
    title: [`${claim.path}: ${claim.text}`, ...(claim.failures || []).map((failure) => failure.text)].join('\n') },
    element('span', { className: 'mark', textContent: passed ? '✓' : '✗' }),
    element('span', { className: 'name', textContent: claim.text }));
  label.addEventListener('click', () => {
    const failure = (claim.failures || []).find(({ scan }) => scan !== undefined);
    const scan = failure ? failure.scan : claim.held !== undefined ? claim.held : (claim.scans || [0])[0];
    shared.goTo(scan);
  });
  const gutter = element('div', { className: 'gutter wide' }, label);
  return {
    gutter, names: [claim.path, claim.text], tell() {},
    element: element('div', { className: 'block', role: 'group', ariaLabel: claim.path }, gutter,
      element('div', { className: 'plot', style: `height: ${LANE}px` }, canvas)),
    draw() {
      const context = fresh(canvas, shared.width, LANE);
      drawGrid(context, shared, LANE);
      drawClaim(context, claim, trace.rows, shared.view, { top: 0, height: LANE, width: shared.width }, shared.theme);
    },
  };
}

// A group of blocks below a heading that folds it. `still` are signals that never change: `[name, lines]`.
function makeGroup(title, detail, blocks, still, shared) {
  const fold = element('button', { className: 'fold', type: 'button', ariaExpanded: 'true' },
    element('span', { className: 'arrow', textContent: '▾' }),
    element('span', { className: 'title', textContent: title }),
    element('span', { className: 'detail', textContent: detail }));
  const body = element('div', { className: 'body' }, ...blocks.map((block) => block.element));
  const texts = still.map(() => document.createTextNode(''));
  // Writes the constants, which are others in another run.
  const tellStill = () => still.forEach(([, lines], at) => {
    const text = ` ${stillText(lines)}`;
    if (texts[at].data !== text) texts[at].data = text;
  });
  if (still.length > 0) {
    tellStill();
    const list = still.flatMap(([name], at) => [
      element('span', { className: 'pair' }, element('span', { className: 'key', textContent: name }), texts[at]), ' ']);
    body.append(element('p', { className: 'still' }, element('span', { className: 'lead', textContent: 'constant: ' }), ...list));
  }
  const group = { blocks, tellStill, element: element('section', { className: 'group' }, element('h2', {}, fold), body), folded: false };
  fold.addEventListener('click', () => {
    group.folded = !group.folded;
    fold.ariaExpanded = String(!group.folded);
    group.element.classList.toggle('folded', group.folded);
    shared.refresh();
  });
  return group;
}

// The lines of a signal: one for each trace that has it.
function linesOf(name, shared, actual) {
  const found = [];
  for (const trace of shared.traces) {
    const column = trace.byName.get(name);
    if (!column) continue;
    const colour = () => (actual ? shared.theme.muted : shared.theme.traces[trace.index]);
    const tint = shared.traces.length > 1 || column.role === 'value' ? (actual ? 'var(--muted)' : `var(--trace-${trace.index})`) : null;
    found.push({ trace, column, rows: trace.rows, actual: Boolean(actual), colour, tint });
  }
  return found;
}

// The text of a signal that never changes, the same in every trace; null if it changes.
function stillText(lines) {
  const texts = new Set();
  for (const { column } of lines) {
    if (!column.edges || column.edges.scans.length > 1) return null;
    if (column.edges.scans.length === 1) texts.add(entryText(column, column.edges.values[0]));
  }
  return texts.size === 1 ? [...texts][0] : null;
}

// Adds the signal to the blocks, or to what stands still.
function addRow(name, blocks, still, shared) {
  const lines = linesOf(name, shared);
  if (stillText(lines) !== null) still.push([lines[0].column.signal, lines]);
  else blocks.push(rowBlock(lines, shared));
}

// The names of a list that all traces together have, in the order in which they first come.
function together(lists) {
  return [...new Set(lists.flat())];
}

function axisGroup(axis, shared) {
  const names = together(shared.traces.map((trace) => trace.columns
    .filter((column) => column.subject === axis.name && (column.role === 'state' || column.role === 'value'))
    .map((column) => column.signal)));
  const isReal = (name) => linesOf(`${axis.name}.${name}`, shared).every((line) => line.column.kind === 'real');
  const [blocks, still] = [[], []];
  const rest = names.filter((name) => isReal(name) && !PANELS.some((panel) => panel.signals.includes(name)))
    .map((name) => ({ title: name, per: '', signals: [name], bounds: [] }));
  for (const name of names.filter((name) => !isReal(name))) addRow(`${axis.name}.${name}`, blocks, still, shared);
  for (const panel of [...PANELS, ...rest]) {
    const lines = panel.signals.flatMap((signal, at) => linesOf(`${axis.name}.${signal}`, shared, at > 0));
    if (lines.length === 0) continue;
    if (stillText(lines) !== null) still.push([panel.title, lines]);
    else blocks.push(curveBlock(axis, panel, lines, shared));
  }
  blocks.push(...camBlocks(axis, shared));
  const order = axis.order ? `axis of order ${axis.order}` : 'axis';
  const modulo = axis.modulo ? `, modulo ${realText(axis.modulo)}` : '';
  return makeGroup(axis.name, `${order}${axis.unit ? `, ${axis.unit}` : ''}${modulo}`, blocks, still, shared);
}

// The claims of each trace that has some.
function claimGroups(shared) {
  return shared.traces.filter((trace) => trace.header.claims.length > 0).map((trace) => {
    const { claims } = trace.header;
    const held = claims.filter((claim) => claim.verdict === 'passed').length;
    const name = shared.traces.length > 1 ? `Claims of ${trace.letter}` : 'Claims';
    return makeGroup(name, `${held} of ${claims.length} hold`, claims.map((claim) => claimBlock(claim, trace, shared)), [], shared);
  });
}

// Every group of the board, top to bottom: axes, claims, input variables, instances in call order.
function makeGroups(shared) {
  const groups = [];
  const axes = new Map(shared.traces.flatMap((trace) => trace.header.axes).reverse().map((axis) => [axis.name, axis]));
  for (const name of together(shared.traces.map((trace) => trace.header.axes.map((axis) => axis.name)))) {
    groups.push(axisGroup(axes.get(name), shared));
  }
  groups.push(...claimGroups(shared));
  const addGroup = (title, detail, names) => {
    const [blocks, still] = [[], []];
    names.forEach((name) => addRow(name, blocks, still, shared));
    groups.push(makeGroup(title, detail, blocks, still, shared));
  };
  const pins = shared.traces.map((trace) => trace.columns.filter((column) => column.role !== 'state' && column.role !== 'value'));
  const variables = together(pins.map((columns) => columns.filter((column) => column.role === 'variable').map((column) => column.name)));
  if (variables.length > 0) addGroup('inputs', 'input variables', variables);
  const types = new Map(shared.traces.flatMap((trace) => trace.header.instances).map((instance) => [instance.name, instance.type]));
  for (const subject of together(pins.map((columns) => columns.filter((column) => column.role !== 'variable').map((column) => column.subject)))) {
    const names = together(pins.map((columns) => columns.filter((column) => column.role !== 'variable' && column.subject === subject)
      .map((column) => column.name)));
    addGroup(subject, types.get(subject) || '', names);
  }
  return groups;
}
