// Builds the page: node build.mjs NODE_MODULES GLUE OUT, where GLUE/NAME holds what stands around the WebAssembly NAME. The scripts
// of the repository are copied by it, too.

import { copyFileSync, mkdirSync, readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

const [modules, glue, out] = process.argv.slice(2).map((path) => resolve(path));
const here = dirname(fileURLToPath(import.meta.url));
const root = resolve(here, '../../..');
const report = join(root, 'crates/report');
const { build } = await import(pathToFileURL(join(modules, 'esbuild/lib/main.js')));
const text = (path) => readFileSync(path, 'utf8');

// The diagram of reports is scripts that share one scope; here they are one module.
const board = {
  name: 'board',
  setup({ onLoad }) {
    onLoad({ filter: /[\\/]src[\\/]board\.js$/ }, ({ path }) => {
      const parts = ['decode.js', 'rows.js', 'curves.js', 'cams.js', 'board.js', 'page.js'].map((name) => text(join(report, 'page', name)));
      return { contents: [text(join(report, 'vendor/uPlot.iife.min.js')), ...parts, text(path)].join('\n'), loader: 'js' };
    });
  },
};

const border = (name) => ({
  name: 'border',
  setup: ({ onResolve }) => onResolve({ filter: /^playground:glue$/ }, () => ({ path: join(glue, name, 'standstill_playground.js') })),
});

mkdirSync(out, { recursive: true });
const common = {
  bundle: true, minify: true, format: 'esm', target: 'es2022', legalComments: 'none', logLevel: 'warning', plugins: [board], nodePaths: [modules],
};
await build({ ...common, entryPoints: [join(here, 'src/main.js')], outfile: join(out, 'playground.js') });
for (const name of ['playground', 'guests']) {
  await build({ ...common, plugins: [border(name)], entryPoints: [join(here, 'src/worker.js')], outfile: join(out, `${name}.worker.js`) });
  copyFileSync(join(glue, name, 'standstill_playground_bg.wasm'), join(out, `${name}.wasm`));
}
const style = [join(report, 'vendor/uPlot.min.css'), join(report, 'page/page.css'), join(here, 'playground.css')].map(text).join('\n');
await build({ stdin: { contents: style, loader: 'css' }, minify: true, outfile: join(out, 'playground.css') });
copyFileSync(join(here, 'index.html'), join(out, 'index.html'));
copyFileSync(join(root, 'docs/scan-script.schema.json'), join(out, 'schema.json'));

// Licences of all that is in the bundle.
const licences = [`uPlot\n\n${text(join(report, 'vendor/uPlot-LICENSE'))}`];
for (const scope of ['@codemirror', '@lezer', '@marijn', '.']) {
  for (const name of readdirSync(join(modules, scope)).sort()) {
    if (scope === '.' && !['crelt', 'style-mod', 'w3c-keyname'].includes(name)) continue;
    const folder = join(modules, scope, name);
    const file = readdirSync(folder).find((file) => /^licen[cs]e/i.test(file));
    if (file) licences.push(`${scope === '.' ? name : `${scope}/${name}`}\n\n${text(join(folder, file))}`);
  }
}
writeFileSync(join(out, 'licences.txt'), licences.join('\n\n'));

// The files that a script names, and those that these name, relative to the script.
function named(folder, name, found) {
  const json = JSON.parse(text(join(root, folder, name)));
  const list = (value) => (value === undefined ? [] : [value].flat());
  const programs = Object.values(json.programs || {}).flatMap((program) => [...list(program.wasm), ...list(program.st)]);
  const tables = Object.values(json.tables || {}).flatMap((table) => list(table.csv));
  for (const path of [...programs, ...tables]) found.add(path);
  for (const path of list(json.include)) {
    const inner = join(dirname(name), path);
    if (found.has(inner)) continue;
    found.add(inner);
    named(folder, inner, found);
  }
  return { title: json.title, files: [...found] };
}

const groups = [];
for (const [group, label] of [['tutorial', 'Tutorial'], ['gallery', 'Gallery']]) {
  const folder = `scan-tests/${group}`;
  const scripts = readdirSync(join(root, folder)).filter((name) => name.endsWith('.scan.json')).sort().map((file) => {
    const { title, files } = named(folder, file, new Set());
    for (const path of [file, ...files]) {
      const copy = join(out, 'scripts', group, path);
      mkdirSync(dirname(copy), { recursive: true });
      copyFileSync(join(root, folder, path), copy);
    }
    return { name: file.replace('.scan.json', ''), title, files };
  });
  groups.push({ group, label, scripts });
}
writeFileSync(join(out, 'scripts.json'), JSON.stringify(groups));
