// Pictures of the playground to look at: node pictures.mjs PLAYWRIGHT SITE FOLDER.

import { mkdirSync } from 'node:fs';
import { resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { serve } from './serve.mjs';

const [playwright, site, folder] = process.argv.slice(2);
const { chromium } = await import(pathToFileURL(resolve(playwright, 'index.mjs')));
mkdirSync(folder, { recursive: true });
const server = await serve(site);
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM || '/usr/bin/chromium', args: ['--no-sandbox', '--disable-background-networking'] });
for (const [colorScheme, size, width, height] of [['light', 'wide', 1440, 1000], ['dark', 'wide', 1440, 1000], ['light', 'narrow', 400, 1600]]) {
  for (const tab of ['run', 'plan', 'hand']) {
    const page = await browser.newPage({ viewport: { width, height }, colorScheme });
    page.on('console', (message) => message.type() === 'error' && console.error(`${size} ${tab}: ${message.text()}`));
    await page.goto(`${server.address}playground/?gallery=pick_and_place`);
    await page.waitForSelector('html[data-ready][data-runs]');
    await page.click(`#tab-${tab}`);
    if (tab === 'hand') {
      for (let step = 0; step < 12; step++) {
        await page.mouse.move(width * (step < 6 ? 0.2 : 0.6), 200);
        await page.waitForTimeout(60);
      }
    }
    await page.waitForTimeout(500);
    await page.screenshot({ path: resolve(folder, `${tab}-${size}-${colorScheme}.png`) });
    await page.close();
  }
}
await browser.close();
server.close();
