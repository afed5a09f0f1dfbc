// Pictures of a report to look at: light and dark, wide and narrow, and printed.
//
//     node pictures.mjs PLAYWRIGHT REPORT.html FOLDER

import { mkdirSync } from 'node:fs';
import { basename, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';

const [playwright, report, folder] = process.argv.slice(2);
const { chromium } = await import(pathToFileURL(resolve(playwright, 'index.mjs')));
mkdirSync(folder, { recursive: true });
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM || '/usr/bin/chromium', args: ['--no-sandbox'] });
const name = basename(report, '.html');
for (const colorScheme of ['light', 'dark']) {
  for (const [size, width, height] of [['wide', 1440, 1000], ['narrow', 480, 900]]) {
    const page = await browser.newPage({ viewport: { width, height }, colorScheme });
    await page.goto(pathToFileURL(resolve(report)).href);
    await page.waitForSelector('html[data-ready]');
    const height_ = await page.evaluate(() => document.documentElement.scrollHeight);
    // As high as the page, so that everything is in sight, and drawn.
    await page.setViewportSize({ width, height: Math.max(height, Math.min(height_, 6000)) });
    await page.evaluate(() => setCursor(shared.scans * 0.3));
    await page.waitForTimeout(400);
    await page.screenshot({ path: resolve(folder, `${name}-${size}-${colorScheme}.png`) });
    if (size === 'wide' && colorScheme === 'light') {
      await page.pdf({ path: resolve(folder, `${name}.pdf`), preferCSSPageSize: true });
    }
    await page.close();
  }
}
await browser.close();
