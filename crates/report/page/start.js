// Unpacks what the file holds, and shows it.

async function start() {
  const about = JSON.parse(find('#about').textContent);
  const texts = [...document.querySelectorAll('script.rows')].map((script) => script.textContent);
  for (const [index, trace] of about.traces.entries()) {
    const { rows, columns } = await decode(texts[index]);
    shared.traces.push({
      ...trace, index, letter: LETTERS[index], rows, columns, byName: new Map(columns.map((column) => [column.name, column])),
    });
  }
  shared.scans = Math.max(...shared.traces.map((trace) => trace.rows));
  shared.cycleNs = shared.traces[0].header.cycle_ns;
  shared.numbers = Float64Array.from({ length: shared.scans }, (_, scan) => scan);
  shared.view = { min: 0, max: shared.scans };
  shared.theme = readTheme();
  shared.events = shared.traces.flatMap((trace) => trace.events.map(([scan, subject, text]) => ({ trace, scan, subject, text })))
    .sort((one, other) => one.scan - other.scan);
  shared.marks = about.marks.map((scan) => Math.min(scan, shared.scans - 1));
  find('#marks').replaceChildren(...shared.marks.map((scan) => element('div', { className: 'mark-line', title: `scan ${scan}` })));
  shared.groups = makeGroups(shared);
  find('#groups').replaceChildren(...shared.groups.map((group) => group.element));
  for (const group of shared.groups) {
    for (const block of group.blocks) {
      block.element.block = block;
      watcher.observe(block.element);
    }
  }
  wire();
  shared.refresh();
  layOut();
  listEvents();
  setCursor(shared.marks.length > 0 ? shared.marks[0] : 0);
  document.documentElement.dataset.ready = 'true';
}

start().catch((error) => {
  const message = typeof DecompressionStream === 'undefined'
    ? 'This browser is too old for this report: it cannot unpack the rows (DecompressionStream is missing).'
    : `This report is damaged: ${error.message}`;
  find('#trouble').textContent = message;
  find('#trouble').hidden = false;
  throw error;
});
