// The page: which script is open, when it runs, what is shown of it.

import { element, setCursor, shared, show, viewed, write } from './board.js';
import { makeEditor } from './editor.js';
import { ask, end } from './engine.js';
import { useNames, useSchema } from './schema.js';
import { makeHand } from './hand.js';
import { makePlans } from './plans.js';
import { follow, forget } from './served.js';

const PATIENCE = 250; // ms until a run shows that it is busy
const RESTS = 300; // ms at most until events and claims follow what is dragged

const find = (selector) => document.querySelector(selector);

// What is open: the script first, then the files it names; why some of those cannot be had.
const open = { name: 'script.scan.json', texts: new Map(), shown: 'script.scan.json', lacks: undefined };
let gallery = []; // scripts to pick, by groups; the first group is the folder's where `standstill serve` shows one
let wantedView = null; // that of a link, for the first run
let running = null; // the request at the worker
let waiting = false; // the text has changed since
let rested = 0; // when all of a run was told

const editor = makeEditor(find('#editor'), (text) => {
  open.texts.set(open.shown, text);
  rerun();
});

function trouble(text) {
  find('#trouble').hidden = !text;
  find('#trouble').textContent = text || '';
}

let telling = 0;
function tell(text) {
  clearTimeout(telling);
  find('#told').textContent = text;
  find('#told').hidden = false;
  telling = setTimeout(() => { find('#told').hidden = true; }, 6000);
}

function project() {
  const [text, files] = [open.texts.get(open.name), {}];
  for (const [name, file] of open.texts) if (name !== open.name) files[name] = file;
  return { name: open.name, text, files, ...(open.lacks && { lacks: open.lacks }) };
}

// Runs what is in the editor now, and once more if that changed on the way: never two runs at once. The next one goes on in the
// worker while this page draws the one before.
async function rerun() {
  if (running) {
    waiting = true;
    return;
  }
  const mine = project();
  running = mine;
  const busy = setTimeout(() => { find('#busy').hidden = false; }, PATIENCE);
  find('#progress').removeAttribute('value');
  find('#done').textContent = '';
  const done = () => {
    clearTimeout(busy);
    find('#busy').hidden = true;
    if (running === mine) running = null;
    if (waiting) {
      waiting = false;
      rerun();
    }
  };
  try {
    const { about, reals, took } = await ask('run', [mine], ({ scans, of }) => {
      find('#progress').value = scans / of;
      find('#done').textContent = `${scans} of ${of} scans`;
    });
    done();
    // While the next run goes on, as when a number is dragged, what is there to read waits; not for long.
    const isRest = !running || performance.now() - rested > RESTS;
    if (isRest) rested = performance.now();
    tellRun(about, reals, took, isRest);
  } catch (error) {
    if (running === mine) done();
    outcome(error.message, 'bad');
    tellDigest('');
  }
}

function tellDigest(digest) {
  find('#digest').textContent = digest;
  find('#digest').parentElement.hidden = digest === '';
}

function outcome(text, className) {
  write('#verdict', text);
  find('#verdict').className = className;
  document.documentElement.dataset.runs = String(Number(document.documentElement.dataset.runs || 0) + 1);
}

let mistakes = [];

function markMistakes() {
  const here = mistakes.filter((one) => one.from && (one.file || open.name) === open.shown);
  editor.mark(here.map((one) => ({ ...one, message: [one.message, one.label, one.help && `help: ${one.help}`].filter(Boolean).join('\n') })));
  const rows = mistakes.filter((one) => one.severity === 'error').map((one) => {
    const file = one.file || open.name;
    const place = one.from ? `${open.texts.size > 1 ? `${file}:` : ''}${one.from.join(':')} ` : '';
    const button = element('button', { type: 'button', className: 'mistake' }, element('b', { textContent: `${place}${one.code}: ` }), one.message,
      one.help ? element('span', { className: 'remedy', textContent: ` help: ${one.help}` }) : null);
    button.addEventListener('click', () => {
      if (!one.from) return;
      if (file !== open.shown && open.texts.has(file)) showFile(file);
      editor.goTo(one.from);
    });
    return element('li', {}, button);
  });
  find('#mistakes').replaceChildren(...rows);
  find('#mistakes').hidden = rows.length === 0;
}

// What there is to read of a run: warnings, failures, and why.
function tellReasons(about) {
  mistakes = about.warnings.map((one) => ({ ...one, severity: one.kind === 'note' ? 'info' : 'warning' }));
  markMistakes();
  const reasons = about.why.map(({ scan, text }) => {
    const line = element('p', {}, element('span', { textContent: text }));
    if (scan !== null) {
      const button = element('button', { type: 'button', className: 'goto', textContent: `scan ${scan}` });
      button.addEventListener('click', () => setCursor(scan));
      line.prepend(button, ' ');
    }
    return line;
  });
  const failures = about.trace.header.claims.flatMap((claim) => (claim.failures || []).map((failure) => failure.text));
  const failed = failures.slice(0, 12).map((text) => element('p', { className: 'failure', textContent: text }));
  find('#why').replaceChildren(...failed, ...reasons);
  find('#why').hidden = failed.length + reasons.length === 0;
  find('#warnings').replaceChildren(...about.warnings.slice(0, 8).map((one) =>
    element('li', {}, element('b', { textContent: `${one.path} (${one.kind}): ` }), one.message)));
  find('#warnings').hidden = about.warnings.length === 0;
}

