// Runs a WASI binary with the repository as its file system: node .ci/wasi.mjs FILE.wasm ARGS..
import { readFile } from 'node:fs/promises';
import { WASI } from 'node:wasi';
import { argv, cwd, exit } from 'node:process';

const [, , file, ...args] = argv;
const wasi = new WASI({
  version: 'preview1',
  args: ['standstill', ...args],
  env: { CI: 'true' },
  preopens: { '.': cwd() },
  returnOnExit: true,
});
const module = await WebAssembly.compile(await readFile(file));
const instance = await WebAssembly.instantiate(module, wasi.getImportObject());
exit(wasi.start(instance));
