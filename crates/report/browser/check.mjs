// Reports in a browser: they load without an error or a request, and show what the trace has.
//
//     node check.mjs STANDSTILL PLAYWRIGHT FOLDER
//
// with the program, the folder of the package playwright-core and a folder to write to. Prints a line a check and at the
// end how many passed; exits with 1 if one failed. `.ci/browser` runs it.

import { execFileSync } from 'node:child_process';
import { createReadStream, mkdirSync, readFileSync, readdirSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { createInterface } from 'node:readline';
import { pathToFileURL } from 'node:url';
import { longScript, nastyScript } from './scripts.mjs';

const [program, playwright, folder] = process.argv.slice(2);
const { chromium } = await import(pathToFileURL(resolve(playwright, 'index.mjs')));
const SCRIPT = 'scan-tests/mc_move_absolute/second_move_while_running.scan.json';
const HTML_MAX = 12e6; // bytes of the report of 200,000 scans
const TASK_MAX = 3000; // ms: far above what is measured, for machines that do other things, too
mkdirSync(folder, { recursive: true });
const file = (name) => resolve(folder, name);

// Runs the program; a claim may fail. Under CI it would accept no golden, and the one that is accepted here is thrown away.
function standstill(...parts) {
  try {
    execFileSync(program, parts, { stdio: ['ignore', 'ignore', 'inherit'], env: { ...process.env, CI: '', INSTA_UPDATE: '' } });
  } catch (error) {
    if (error.status !== 1) throw error;
  }
}

let [passed, failed] = [0, 0];
function check(what, holds, found = '') {
  if (holds) passed += 1;
  else failed += 1;
  console.log(`${holds ? 'ok    ' : 'FAILED'}  ${what}${holds || found === '' ? '' : `: ${found}`}`);
}

const browser = await chromium.launch({ executablePath: process.env.CHROMIUM || '/usr/bin/chromium', args: ['--no-sandbox'] });

// Opens a report; whatever it complains of or asks for fails the check.
async function open(name, size = { width: 1440, height: 3000 }) {
  const page = await browser.newPage({ viewport: size, colorScheme: 'light' });
  const complaints = [];
  const url = pathToFileURL(file(name)).href;
  page.on('console', (message) => complaints.push(message.text()));
  page.on('pageerror', (error) => complaints.push(String(error)));
  page.on('dialog', (dialog) => complaints.push(`dialog ${dialog.message()}`) && dialog.dismiss());
  page.on('request', (request) => request.url() !== url && complaints.push(`request ${request.url()}`));
  await page.addInitScript(() => {
    window.longest = 0;
    new PerformanceObserver((list) => {
      for (const { duration } of list.getEntries()) window.longest = Math.max(window.longest, duration);
    }).observe({ entryTypes: ['longtask'] });
  });
  const since = Date.now();
  await page.goto(url);
  await page.waitForSelector('html[data-ready]');
  const opened = Date.now() - since;
  await settle(page);
  return { page, complaints, opened };
}

// Until everything asked for is drawn.
const settle = (page) => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => setTimeout(done, 50))));

// The rows of a CSV trace by the names of its columns.
function csv(name) {
  const [first, ...rows] = readFileSync(file(name), 'utf8').trimEnd().split('\n').map((line) => line.split(','));
  return rows.map((row) => Object.fromEntries(row.map((text, at) => [first[at], text])));
}

// One row of a CSV trace that is too long to read at once.
async function csvRow(name, scan) {
  let [names, at] = [null, -1];
  for await (const line of createInterface({ input: createReadStream(file(name)) })) {
    if (names === null) names = line.split(',');
    else if (++at === scan) return Object.fromEntries(line.split(',').map((text, index) => [names[index], text]));
  }
  return {};
}

// Every value in the gutters of what is on the screen, by signal.
const gutters = (page) => page.evaluate(() => Object.fromEntries([...document.querySelectorAll('.block')]
  .filter((element) => element.block && element.block.seen && element.querySelector('.reading'))
  .flatMap((element) => [...element.querySelectorAll('.reading')].map((reading, at) =>
    [element.block.names[Math.min(at, element.block.names.length - 1)], reading.textContent]))));

