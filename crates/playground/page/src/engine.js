// The workers that read, run and plan. Each is asked one thing at a time; a run that takes too long is ended with its worker.
// Programs and expressions need a compiler and an interpreter, and downloads the page of reports: two thirds of a megabyte packed.
// The worker that has them begins when it is needed.

const LONGEST = 60_000; // ms of a run

class Engine {
  constructor(name) {
    this.name = name;
    this.module = null; // compiled once, for every worker
    this.asked = new Map();
    this.number = 0;
  }

  async compiled() {
    const file = `${this.name}.wasm`;
    const answer = await fetch(new URL(file, import.meta.url));
    if (!answer.ok) throw new Error(`${file}: ${answer.status} ${answer.statusText}`);
    return WebAssembly.compile(await answer.arrayBuffer());
  }

  begin() {
    this.module = this.module || this.compiled();
    const worker = new Worker(new URL(`${this.name}.worker.js`, import.meta.url), { type: 'module' });
    this.worker = worker;
    const broke = (why) => worker === this.worker && this.end(why);
    worker.onmessage = ({ data }) => {
      const one = this.asked.get(data.id);
      if (!one) return;
      if (data.progress) {
        if (one.progress) one.progress(data.progress);
        return;
      }
      this.asked.delete(data.id);
      clearTimeout(one.timer);
      if (data.error !== undefined) {
        one.fail(new Error(data.error));
        // What is left of a program that broke is not asked again.
        broke('the worker broke');
      } else {
        one.done(data.answer);
      }
    };
    worker.onerror = (event) => broke(event.message || 'the worker could not be started');
    this.ready = this.module.then((module) => worker.postMessage({ module }));
    this.ready.catch((error) => {
      this.module = null;
      broke(error.message);
    });
  }

  end(why) {
    if (this.worker) this.worker.terminate();
    this.worker = null;
    const left = this.asked;
    this.asked = new Map();
    for (const { fail, timer } of left.values()) {
      clearTimeout(timer);
      fail(new Error(why));
    }
  }

  ask(what, args, progress) {
    if (!this.worker) this.begin();
    const id = ++this.number;
    const to = this.worker;
    return new Promise((done, fail) => {
      const late = () => this.end(`ended after ${LONGEST / 1000} s: the command line runs it to its end`);
      const one = { done, fail, progress };
      this.asked.set(id, one);
      // What cannot be loaded was told to everybody who waits.
      this.ready.then(() => {
        if (to !== this.worker) return;
        one.timer = setTimeout(late, LONGEST);
        to.postMessage({ id, what, args });
      }, () => {});
    });
  }
}

const plain = new Engine('playground');
const guests = new Engine('guests');

// Ends what runs; whoever waits for it is told why.
export function end(why) {
  plain.end(why);
  guests.end(why);
}

// Asks for `what` with these arguments.
export async function ask(what, args, progress) {
  const answer = await plain.ask(what, args, progress);
  const told = what === 'run' ? answer.about : answer;
  return told && told.needs === 'guests' ? guests.ask(what, args, progress) : answer;
}
