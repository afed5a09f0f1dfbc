// Runs a WASI binary with the repository as its file system: node .ci/wasi.mjs FILE.wasm ARGS..
import { readFile } from 'node:fs/promises';
import { setFlagsFromString } from 'node:v8';
import { WASI } from 'node:wasi';
import { argv, cwd, exit } from 'node:process';

// Node 20 crashes with a segmentation fault if V8 ends an incremental marking while WebAssembly runs: in 9 of 12 runs of
// `test --strict scan-tests/cams`, in none without incremental marking. The program needs a heap of a few megabytes, so that is
// no loss.
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