// Moves the pointer over the plots to where the scan is.
async function point(page, scan) {
  const place = await page.evaluate((wanted) => {
    const board = document.querySelector('#board');
    const { min, max } = shared.view;
    const box = board.getBoundingClientRect();
    return [box.left + board.plotLeft + ((wanted - min) / (max - min)) * shared.width, box.top + 300];
  }, scan);
  await page.mouse.move(...place);
  await settle(page);
  return place;
}

// A signal whose value differs from the row of the trace, if there is one.
function wrong(found, row) {
  return Object.entries(found).filter(([name, text]) => row[name] !== text)
    .map(([name, text]) => `${name} shows ${text}, the trace has ${row[name]}`)[0] || '';
}

async function cursorAndZoom() {
  standstill('run', '-q', SCRIPT, '--report', file('move.html'), '--trace', file('move.csv'));
  const rows = csv('move.csv');
  const { page, complaints } = await open('move.html');
  for (const scan of [0, 700, 1300, 2600, 4800]) {
    await point(page, scan);
    const shown = Number((await page.textContent('#scan')).replace('scan ', ''));
    const found = await gutters(page);
    check(`the cursor near scan ${scan} reads the trace`, Math.abs(shown - scan) <= 5 && Object.keys(found).length > 12
      && wrong(found, rows[shown]) === '', wrong(found, rows[shown]) || `scan ${shown}, ${Object.keys(found).length} values`);
  }
  await page.locator('.event', { hasText: 'CommandAborted' }).first().click();
  await settle(page);
  check('an event leads to its scan', (await page.textContent('#scan')) === 'scan 1273');
  await page.keyboard.press('ArrowLeft');
  await settle(page);
  check('a key moves the cursor by a scan', (await page.textContent('#scan')) === 'scan 1272'
    && wrong(await gutters(page), rows[1272]) === '', wrong(await gutters(page), rows[1272]));
  const [from, y] = await point(page, 1200);
  await page.mouse.down();
  const [to] = await point(page, 1400);
  await page.mouse.up();
  await settle(page);
  const view = await page.evaluate(() => shared.view);
  check('dragging zooms in', to > from && y > 0 && Math.abs(view.min - 1200) < 5 && Math.abs(view.max - 1400) < 5, JSON.stringify(view));
  await point(page, 1273);
  check('at a scale of scans the cursor is exact', (await page.textContent('#scan')) === 'scan 1273'
    && wrong(await gutters(page), rows[1273]) === '');
  await page.keyboard.down('Control');
  await page.mouse.wheel(0, -120);
  await page.keyboard.up('Control');
  check('Ctrl and wheel zoom', await page.evaluate((before) => shared.view.max - shared.view.min < before, view.max - view.min));
  await page.click('#fit');
  check('Fit shows the whole run', await page.evaluate(() => shared.view.max - shared.view.min === shared.scans));
  await showAndHide(page);
  await themes(page);
  await printing(page);
  check('no error, no request', complaints.length === 0, complaints.join('; '));
  await page.close();
}

async function showAndHide(page) {
  const shown = () => page.locator('.block:visible').count();
  const before = await shown();
  await page.locator('.hide').first().dispatchEvent('click');
  check('a row can be hidden', (await shown()) === before - 1);
  await page.click('#show');
  check('and shown again', (await shown()) === before);
  await page.fill('#filter', 'first.');
  check('the filter leaves what it names', (await page.locator('.group:visible').count()) < 4 && (await shown()) > 2);
  await page.fill('#filter', '');
  await page.locator('.fold').first().click();
  check('a group folds', (await shown()) < before);
  await page.locator('.fold').first().click();
}

async function themes(page) {
  const look = async () => (await page.locator('.curve').first().screenshot()).toString('base64');
  const back = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  await page.mouse.move(0, 0);
  const light = await look();
  await page.selectOption('#theme', 'dark');
  await settle(page);
  const dark = await look();
  check('the theme switches page and plots', dark !== light && (await back()) === 'rgb(18, 22, 29)', await back());
  await page.selectOption('#theme', 'auto');
  await settle(page);
  check('and back', (await look()) === light);
}

async function printing(page) {
  const pdf = await page.pdf({ preferCSSPageSize: true });
  writeFileSync(file('move.pdf'), pdf);
  check('it prints', pdf.length > 20_000, `${pdf.length} bytes`);
  await settle(page);
  check('and is as before', !(await page.evaluate(() => document.documentElement.classList.contains('printing'))));
}