function tellRun(about, reals, took, isRest) {
  if (about.refused !== undefined || about.diagnostics) {
    mistakes = (about.diagnostics || []).map((one) => ({ ...one, severity: 'error' }));
    markMistakes();
    tellDigest('');
    find('#took').textContent = find('#diagram').hidden ? '' : 'below is the run before';
    find('#diagram').classList.add('stale');
    const count = mistakes.length;
    outcome(about.refused !== undefined ? `Refused: ${about.refused}` : `${count} mistake${count === 1 ? '' : 's'} in the script`, 'bad');
    return;
  }
  if (isRest) tellReasons(about);
  find('#diagram').classList.remove('stale');
  tellDigest(about.digest);
  find('#took').textContent = `${about.rows} scans in ${took < 10 ? took.toFixed(1) : Math.round(took)} ms`;
  useNames(about.columns.map((column) => column.name), about.trace.header.axes.map((axis) => axis.name));
  show(about, reals, wantedView, isRest);
  wantedView = null;
  outcome(about.verdict, about.passed ? 'good' : 'bad');
}

function showFile(name) {
  open.shown = name;
  editor.open(name, open.texts.get(name));
  markMistakes();
  listFiles();
}

function listFiles() {
  const texts = [...open.texts].filter(([, text]) => typeof text === 'string');
  const buttons = texts.map(([name]) => {
    const button = element('button', { type: 'button', textContent: name, ariaPressed: String(name === open.shown) });
    button.addEventListener('click', () => showFile(name));
    return button;
  });
  find('#files').replaceChildren(...buttons);
  find('#files').hidden = buttons.length < 2;
}

// Opens a script with its files: `{name, text, files}`, where a file that is no text is `{base64}`.
function openProject({ name, text, files, lacks }) {
  forget();
  open.name = name;
  open.lacks = lacks;
  open.texts = new Map([[name, text], ...Object.entries(files || {})]);
  mistakes = [];
  showFile(name);
  document.title = `${name} - standstill playground`;
  return rerun();
}

async function fetched(path) {
  const answer = await fetch(new URL(path, import.meta.url));
  if (!answer.ok) throw new Error(`${path}: ${answer.status} ${answer.statusText}`);
  return answer;
}

// What the folder has of a script, when it was saved: the page has it, too, and what was changed here can be undone.
function refill({ name, text, files, lacks }) {
  const texts = new Map([[name, text], ...Object.entries(files)]);
  const shown = texts.has(open.shown) ? open.shown : name;
  Object.assign(open, { texts, lacks });
  if (shown === open.shown) editor.replace(texts.get(shown));
  else showFile(shown);
  listFiles();
  tell(`${name} was saved: read again.`);
  return rerun();
}

// Opens a script of the folder that `standstill serve` shows.
async function openServed(path) {
  const served = gallery.find((group) => group.served);
  if (!served) {
    trouble('Scripts of a folder are opened by `standstill serve FOLDER`; this page comes from a web server.');
    return false;
  }
  return follow(path, { opened: openProject, saved: refill, trouble });
}

// Opens a script of the gallery or the tutorial by its name.
async function pick(name) {
  const found = gallery.flatMap(({ group, scripts }) => scripts.map((script) => ({ group, ...script }))).find((script) => script.name === name);
  if (!found) {
    trouble(`There is no script “${name}” in the gallery.`);
    return false;
  }
  const text = async (path) => (await fetched(`scripts/${found.group}/${path}`)).text();
  const file = `${name}.scan.json`;
  const texts = await Promise.all([file, ...found.files].map(text));
  find('#pick').value = name;
  await openProject({ name: file, text: texts[0], files: Object.fromEntries(found.files.map((path, at) => [path, texts[at + 1]])) });
  return true;
}

// A link as the page makes it.
const isProject = (content) => content && typeof content.name === 'string' && typeof content.text === 'string'
  && (content.files === undefined || (typeof content.files === 'object' && content.files !== null
    && Object.values(content.files).every((file) => typeof file === 'string' || (file && typeof file.base64 === 'string'))));

function isView(view) {
  return view && [view.min, view.max].every(Number.isFinite) && view.max > view.min && (view.cursor === undefined || Number.isInteger(view.cursor));
}

async function openLink(link) {
  const answer = await ask('share', [{ unpack: link }]);
  if (answer.refused || !isProject(answer.content)) {
    trouble(answer.refused || 'this link holds no script');
    return false;
  }
  wantedView = isView(answer.content.view) ? answer.content.view : null;
  find('#pick').value = '';
  await openProject(answer.content);
  return true;
}

