// The rows of a trace, from the exact companion that the runtime writes: every bit of it, deflated.
// The form is told in crates/trace/src/exact/mod.rs; what is written there is read here, in the same order of arithmetic.

const MAGIC = 'standstill exact 2\n';
const KINDS = ['bool', 'real', 'integer', 'name'];
const ROLES = ['state', 'value', 'variable', 'in_out', 'input', 'output'];
const EXTRAPOLATIONS = [
  [], [1], [2, -1], [3, -3, 1], [4, -6, 4, -1], [5, -10, 10, -5, 1], [6, -15, 20, -15, 6, -1],
];

// Bytes as the writer put them: LEB128, zigzag, length before text. Two words of 32 bits stand for one of 64.
class Reader {
  constructor(bytes) {
    this.bytes = bytes;
    this.at = 0;
    this.low = 0;
    this.high = 0;
  }

  // Leaves a number of up to 64 bits in `low` and `high`.
  wide() {
    let low = 0, high = 0;
    for (let shift = 0; shift < 64; shift += 7) {
      const byte = this.bytes[this.at++];
      const bits = byte & 0x7f;
      if (shift < 32) low |= bits << shift;
      if (shift > 25) high |= shift < 32 ? bits >>> (32 - shift) : bits << (shift - 32);
      if (byte < 0x80) break;
    }
    this.low = low >>> 0;
    this.high = high >>> 0;
  }

  number() {
    this.wide();
    return this.high * 4294967296 + this.low;
  }

  signed() {
    this.wide();
    const sign = -(this.low & 1);
    this.low = (((this.low >>> 1) | (this.high << 31)) ^ sign) >>> 0;
    this.high = ((this.high >>> 1) ^ sign) >>> 0;
  }

  text() {
    const length = this.number();
    const bytes = this.bytes.subarray(this.at, this.at + length);
    this.at += length;
    return new TextDecoder().decode(bytes);
  }
}

const FLOAT = new Float64Array(1);
const WORDS = new Uint32Array(FLOAT.buffer);

// The number that lies the signed distance in `reader` away from `prediction`, counted in representable numbers.
function atDistance(prediction, reader) {
  FLOAT[0] = prediction === 0 ? 0 : prediction;
  let low = WORDS[0], high = WORDS[1];
  if (high >= 0x80000000) {
    high = (0x80000000 - high - (low === 0 ? 0 : 1)) >>> 0;
    low = -low >>> 0;
  }
  const sum = low + reader.low;
  low = sum >>> 0;
  high = (high + reader.high + (sum > 0xffffffff ? 1 : 0)) >>> 0;
  if (high >= 0x80000000) {
    high = (0x80000000 - high - (low === 0 ? 0 : 1)) >>> 0;
    low = -low >>> 0;
  }
  WORDS[0] = low;
  WORDS[1] = high;
  return FLOAT[0];
}

function readReals(reader, rows, earlier) {
  const code = reader.number();
  const lag = code - EXTRAPOLATIONS.length;
  const from = lag >= 0 ? earlier[reader.number()] : null;
  const values = new Float64Array(rows);
  for (let scan = 0; scan < rows; scan++) {
    let prediction = 0;
    if (from) {
      prediction = scan >= lag ? from[scan - lag] : 0;
    } else {
      const coefficients = EXTRAPOLATIONS[Math.min(code, scan)];
      for (let back = 0; back < coefficients.length; back++) prediction += values[scan - 1 - back] * coefficients[back];
    }
    if (!Number.isFinite(prediction)) prediction = scan > 0 ? values[scan - 1] : 0;
    reader.signed();
    values[scan] = atDistance(prediction, reader);
  }
  return values;
}