async function overlaid() {
  writeFileSync(file('nasty.scan.json'), nastyScript());
  standstill('run', '-q', file('nasty.scan.json'), '--trace', file('one.csv'));
  standstill('run', '-q', file('nasty.scan.json'), '--set', 'v=3', '--trace', file('other.csv'));
  standstill('report', file('one.csv'), file('other.csv'), '-o', file('both.html'));
  const { page, complaints } = await open('both.html');
  await point(page, 60);
  const scan = Number((await page.textContent('#scan')).replace('scan ', ''));
  const position = page.locator('.curve', { hasText: 'Position' }).locator('.reading');
  const found = await position.allTextContents();
  const expected = ['one.csv', 'other.csv'].map((name) => csv(name)[scan]['X.Position']);
  check('the cursor reads both traces', found[0] === expected[0] && found[1] === expected[1], `${found} for ${expected}`);
  check('no error, no request over several traces', complaints.length === 0, complaints.join('; '));
  await page.close();
}

// A slave shows its master and how far it is off the law; the axis it follows shows neither.
async function coupled() {
  standstill('run', '-q', 'scan-tests/coupling/a_slave_that_cannot_follow_lags.scan.json',
    '--report', file('coupled.html'), '--trace', file('coupled.csv'));
  const { page, complaints } = await open('coupled.html');
  await point(page, 900);
  const scan = Number((await page.textContent('#scan')).replace('scan ', ''));
  const [found, row] = [await gutters(page), csv('coupled.csv')[scan]];
  const differs = wrong(found, row);
  check('the cursor reads master and deviation of a slave', differs === '' && found['S.Master'] === 'M' && Number(found['S.Deviation']) < -50,
    differs || `${found['S.Master']}, ${found['S.Deviation']}`);
  check('the deviation has a panel of curves', await page.locator('.curve[aria-label="S.Deviation"]').count() === 1);
  check('the master has none', !('M.Deviation' in found) && !('M.Master' in found));
  check('no error, no request over a coupling', complaints.length === 0, complaints.join('; '));
  await page.close();
}

// A slave of a cam shows where it is on the curve of its table; axes on none have no such panel.
async function onCam() {
  standstill('run', '-q', 'scan-tests/cams/too_fast_for_the_cam.scan.json', '--report', file('cam.html'), '--trace', file('cam.csv'));
  const { page, complaints } = await open('cam.html');
  check('the slave of a cam has its panel, and nobody else', (await page.locator('.cam').count()) === 1
    && (await page.locator('.curve[aria-label="S.Cam"] .cam').count()) === 1);
  // The rows of the panel against those of the trace: in sync the slave is on the curve, else it is off by its deviation.
  const found = await page.evaluate(() => {
    const [trace] = shared.traces, [cam] = trace.header.cams;
    const { first, parts, slaves } = camRows(cam, trace);
    return [...parts].map((part, row) => ({ scan: first + row, off: slaves[row] - cam.from - camAt(cam, part) }));
  });
  const rows = csv('cam.csv');
  const worst = Math.max(...found.map(({ scan, off }) => Math.abs(off - Number(rows[scan]['S.Deviation']))));
  check('it is as far off the curve as it deviates', found.length > 1000 && worst < 0.05, `${worst} in ${found.length} rows`);
  const SCAN = found[700].scan;
  await page.evaluate((scan) => shared.goTo(scan), SCAN);
  await settle(page);
  const dot = await page.locator('.dot').boundingBox();
  check('a dot marks the scan of the cursor', dot !== null && (await page.textContent('.place')).includes('→'));
  await page.keyboard.press('Home');
  await page.mouse.move(dot.x + dot.width / 2, dot.y + dot.height / 2);
  await settle(page);
  const near = Number((await page.textContent('#scan')).replace('scan ', ''));
  const again = await page.locator('.dot').boundingBox();
  check('the pointer over the curve leads to a scan there', near > 0 && Math.hypot(again.x - dot.x, again.y - dot.y) < 3, `scan ${near}`);
  check('no error, no request over a cam', complaints.length === 0, complaints.join('; '));
  await page.close();
}