async function share() {
  const { lacks, ...packed } = project();
  const answer = await ask('share', [{ pack: { ...packed, view: viewed() } }]);
  if (answer.refused) {
    tell(answer.refused);
    return;
  }
  history.replaceState(null, '', `${location.pathname}#s=${answer.link}`);
  try {
    await navigator.clipboard.writeText(location.href);
    tell('The address holds the script now, and is copied.');
  } catch {
    tell('The address holds the script now: copy it from the address bar.');
  }
}

const FORMS = { csv: 'text/csv', vcd: 'text/plain', svg: 'image/svg+xml', report: 'text/html' };

async function save(form) {
  const stem = open.name.replace(/\.scan\.json$/, '').replace(/[^\w.-]/g, '_') || 'script';
  let text = open.texts.get(open.name);
  if (form !== 'script') {
    const answer = await ask('save', [project(), form]);
    if (answer.text === undefined) {
      tell(answer.refused || 'The script has mistakes: there is nothing to save.');
      return;
    }
    text = answer.text;
  }
  const ending = { report: 'html', script: 'scan.json' }[form] || form;
  const url = URL.createObjectURL(new Blob([text], { type: FORMS[form] || 'application/json' }));
  element('a', { href: url, download: `${stem}.${ending}` }).click();
  setTimeout(() => URL.revokeObjectURL(url), 1000);
}

// Tabs as the pattern of that name has them: arrows move, the panel follows.
const views = {
  run: () => {},
  plan: () => makePlans(find('#view-plan'), (lines) => ask('plan', [lines])),
  hand: () => makeHand(find('#view-hand'), (request) => ask('hand', [request])),
};

function turnTo(name) {
  for (const other of Object.keys(views)) {
    const [tab, panel] = [find(`#tab-${other}`), find(`#view-${other}`)];
    tab.ariaSelected = String(other === name);
    tab.tabIndex = other === name ? 0 : -1;
    panel.hidden = other !== name;
    if (other === name && !panel.dataset.made) {
      panel.dataset.made = 'true';
      views[name]();
    }
    panel.dispatchEvent(new CustomEvent(other === name ? 'seen' : 'unseen'));
  }
}

function listen() {
  find('#pick').addEventListener('change', ({ target }) => {
    trouble('');
    const path = target.value.startsWith('/') ? target.value.slice(1) : null;
    const wanted = path === null ? `gallery=${encodeURIComponent(target.value)}` : `script=${encodeURIComponent(path)}`;
    history.replaceState(null, '', `${location.pathname}?${wanted}`);
    (path === null ? pick(target.value) : openServed(path)).catch((error) => trouble(error.message));
  });
  // A folder may have other scripts by now.
  find('#pick').addEventListener('focus', () => {
    if (gallery.some((group) => group.served)) listScripts().catch((error) => trouble(error.message));
  });
  find('#cancel').addEventListener('click', () => end('cancelled'));
  find('#share').addEventListener('click', () => share().catch((error) => tell(error.message)));
  find('#save').addEventListener('change', ({ target }) => {
    const form = target.value;
    target.value = '';
    if (form) save(form).catch((error) => tell(error.message));
  });
  window.addEventListener('hashchange', () => {
    const link = new URLSearchParams(location.hash.slice(1)).get('s');
    if (link) openLink(link);
  });
  const names = Object.keys(views);
  names.forEach((name, at) => {
    find(`#tab-${name}`).addEventListener('click', () => turnTo(name));
    find(`#tab-${name}`).addEventListener('keydown', (event) => {
      const by = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      if (!by) return;
      const next = names[(at + by + names.length) % names.length];
      turnTo(next);
      find(`#tab-${next}`).focus();
      event.preventDefault();
      event.stopPropagation();
    });
  });
}

// Fills the picker; a script of a folder has its path as value, behind a slash.
async function listScripts() {
  gallery = await (await fetched('scripts.json')).json();
  const groups = gallery.map(({ label, served, scripts }) => element('optgroup', { label }, ...scripts.map(({ name, title }) =>
    element('option', { value: served ? `/${name}` : name, textContent: title.length > 70 ? `${title.slice(0, 69)}…` : title, title }))));
  const { value } = find('#pick');
  find('#pick').replaceChildren(element('option', { value: '', textContent: '(your own)' }), ...groups);
  find('#pick').value = value;
}

async function start() {
  listen();
  // Compiling goes on while the texts come.
  ask('share', [{ unpack: '' }]).catch(() => {});
  const link = new URLSearchParams(location.hash.slice(1)).get('s');
  await listScripts();
  const wanted = new URLSearchParams(location.search);
  const [script, name] = [wanted.get('script'), wanted.get('gallery')];
  const [served] = gallery.filter((group) => group.served).flatMap((group) => group.scripts);
  const first = () => (served ? openServed(served.name) : pick('slide'));
  const opened = link ? await openLink(link) : script !== null ? await openServed(script) : name !== null && await pick(name);
  if (!opened && !await first() && served) await pick('slide');
  useSchema(await (await fetched('schema.json')).json());
}

start().catch((error) => trouble(error.message)).finally(() => { document.documentElement.dataset.ready = 'true'; });

// For tests: the workers that the page itself asks, the diagram, and the cursor behind a piece of text.
Object.assign(window, { playground: { ask, openProject, shared, cursor: editor.goBehind } });
