// The panel of a cam: the slave over the place of its master within a period, above the curve of the table.

const CAM = 190; // height of the panel (CSS pixels)
const CAM_FOOT = 18; // of which the labels of the master take

// How far from its first row a table leads at this part of its length.
function camAt({ points }, part) {
  const place = part * (points.length - 1), before = Math.min(Math.floor(place), points.length - 2);
  return points[before] + (place - before) * (points[before + 1] - points[before]);
}

// The rows in which a cam lay so: `{first, parts, slaves}`. The master is told as the part of the period behind it, the slave (u) without
// what whole periods add.
function camRows(cam, trace) {
  const { axes } = trace.header, [first, end] = cam.scans, length = Math.max(0, Math.min(end + 1, trace.rows) - first);
  const [slave, master] = [axes[cam.slave], axes[cam.master]];
  const reals = ({ name }) => trace.byName.get(`${name}.Position`).reals;
  const [at, behind] = [reals(master), reals(slave)];
  const rise = cam.points[cam.points.length - 1];
  const parts = new Float64Array(length), slaves = new Float64Array(length);
  let turns = 0;
  for (let row = 0; row < parts.length; row++) {
    const scan = first + row;
    // A master with turns goes less than half of one in a scan.
    if (master.modulo && row > 0) turns -= Math.round((at[scan] - at[scan - 1]) / master.modulo);
    const way = (at[scan] + turns * (master.modulo || 0) - cam.begin) / cam.length;
    const periods = cam.periodic ? Math.floor(way) : 0;
    parts[row] = Math.min(Math.max(way - periods, 0), 1);
    slaves[row] = behind[scan] - periods * rise;
    if (slave.modulo) slaves[row] -= slave.modulo * Math.round((slaves[row] - cam.from - camAt(cam, parts[row])) / slave.modulo);
  }
  return { first, parts, slaves };
}

