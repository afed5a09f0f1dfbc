// A folder on a port of the loopback address, below a path of its own: as any web server at any place would show it.

import { createServer } from 'node:http';
import { readFile } from 'node:fs/promises';
import { extname, join, normalize } from 'node:path';

// A server that knows no WebAssembly is one, too.
const TYPES = {
  '.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.json': 'application/json', '.svg': 'image/svg+xml',
};

// `{address, close}` of a server for `folder`; `asked` is called with the path of every file that is given out.
export async function serve(folder, asked = () => {}) {
  const prefix = '/some/where/';
  const server = createServer(async (request, response) => {
    const path = decodeURIComponent(new URL(request.url, 'http://localhost').pathname);
    if (!path.startsWith(prefix)) {
      response.writeHead(404).end();
      return;
    }
    const within = normalize(path.slice(prefix.length)).replace(/^(\.\.[\\/])+/, '');
    const file = join(folder, within.endsWith('/') || within === '.' ? join(within, 'index.html') : within);
    try {
      const bytes = await readFile(file);
      asked(file);
      response.writeHead(200, { 'Content-Type': TYPES[extname(file)] || 'application/octet-stream' }).end(bytes);
    } catch {
      response.writeHead(404).end();
    }
  });
  await new Promise((done) => server.listen(0, '127.0.0.1', done));
  return { address: `http://127.0.0.1:${server.address().port}${prefix}`, close: () => server.close() };
}
