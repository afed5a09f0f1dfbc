// How fast the playground is, in figures: node measure.mjs PLAYWRIGHT SITE NATIVE [SCRIPT], where NATIVE is the program
// `cargo build --profile bench -p standstill-playground --example native` builds.

import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { basename, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { serve } from './serve.mjs';

const [playwright, site, native, script = 'scan-tests/tutorial/slide.scan.json'] = process.argv.slice(2);
const { chromium } = await import(pathToFileURL(resolve(playwright, 'index.mjs')));
const server = await serve(site);
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM || '/usr/bin/chromium', args: ['--no-sandbox', '--disable-gpu', '--disable-background-networking'] });
const page = await browser.newPage({ viewport: { width: 1280, height: 900 } });
await page.goto(`${server.address}playground/?gallery=slide`);
await page.waitForSelector('html[data-ready][data-runs]');
const median = (list) => list.slice().sort((one, other) => one - other)[Math.floor(list.length / 2)];
const ms = (value) => `${value.toFixed(2)} ms`;

// A run of 2,000 scans, of which a number is dragged: a move of the hand in every frame, for three seconds.
const long = readFileSync('scan-tests/tutorial/slide.scan.json', 'utf8').replace('"scans": 350', '"scans": 2000');
await page.evaluate((text) => window.playground.openProject({ name: 'long.scan.json', text }), long);
await page.waitForFunction(() => document.querySelector('#verdict').textContent.includes('2000 scans'));
const number = page.locator('#editor .number', { hasText: '40' }).first();
const box = await number.boundingBox();
await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
await page.mouse.down();
const dragged = await page.evaluate(([x, y]) => new Promise((done) => {
  const counted = () => Number(document.documentElement.dataset.runs);
  const [before, since, frames] = [counted(), performance.now(), []];
  let last = since;
  const step = () => {
    const now = performance.now();
    frames.push(now - last);
    last = now;
    if (now - since > 3000) {
      window.dispatchEvent(new PointerEvent('pointerup', { clientX: x, clientY: y }));
      done({ runs: counted() - before, took: now - since, frames, times: window.playground.times });
      return;
    }
    window.dispatchEvent(new PointerEvent('pointermove', { clientX: x + 4 * (frames.length % 30), clientY: y }));
    requestAnimationFrame(step);
  };
  requestAnimationFrame(step);
}), [box.x + box.width / 2, box.y + box.height / 2]);
await page.mouse.up();
console.log(`dragging: ${((dragged.runs * 1000) / dragged.took).toFixed(1)} redrawn runs of 2,000 scans a second, ${((dragged.frames.length * 1000) / dragged.took).toFixed(1)} frames`);

// The run itself, here and natively: the same function on the same request, reading included.
const request = { name: basename(script), text: readFileSync(script, 'utf8').replace(/"scans": \d+/, '"scans": 20000'), files: {} };
const here = await page.evaluate(async (request) => {
  const times = [];
  for (let turn = 0; turn < 15; turn++) times.push((await window.playground.ask('run', [request])).ran);
  return times;
}, request);
const there = execFileSync(native, ['15'], { input: JSON.stringify(request), encoding: 'utf8' }).trim().split('\n').map(Number);
// The least of each is what other work on the machine disturbed least.
for (const [what, of] of [['median', median], ['least', (list) => Math.min(...list)]]) {
  console.log(`a run of ${request.name} with 20,000 scans, ${what}: ${ms(of(here))} here, ${ms(of(there))} natively, ${(of(here) / of(there)).toFixed(2)} times`);
}
await browser.close();
server.close();