// The page of a failing test: golden and run over each other, the first difference marked.
async function marked() {
  const script = JSON.parse(nastyScript());
  script.expect = [{ never: { 'move.Error': true } }];
  const tests = file('failing');
  rmSync(tests, { recursive: true, force: true });
  mkdirSync(tests);
  const write = () => writeFileSync(resolve(tests, 'a.scan.json'), JSON.stringify(script));
  write();
  standstill('test', '--accept', tests);
  const SCAN = 37;
  script.steps.push({ at: SCAN, set: { GO: false } });
  write();
  standstill('test', tests, '--report', resolve(tests, 'pages'));
  const html = readdirSync(resolve(tests, 'pages'), { recursive: true }).find((path) => path.endsWith('.html'));
  const { page, complaints } = await open(`failing/pages/${html}`);
  check('the cursor begins at the first difference', (await page.textContent('#scan')) === `scan ${SCAN}`, await page.textContent('#scan'));
  const lines = page.locator('.mark-line');
  const where = async () => {
    const box = await lines.first().boundingBox();
    return page.evaluate(([x]) => {
      const board = document.querySelector('#board').getBoundingClientRect();
      return shared.view.min + ((x - board.left - document.querySelector('#board').plotLeft) / shared.width) * (shared.view.max - shared.view.min);
    }, [box.x]);
  };
  const place = await where();
  check('a line marks it', (await lines.count()) === 1 && (await lines.first().getAttribute('title')) === `scan ${SCAN}`
    && Math.abs(place - SCAN) < 1.5, `${await lines.count()} lines, at scan ${place}`);
  check('what differs is told', (await page.textContent('header')).includes(`first difference in scan ${SCAN}`));
  await point(page, 5);
  check('the cursor can go elsewhere', (await page.textContent('#scan')) !== `scan ${SCAN}`);
  await page.locator(`button[data-scan="${SCAN}"]`).first().click();
  await settle(page);
  check('and the mark leads back', (await page.textContent('#scan')) === `scan ${SCAN}`, await page.textContent('#scan'));
  await page.keyboard.press('+');
  await settle(page);
  check('the line moves with the zoom', Math.abs((await where()) - SCAN) < 1.5, String(await where()));
  check('no error, no request with a mark', complaints.length === 0, complaints.join('; '));
  await page.close();
}

// The page of a claim that fails without a golden: it opens where the cause is, not where the claim is.
async function explained() {
  const tests = file('explained');
  rmSync(tests, { recursive: true, force: true });
  mkdirSync(tests);
  const [EDGE, CLAIM] = [7, 50];
  writeFileSync(resolve(tests, 'a.scan.json'), JSON.stringify({
    standstill: 1, title: 'No power', cycle: 'T#1ms', scans: 60,
    axes: { X: { limits: { velocity: 10, acceleration: 100 } } },
    inputs: { GO: false },
    blocks: [{ name: 'move', type: 'MC_MoveAbsolute', pins: { Axis: 'X', Execute: { from: 'GO' }, Position: 1, Velocity: 5 } }],
    steps: [{ at: EDGE, set: { GO: true } }],
    expect: [{ at: CLAIM, that: { 'move.Done': true } }],
  }));
  standstill('test', '--golden', 'none', tests, '--report', resolve(tests, 'pages'));
  const html = readdirSync(resolve(tests, 'pages'), { recursive: true }).find((path) => path.endsWith('.html'));
  const { page, complaints } = await open(`explained/pages/${html}`);
  const scan = await page.textContent('#scan');
  check('the page opens at the scan of the cause', scan === `scan ${EDGE}`, scan);
  const header = await page.textContent('header');
  check('and says the cause and its remedy', header.includes(`why: scan ${EDGE}`) && header.includes('MC_Power'), header);
  check('no error, no request with a cause', complaints.length === 0, complaints.join('; '));
  await page.close();
}

async function texts() {
  standstill('run', '-q', file('nasty.scan.json'), '--report', file('nasty.html'));
  const { page, complaints } = await open('nasty.html');
  const title = JSON.parse(nastyScript()).title;
  check('a title that looks like markup is a text', (await page.title()) === title && (await page.textContent('h1')) === title);
  check('nothing of it became an element', (await page.locator('img, iframe, b[data-nasty]').count()) === 0);
  check('a unit is a text, too', (await page.textContent('.group')).includes('<b data-nasty>'));
  check('no error, no request with such texts', complaints.length === 0, complaints.join('; '));
  await page.close();
}

