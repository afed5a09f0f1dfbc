// Small charts of plans and of axes led by hand: lines over time in a canvas.

// What colours mean now.
export function colours() {
  const style = getComputedStyle(document.documentElement);
  return (name) => style.getPropertyValue(`--${name}`).trim();
}

// A canvas of the size it has on the page, cleared, and its context in CSS pixels.
export function fresh(canvas) {
  const ratio = window.devicePixelRatio || 1;
  const { clientWidth: width, clientHeight: height } = canvas;
  canvas.width = Math.max(1, Math.round(width * ratio));
  canvas.height = Math.max(1, Math.round(height * ratio));
  const context = canvas.getContext('2d');
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  return { context, width, height };
}

// Lines `{points: [[x, y]..], colour, dash}` in one box, with the greatest magnitude of y at its left.
export function chart(canvas, lines, title, span) {
  const colour = colours();
  const { context, width, height } = fresh(canvas);
  const all = lines.flatMap(({ points }) => points);
  const most = (index) => all.reduce((found, point) => (Number.isFinite(point[index]) ? Math.max(found, point[index]) : found), -Infinity);
  const least = all.reduce((found, [, y]) => (Number.isFinite(y) ? Math.min(found, y) : found), Infinity);
  const [top, bottom] = [Math.max(most(1), 0), Math.min(least, 0)];
  const end = span || Math.max(most(0), 1e-9);
  const x = (time) => 4 + (time / end) * (width - 8);
  const y = (value) => 16 + ((top - value) / (top - bottom || 1)) * (height - 22);
  context.strokeStyle = colour('grid');
  context.beginPath();
  context.moveTo(4, y(0));
  context.lineTo(width - 4, y(0));
  context.stroke();
  lines.forEach(({ points, colour: name, dash }) => {
    context.strokeStyle = colour(name);
    context.lineWidth = 1.5;
    context.setLineDash(dash ? [4, 3] : []);
    context.beginPath();
    points.forEach(([time, value]) => Number.isFinite(value) && context.lineTo(x(time), y(value)));
    context.stroke();
  });
  context.setLineDash([]);
  context.fillStyle = colour('muted');
  context.font = '11px system-ui, sans-serif';
  const size = Math.max(top, -bottom);
  context.fillText(`${title}${Number.isFinite(size) ? `, at most ${Number(size.toPrecision(6))}` : ''}`, 6, 11);
}
