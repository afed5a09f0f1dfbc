// Panels of curves: uPlot draws the lines, this file says what is in a panel, its range and its limits.

const CURVE = 112; // height of a panel (CSS pixels)
const AXIS = 58; // room for the labels of values, left of every plot
const MARGIN = 14; // right of every plot

// Signals of an axis that share a panel; any other number of an axis has a panel of its own.
const PANELS = [
  { title: 'Position', per: '', signals: ['Position', 'ActualPosition'], bounds: ['position_min', 'position_max'] },
  { title: 'Velocity', per: '/s', signals: ['Velocity', 'ActualVelocity'], bounds: ['velocity'] },
  { title: 'Acceleration', per: '/s²', signals: ['Acceleration'], bounds: ['acceleration', 'deceleration'] },
  { title: 'Jerk', per: '/s³', signals: ['Jerk'], bounds: ['jerk'] },
  { title: 'Snap', per: '/s⁴', signals: ['Snap'], bounds: ['snap'] },
];

// What the panel must stay within: `{value, text}`. Rates bound both directions.
function limitsOf(panel, axis) {
  const found = [];
  for (const name of panel.bounds) {
    const value = axis.limits[name];
    if (value === undefined || value === null) continue;
    // Acceleration and deceleration are rates of either direction, so each bounds both sides.
    found.push(...(name.startsWith('position') ? [value] : [value, -value]));
  }
  return [...new Set(found)];
}

// The range of values to show: what is in view with some room, and limits that are near.
function rangeOf(least, greatest, limits) {
  if (!Number.isFinite(least) || !Number.isFinite(greatest)) return [-1, 1];
  let [low, high] = [least, greatest];
  const span = high - low || Math.abs(high) || 1;
  for (const limit of limits) {
    if (limit > high && limit - high < 0.6 * Math.max(span, Math.abs(high))) high = limit;
    if (limit < low && low - limit < 0.6 * Math.max(span, Math.abs(low))) low = limit;
  }
  const room = 0.1 * (high - low) || 0.5 * Math.abs(high) || 1;
  return [low - room, high + room];
}

// Lines where values are held between scans. Far out the steps are narrower than a pixel, and a line is the same.
function held(u, series, first, last) {
  const paths = last - first > 4 * u.bbox.width ? uPlot.paths.linear() : uPlot.paths.stepped({ align: -1 });
  return paths(u, series, first, last);
}

// The values of a column for uPlot, which takes null for a gap.
function plotted(column, rows, scans) {
  const values = column.reals;
  if (rows === scans && values.every(Number.isFinite)) return values;
  return Array.from({ length: scans }, (_, scan) => (scan < rows && Number.isFinite(values[scan]) ? values[scan] : null));
}

// A plot in `place` of the `lines` ({column, rows, colour, actual}) over all `scans`.
function makePlot(place, width, scans, lines, limits, shared) {
  const series = lines.map((line) => ({
    stroke: () => line.colour(),
    width: line.actual ? 1 : 1.6,
    dash: line.actual ? [3, 3] : undefined,
    points: { show: false },
    pxAlign: 0,
    paths: line.column.signal === 'Snap' ? held : undefined,
  }));
  const drawLimits = (u) => {
    const context = u.ctx, ratio = devicePixelRatio || 1;
    context.save();
    context.strokeStyle = shared.theme.limit;
    context.lineWidth = ratio;
    context.setLineDash([6 * ratio, 4 * ratio]);
    for (const limit of limits) {
      if (limit < u.scales.y.min || limit > u.scales.y.max) continue;
      const y = Math.round(u.valToPos(limit, 'y', true)) + 0.5;
      context.beginPath();
      context.moveTo(u.bbox.left, y);
      context.lineTo(u.bbox.left + u.bbox.width, y);
      context.stroke();
    }
    context.restore();
  };
  const line = () => ({ stroke: () => shared.theme.grid, width: 1 });
  return new uPlot({
    width, height: CURVE, padding: [6, MARGIN, 6, 0],
    cursor: { show: false }, legend: { show: false }, select: { show: false },
    scales: {
      x: { time: false, range: () => [shared.view.min, shared.view.max] },
      y: { range: (u, least, greatest) => rangeOf(least, greatest, limits) },
    },
    axes: [
      { size: 0, ticks: { show: false }, values: (u, splits) => splits.map(() => ''), splits: () => shared.ticks, grid: line() },
      {
        size: AXIS, gap: 4, space: 26, font: shared.theme.small, stroke: () => shared.theme.muted,
        ticks: { show: false }, grid: line(), values: (u, splits) => splits.map((split) => (split === null ? '' : compact(split))),
      },
    ],
    series: [{}, ...series],
    hooks: { draw: [drawLimits] },
  }, [shared.numbers, ...lines.map((line) => plotted(line.column, line.rows, scans))], place);
}