function camBlock(axis, lines, shared) {
  const masters = [...new Set(lines.flatMap(({ trace, cams }) => cams().map(({ master }) => trace.header.axes[master].name)))];
  const unit = (name) => ((shared.traces[0].header.axes.find((one) => one.name === name) || axis).unit);
  const bracketed = (text) => (text ? ` (${text})` : '');
  const readings = lines.map(() => element('output', { className: 'place' }));
  const several = shared.traces.length > 1;
  const series = (kind, tint, label, ...rest) => element('div', { className: 'series' },
    element('span', { className: `swatch ${kind}`, style: `color: ${tint}` }), element('span', { className: 'label', textContent: label }), ...rest);
  const gutter = element('div', { className: 'gutter tall' },
    element('div', { className: 'name', title: `${axis.name} over ${masters.join(', ')}`, textContent: 'Cam' },
      element('span', { className: 'unit', textContent: `${bracketed(axis.unit)} over ${masters.join(', ')}${bracketed(unit(masters[0]))}` })),
    series('table', 'var(--muted)', 'table'),
    ...lines.map(({ trace }, at) => series('', `var(--trace-${trace.index})`, several ? trace.letter : 'slave', readings[at])));
  const canvas = element('canvas', {});
  const dot = element('span', { className: 'dot' });
  const plot = element('div', { className: 'plot cam', style: `height: ${CAM}px` }, canvas, dot);
  let rows = null, spots = [], placed = () => [0, 0];
  // Every cam of every line with its rows, found when they are first asked for.
  const known = () => (rows = rows || lines.map(({ trace, cams }) => cams().map((cam) => ({ cam, trace, ...camRows(cam, trace) }))));
  const inView = () => known().flat().filter(({ cam }) => cam.scans[0] <= shared.view.max && cam.scans[1] >= shared.view.min);
  const block = {
    gutter, names: [`${axis.name}.Cam`, `${axis.name}.Position`, ...masters.map((name) => `${name}.Position`)],
    element: element('div', { className: 'block curve', role: 'group', ariaLabel: `${axis.name}.Cam` }, gutter, plot),
    tell(scan) {
      known().forEach((cams, at) => {
        const found = cams.find(({ cam }) => cam.scans[0] <= scan && scan <= cam.scans[1]);
        const row = found && scan - found.first;
        const master = found && found.parts[row] * Math.abs(found.cam.length);
        const text = found ? `${compact(master)} → ${compact(found.slaves[row])}` : '';
        if (readings[at].textContent !== text) readings[at].textContent = text;
        if (at > 0) return;
        dot.hidden = !found;
        if (found) [dot.style.left, dot.style.top] = placed(master, found.slaves[row]).map((place) => `${place}px`);
      });
    },
    draw() {
      const width = shared.width, context = fresh(canvas, width + AXIS + MARGIN, CAM);
      const { theme, view } = shared, shown = inView();
      const longest = Math.max(...shown.map(({ cam }) => Math.abs(cam.length)), 0) || 1;
      let [least, greatest] = [Infinity, -Infinity];
      const reach = (value) => {
        least = Math.min(least, value);
        greatest = Math.max(greatest, value);
      };
      const each = ({ first, parts, slaves }, see) => {
        const end = Math.min(parts.length - 1, Math.floor(view.max) - first);
        for (let row = Math.max(0, Math.ceil(view.min) - first); row <= end; row++) see(parts[row], slaves[row], first + row);
      };
      for (const one of shown) {
        one.cam.points.forEach((point) => reach(one.cam.from + point));
        each(one, (part, slave) => reach(slave));
      }
      const [low, high] = rangeOf(least, greatest, []);
      const x = (place) => AXIS + (place / longest) * width;
      const y = (slave) => 6 + ((high - slave) / (high - low)) * (CAM - CAM_FOOT - 6);
      placed = (place, slave) => [x(place), y(slave)];
      const label = (text, left, top, align, colour) => {
        Object.assign(context, { fillStyle: colour, font: theme.small, textAlign: align, textBaseline: 'middle' });
        context.fillText(text, left, top);
      };
      context.strokeStyle = theme.grid;
      context.lineWidth = 1;
      const grid = (...ends) => {
        context.beginPath();
        context.moveTo(...ends.slice(0, 2));
        context.lineTo(...ends.slice(2));
        context.stroke();
      };
      for (const place of rounds(0, longest, Math.max(2, width / 90))) {
        grid(x(place), 6, x(place), CAM - CAM_FOOT);
        label(compact(place), x(place), CAM - CAM_FOOT / 2, 'center', theme.muted);
      }
      for (const slave of rounds(low, high, 5)) {
        grid(AXIS, y(slave), AXIS + width, y(slave));
        label(compact(slave), AXIS - 5, y(slave), 'right', theme.muted);
      }
      context.lineJoin = 'round';
      context.strokeStyle = theme.muted;
      context.globalAlpha = 0.35;
      context.lineWidth = 5;
      for (const { cam } of shown) {
        context.beginPath();
        cam.points.forEach((point, at) => context.lineTo(x((at / (cam.points.length - 1)) * Math.abs(cam.length)), y(cam.from + point)));
        context.stroke();
      }
      context.globalAlpha = 1;
      context.lineWidth = 1.6;
      spots = [];
      for (const one of shown) {
        const size = Math.abs(one.cam.length);
        let last = null;
        context.strokeStyle = theme.traces[one.trace.index];
        context.beginPath();
        each(one, (part, slave, scan) => {
          const spot = { scan, part, x: x(part * size), y: y(slave) };
          // A point a pixel will do; behind the end of a period the line begins anew.
          if (last && Math.hypot(spot.x - last.x, spot.y - last.y) < 0.7) return;
          if (last && Math.abs(part - last.part) < 0.5) context.lineTo(spot.x, spot.y);
          else context.moveTo(spot.x, spot.y);
          last = spot;
          spots.push(spot);
        });
        context.stroke();
      }
    },
    refill: () => (rows = null),
  };
  // Here a place is no scan: the pointer leads to the scan whose place is the nearest.
  plot.addEventListener('pointermove', (event) => {
    event.stopPropagation();
    const box = canvas.getBoundingClientRect(), off = ({ x, y }) => Math.hypot(x - event.clientX + box.left, y - event.clientY + box.top);
    const nearest = spots.reduce((best, spot) => (best === null || off(spot) < off(best) ? spot : best), null);
    if (nearest !== null && off(nearest) < 30) shared.goTo(nearest.scan);
  });
  plot.addEventListener('pointerdown', (event) => event.stopPropagation());
  return hideable(block, shared);
}

// Round numbers, about `count` of them from `low` to `high`.
function rounds(low, high, count) {
  const rough = (high - low) / count, ten = 10 ** Math.floor(Math.log10(rough));
  const step = ten * [1, 2, 5, 10].find((factor) => ten * factor >= rough);
  const found = [];
  for (let at = Math.ceil(low / step); at * step <= high; at++) found.push(at * step);
  return found;
}

// The panel of an axis, if it was on a cam in one of the traces.
function camBlocks(axis, shared) {
  const lines = shared.traces.map((trace) => ({
    trace,
    // The playground gives a trace another header when it has run again.
    cams: () => (trace.header.cams || []).filter(({ slave, master, points }) => {
      const { axes } = trace.header;
      return axes[slave] && axes[slave].name === axis.name && axes[master] && points.length > 1
        && [slave, master].every((one) => trace.byName.has(`${axes[one].name}.Position`));
    }),
  })).filter(({ cams }) => cams().length > 0);
  return lines.length > 0 ? [camBlock(axis, lines, shared)] : [];
}
