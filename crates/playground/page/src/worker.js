// Runs beside the page: whatever a script does here, the page answers.

import { initSync, check, run, plan, share, save, hand } from 'playground:glue';

const does = {
  check: (request) => JSON.parse(check(JSON.stringify(request))),
  plan: (lines) => plan(lines),
  share: (request) => JSON.parse(share(JSON.stringify(request))),
  save: (request, form) => JSON.parse(save(JSON.stringify(request), form)),
  hand: (request) => JSON.parse(hand(JSON.stringify(request))),
};

self.onmessage = ({ data }) => {
  if (data.module) {
    initSync({ module: data.module });
    return;
  }
  const { id, what, args } = data;
  try {
    if (what === 'run') {
      const since = performance.now();
      const tell = (scans, of) => self.postMessage({ id, progress: { scans, of } });
      const ran = run(JSON.stringify(args[0]), { tell });
      const done = performance.now() - since;
      const [about, reals] = [JSON.parse(ran.about()), ran.reals()];
      ran.free();
      self.postMessage({ id, answer: { about, reals, ran: done, took: performance.now() - since } }, [reals.buffer]);
    } else {
      self.postMessage({ id, answer: does[what](...args) });
    }
  } catch (error) {
    self.postMessage({ id, error: `internal fault: ${error.message}` });
  }
};
