// Runs a WASI binary with the repository as its file system: node .ci/wasi.mjs FILE.wasm ARGS..
import { readFile } from 'node:fs/promises';
import { setFlagsFromString } from 'node:v8';
import { WASI } from 'node:wasi';
import { argv, cwd, exit } from 'node:process';

// Node 20 ends with a segmentation fault where V8 ends an incremental marking while WebAssembly runs (seen in 9 of 12 runs of
// `test --strict scan-tests/cams`, in none without it). The program needs a heap of a few megabytes here, so nothing is lost.
setFlagsFromString('--no-incremental-marking');

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
