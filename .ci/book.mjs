// Pictures of pages of the book: light and dark, wide and narrow.
//
//     node book.mjs PLAYWRIGHT BOOK FOLDER

import { mkdirSync } from 'node:fs';
import { resolve } from 'node:path';
import { pathToFileURL } from 'node:url';

const [playwright, book, folder] = process.argv.slice(2);
const { chromium } = await import(pathToFileURL(resolve(playwright, 'index.mjs')));
mkdirSync(folder, { recursive: true });
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM || '/usr/bin/chromium', args: ['--no-sandbox'] });
const pages = ['index', 'tutorial', 'gallery/press', 'gallery/hoist', 'how-to/ci', 'blocks/mc_moveabsolute', 'traces', 'comparison', 'vibration'];
for (const name of pages) {
  for (const colorScheme of ['light', 'dark']) {
    for (const [size, width, height] of [['wide', 1280, 1400], ['narrow', 420, 1000]]) {
      const page = await browser.newPage({ viewport: { width, height }, colorScheme });
      await page.goto(pathToFileURL(resolve(book, `${name}.html`)).href);
      await page.waitForTimeout(300);
      await page.screenshot({ path: resolve(folder, `${name.replace('/', '-')}-${size}-${colorScheme}.png`) });
      await page.close();
    }
  }
}
await browser.close();
