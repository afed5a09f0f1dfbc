// What may stand where in a script: from the schema, and from the names of the last run.

import { ensureSyntaxTree, syntaxTree } from '@codemirror/language';

let schema = null;
let signals = []; // names of columns of the last run
let axes = [];

export function useSchema(read) {
  schema = read;
}

export function useNames(names, axisNames) {
  signals = names;
  axes = axisNames;
}

const STATES = ['Disabled', 'Standstill', 'Homing', 'Stopping', 'DiscreteMotion', 'ContinuousMotion', 'SynchronizedMotion', 'ErrorStop'];
const SIGNAL_KEYS = new Set(['from', 'not', 'any', 'all', 'same_as', 'of', 'exclusive']);
const AXIS_KEYS = new Set(['Axis', 'Master', 'Slave', 'axis', 'within_limits', 'slave', 'master']);

// The tree of the whole text; of what is read so far where that takes long.
export const treeOf = (state) => ensureSyntaxTree(state, state.doc.length, 200) || syntaxTree(state);

const children = (node, name) => {
  const found = [];
  for (let child = node.firstChild; child; child = child.nextSibling) if (!name || child.name === name) found.push(child);
  return found;
};

function string(state, node) {
  const text = state.sliceDoc(node.from, node.to);
  try {
    return JSON.parse(text);
  } catch {
    return text.replace(/^"|"$/g, '');
  }
}

const keyOf = (state, property) => {
  const name = property.getChild('PropertyName');
  return name ? string(state, name) : '';
};

// The value of a key of an object, if it is a string.
function told(state, object, key) {
  const property = object && children(object, 'Property').find((property) => keyOf(state, property) === key);
  const value = property && property.getChild('String');
  return value ? string(state, value) : null;
}

// A schema as the list of those that may hold for this value.
function expand(one, state, node, depth = 0) {
  if (!one || depth > 12) return [];
  const inner = (next) => expand(next, state, node, depth + 1);
  const found = [one];
  if (one.$ref) found.push(...inner(schema.$defs[one.$ref.slice('#/$defs/'.length)]));
  for (const key of ['anyOf', 'oneOf', 'allOf']) for (const next of one[key] || []) found.push(...inner(next));
  if (one.if && one.then && node && node.name === 'Object') {
    const [[key, wanted]] = Object.entries(one.if.properties || {});
    if (told(state, node, key) === wanted.const) found.push(...inner(one.then));
  }
  return found;
}

// The objects and lists from the root to a node, and the keys that lead from one to the next.
function wayTo(state, node) {
  const way = [];
  for (let at = node; at && at.parent; at = at.parent) {
    const { parent } = at;
    if (parent.name === 'Property' && at.name !== 'PropertyName') way.unshift({ key: keyOf(state, parent), of: parent.parent });
    else if (parent.name === 'Array') way.unshift({ key: null, of: parent });
  }
  return way;
}

// The schemas of the value that the way leads to.
function schemasAt(state, way, node) {
  let found = expand(schema, state, way[0] ? way[0].of : node);
  way.forEach(({ key }, at) => {
    const next = at + 1 < way.length ? way[at + 1].of : node;
    found = found.flatMap((one) => {
      const inner = key === null ? one.items : (one.properties && one.properties[key]) || one.additionalProperties;
      return inner && typeof inner === 'object' ? expand(inner, state, next) : [];
    });
  });
  return found;
}

function valuesOf(schemas, key, parentKey) {
  const options = new Map();
  const add = (label, type) => options.set(label, { label: JSON.stringify(label), type });
  for (const one of schemas) {
    for (const value of one.enum || []) add(value, 'enum');
    if (one.const !== undefined) add(one.const, 'constant');
    if (one.type === 'boolean') [true, false].forEach((value) => add(value, 'keyword'));
  }
  if (SIGNAL_KEYS.has(key) || SIGNAL_KEYS.has(parentKey)) signals.forEach((name) => add(name, 'variable'));
  if (AXIS_KEYS.has(key)) axes.forEach((name) => add(name, 'variable'));
  if (key && key.endsWith('.State')) STATES.forEach((name) => add(name, 'enum'));
  return [...options.values()];
}

// Puts a completion in place of the whole text in quotes that the cursor is in.
function put(view, { label }, from) {
  const { head } = view.state.selection.main;
  const quoted = view.state.sliceDoc(from, from + 1) === '"';
  const rest = quoted ? /^[^"\n]*"/.exec(view.state.sliceDoc(head, view.state.doc.lineAt(head).to)) : null;
  view.dispatch({ changes: { from, to: head + (rest ? rest[0].length : 0), insert: label }, selection: { anchor: from + label.length }, userEvent: 'input.complete' });
}

const offered = (from, options) => ({ from, options: options.map((option) => ({ ...option, apply: put })), validFor: /^"?[^"]*$/ });

// Completion of keys and values.
export function complete(context) {
  if (!schema) return null;
  const { state, pos } = context;
  const node = treeOf(state).resolveInner(pos, -1);
  const inString = node.name === 'String' || node.name === 'PropertyName';
  if (!inString && !context.explicit) return null;
  const from = inString ? node.from : pos;
  const property = node.name === 'PropertyName' ? node.parent : null;
  const object = property ? property.parent : node.name === 'Object' ? node : null;
  if (object) {
    const schemas = schemasAt(state, wayTo(state, object), object);
    const present = new Set(children(object, 'Property').filter((one) => !property || one.from !== property.from).map((one) => keyOf(state, one)));
    const options = new Map();
    for (const one of schemas) {
      for (const [key, inner] of Object.entries(one.properties || {})) {
        if (!present.has(key)) options.set(key, { label: JSON.stringify(key), type: 'property', info: inner.description });
      }
      if (one.additionalProperties && one.minProperties) signals.forEach((name) => options.set(name, { label: JSON.stringify(name), type: 'variable' }));
    }
    const way = wayTo(state, object);
    if (way.length > 0 && way[way.length - 1].key === 'set') signals.forEach((name) => options.set(name, { label: JSON.stringify(name), type: 'variable' }));
    return offered(from, [...options.values()]);
  }
  const value = inString ? node : node.name === 'Property' ? node : null;
  if (!value) return null;
  const way = node.name === 'Property' ? [...wayTo(state, node.parent), { key: keyOf(state, node), of: node.parent }] : wayTo(state, node);
  const keys = way.map(({ key }) => key);
  const options = valuesOf(schemasAt(state, way, node), keys[keys.length - 1], keys[keys.length - 2]);
  return options.length > 0 ? offered(from, options) : null;
}

// What is known of the key or value at a place: `{from, to, text}`.
export function explain(state, pos) {
  if (!schema) return null;
  const node = treeOf(state).resolveInner(pos, 1);
  if (node.name === 'PropertyName') {
    const object = node.parent.parent;
    const key = string(state, node);
    const schemas = schemasAt(state, [...wayTo(state, object), { key, of: object }], null);
    const one = schemas.find((one) => one.description);
    return one ? { from: node.from, to: node.to, text: one.description } : null;
  }
  if (node.name !== 'String') return null;
  const pins = schema.$defs[`pins_of_${string(state, node)}`];
  return pins && pins.description ? { from: node.from, to: node.to, text: pins.description } : null;
}