// Words that are no reals change seldom, so what is kept is where they change, and to what.
function readWords(reader, rows, kind) {
  const scans = [], values = [];
  let last = 0n, step = 0n;
  for (let scan = 0; scan < rows; scan++) {
    reader.signed();
    const moves = reader.low !== 0 || reader.high !== 0;
    if (moves) step = BigInt.asIntN(64, step + ((BigInt(reader.high) << 32n) | BigInt(reader.low)));
    if (step !== 0n) last = BigInt.asIntN(64, last + step);
    if (scan === 0 || step !== 0n) {
      scans.push(scan);
      values.push(kind === 'integer' ? last : Number(last));
    }
  }
  return { scans, values };
}

// Where a column of reals changes, if it does so seldom enough for boxes with numbers in them.
function realEdges(reals) {
  const scans = [], values = [], most = 2 + reals.length / 8;
  for (let scan = 0; scan < reals.length; scan++) {
    if (scan === 0 || !Object.is(reals[scan], reals[scan - 1])) {
      if (scans.length > most) return null;
      scans.push(scan);
      values.push(reals[scan]);
    }
  }
  return { scans, values };
}

async function inflated(base64) {
  const packed = Uint8Array.from(atob(base64), (character) => character.charCodeAt(0));
  const start = MAGIC.length + 8;
  const stream = new Blob([packed.subarray(start)]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

const pause = () => new Promise((resolve) => setTimeout(resolve));

// The columns of a trace: `{name, subject, signal, kind, role, isTime, reals?, edges?}`, and how many rows there are.
async function decode(base64) {
  const reader = new Reader(await inflated(base64));
  reader.number(); // the cycle, which the header tells, too
  const rows = reader.number();
  const columns = [];
  for (let count = reader.number(); count > 0; count--) {
    const name = reader.text();
    const dot = name.indexOf('.');
    const [kind, role, isTime] = [reader.bytes[reader.at++], reader.bytes[reader.at++], reader.bytes[reader.at++] !== 0];
    columns.push({
      name, subject: dot < 0 ? '' : name.slice(0, dot), signal: name.slice(dot + 1),
      kind: KINDS[kind], role: ROLES[role], isTime,
    });
  }
  const names = [];
  for (let count = reader.number(); count > 0; count--) names.push(reader.text());
  const reals = [];
  let since = performance.now();
  for (const column of columns) {
    if (column.kind === 'real') {
      column.reals = readReals(reader, rows, reals);
      reals.push(column.reals);
      column.edges = realEdges(column.reals);
    } else {
      column.edges = readWords(reader, rows, column.kind);
      if (column.kind === 'name') column.names = names;
    }
    if (performance.now() - since > 30) {
      await pause();
      since = performance.now();
    }
  }
  return { rows, columns };
}

// The index of the last entry of `scans`, which rises, that is at most `scan`; -1 if there is none.
function lastAtMost(scans, scan) {
  let low = 0, high = scans.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (scans[middle] <= scan) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

// A number as traces write it: the shortest text that reads back as the same number.
function realText(value) {
  if (Number.isNaN(value)) return 'NaN';
  if (!Number.isFinite(value)) return value > 0 ? 'Infinity' : '-Infinity';
  if (value === 0) return '0.0';
  const [mantissa, exponent] = Math.abs(value).toExponential().split('e');
  const power = Number(exponent), sign = value < 0 ? '-' : '';
  if (power < -4 || power >= 16) return `${sign}${mantissa}e${power}`;
  const digits = mantissa.replace('.', '');
  if (power < 0) return `${sign}0.${'0'.repeat(-power - 1)}${digits}`;
  const whole = digits.slice(0, power + 1).padEnd(power + 1, '0');
  return `${sign}${whole}.${digits.slice(power + 1) || '0'}`;
}

function entryText(column, value) {
  switch (column.kind) {
    case 'bool': return value ? 'TRUE' : 'FALSE';
    case 'real': return realText(value);
    case 'integer': return String(value);
    default: return column.names[value];
  }
}

// The text of a column in a scan, as the trace has it; empty outside of it.
function textAt(column, scan, rows) {
  if (scan < 0 || scan >= rows) return '';
  if (column.reals) return realText(column.reals[scan]);
  return entryText(column, column.edges.values[lastAtMost(column.edges.scans, scan)]);
}