// Numbers at the edges of how they are written.
async function hardNumbers() {
  const reals = ['NaN', 'Infinity', '-Infinity', '0.0', '5e-324', '-2.2250738585072014e-308', '1.7976931348623157e308', '0.30000000000000004',
    '1e21', '1e16', '1000000000000000.0', '-123456.789', '0.0001', '9.999e-5', '1e-5', '-1.5e-9', '1.0', '100.0', '0.3333333333333333'];
  const integers = ['-9223372036854775808', '9223372036854775807', '0', '-1', '4294967296', '255'];
  const rows = reals.map((real, scan) => `${scan},${scan * 1e6},${real},${integers[scan % integers.length]},${scan === 3 ? 'TRUE' : 'FALSE'}`);
  writeFileSync(file('hard.csv'), `scan,time_ns,r,i,b\n${rows.join('\n')}\n`);
  standstill('report', file('hard.csv'), '-o', file('hard.html'));
  const { page, complaints } = await open('hard.html');
  await page.keyboard.press('Home');
  let differs = '';
  for (const row of csv('hard.csv')) {
    await settle(page);
    differs = differs || wrong(await gutters(page), row);
    await page.keyboard.press('ArrowRight');
  }
  check('every number is written as traces write it', differs === '', differs);
  check('what the file lacks is said', (await page.textContent('.lacks')).includes('hard.csv lacks the header'));
  check('no error, no request with such numbers', complaints.length === 0, complaints.join('; '));
  await page.close();
}

async function longRun() {
  writeFileSync(file('long.scan.json'), longScript(200_000));
  standstill('run', '-q', file('long.scan.json'), '--report', file('long.html'), '--trace', file('long.csv'));
  const { size } = statSync(file('long.html'));
  check('200,000 scans fit', size < HTML_MAX, `${size} bytes`);
  const { page, complaints, opened } = await open('long.html', { width: 1440, height: 1000 });
  const pulse = () => page.evaluate(() => {
    const element = [...document.querySelectorAll('.block')].find((one) => one.block && one.block.names[0] === 'PULSE');
    element.block.draw();
    const canvas = element.querySelector('canvas');
    const { data } = canvas.getContext('2d').getImageData(0, Math.floor(canvas.height / 2), canvas.width, 1);
    const place = ((100_000 - shared.view.min) / (shared.view.max - shared.view.min)) * canvas.width;
    let ink = 0;
    for (let x = Math.floor(place) - 2; x <= place + 3; x++) ink = Math.max(ink, data[4 * x + 3]);
    return ink;
  });
  const ink = await pulse();
  check('a pulse of one scan among 200,000 is drawn', ink > 100, String(ink));
  const opening = await page.evaluate(() => window.longest);
  await page.evaluate(() => { window.longest = 0; });
  await point(page, 100_000);
  for (let step = 0; step < 30; step++) {
    await page.keyboard.down('Control');
    await page.mouse.wheel(0, -120);
    await page.keyboard.up('Control');
    await settle(page);
  }
  check('it zooms to single scans', await page.evaluate(() => shared.view.max - shared.view.min < 400));
  await point(page, await page.evaluate(() => Math.round((shared.view.min + shared.view.max) / 2)));
  const scan = Number((await page.textContent('#scan')).replace('scan ', ''));
  const differs = wrong(await gutters(page), await csvRow('long.csv', scan));
  check('the cursor reads the trace there', differs === '', differs);
  await page.keyboard.press('0');
  await settle(page);
  const zooming = await page.evaluate(() => window.longest);
  check('no task blocks the page for long', Math.max(opening, zooming) < TASK_MAX, `${opening} and ${zooming} ms`);
  check('no error, no request over 200,000 scans', complaints.length === 0, complaints.join('; '));
  console.log(`200,000 scans: ${size} bytes, open after ${opened} ms, longest task ${Math.round(opening)} ms while opening, `
    + `${Math.round(zooming)} ms while zooming`);
  await page.close();
}

for (const part of [cursorAndZoom, overlaid, coupled, onCam, marked, explained, texts, hardNumbers, longRun]) await part();
await browser.close();
console.log(`${passed} passed, ${failed} failed`);
process.exit(failed === 0 ? 0 : 1);
