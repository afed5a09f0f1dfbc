// The editor: a script and the files it names, one at a time. It stands in a shadow root, whose styles need no inline ones.

import { autocompletion, closeBrackets, closeBracketsKeymap, completionKeymap } from '@codemirror/autocomplete';
import { defaultKeymap, history, historyKeymap, isolateHistory } from '@codemirror/commands';
import { json } from '@codemirror/lang-json';
import { HighlightStyle, bracketMatching, syntaxHighlighting } from '@codemirror/language';
import { diagnosticCount, lintKeymap, setDiagnostics } from '@codemirror/lint';
import { EditorState, Prec } from '@codemirror/state';
import { EditorView, drawSelection, highlightActiveLine, hoverTooltip, keymap, lineNumbers } from '@codemirror/view';
import { tags } from '@lezer/highlight';
import { complete, explain, treeOf } from './schema.js';

const STEP = 4; // pixels of a step while a number is dragged

const look = EditorView.theme({
  '&': { height: '100%', fontSize: '12.5px', backgroundColor: 'var(--panel)', color: 'var(--ink)' },
  '.cm-scroller': { fontFamily: 'ui-monospace, "SF Mono", "DejaVu Sans Mono", Menlo, Consolas, monospace', lineHeight: '1.5' },
  '.cm-gutters': { backgroundColor: 'var(--panel)', color: 'var(--muted)', border: 'none' },
  '.cm-activeLine, .cm-activeLineGutter': { backgroundColor: 'var(--hover)' },
  '&.cm-focused': { outline: '2px solid var(--trace-0)', outlineOffset: '-2px' },
  '.cm-cursor': { borderLeftColor: 'var(--ink)' },
  '.cm-selectionBackground, &.cm-focused > .cm-scroller > .cm-selectionLayer .cm-selectionBackground': { backgroundColor: 'var(--select)' },
  '.cm-tooltip': { backgroundColor: 'var(--panel)', color: 'var(--ink)', border: '1px solid var(--line)', maxWidth: '34em', fontFamily: 'system-ui, sans-serif' },
  '.cm-tooltip-autocomplete > ul > li[aria-selected]': { backgroundColor: 'var(--trace-0)', color: 'var(--panel)' },
  '.cm-diagnostic': { whiteSpace: 'pre-wrap' },
  '.explain': { padding: '4px 8px' },
  '.number': { color: 'var(--in)', cursor: 'ew-resize', touchAction: 'pan-y' },
});

const colours = HighlightStyle.define([
  { tag: tags.propertyName, color: 'var(--trace-0)' },
  { tag: tags.string, color: 'var(--out)' },
  { tag: tags.number, class: 'number' },
  { tag: [tags.bool, tags.null], color: 'var(--both)' },
]);

const hover = hoverTooltip((view, pos) => {
  const found = explain(view.state, pos);
  if (!found) return null;
  return {
    pos: found.from, end: found.to, above: true,
    create() {
      const dom = document.createElement('div');
      dom.className = 'explain';
      dom.textContent = found.text;
      return { dom };
    },
  };
});

// The number at a place: `{from, to, text}`.
function numberAt(state, pos) {
  for (const side of [1, -1]) {
    const node = treeOf(state).resolveInner(pos, side);
    if (node.name === 'Number') return { from: node.from, to: node.to, text: state.sliceDoc(node.from, node.to) };
  }
  return null;
}

// The number so many steps further on, written as finely as it was: a step is one of its last digit, or a hundredth of it.
export function stepped(text, steps) {
  const value = Number(text);
  if (/e/i.test(text) || !Number.isFinite(value)) return String(Number((value * 1.01 ** steps).toPrecision(6)));
  const digits = (text.split('.')[1] || '').length;
  const size = Math.abs(value);
  const step = digits === 0 && size >= 1000 ? 10 ** (Math.floor(Math.log10(size)) - 2) : 10 ** -digits;
  return (value + steps * step).toFixed(digits).replace(/^-(0(\.0*)?)$/, '$1');
}

function replaceNumber(view, from, old, text) {
  view.dispatch({ changes: { from, to: from + old.length, insert: text }, userEvent: 'input.number' });
}

const turn = (steps) => (view) => {
  const found = numberAt(view.state, view.state.selection.main.head);
  if (!found) return false;
  replaceNumber(view, found.from, found.text, stepped(found.text, steps));
  return true;
};

// Dragging a number sideways; a click without a move puts the cursor, as everywhere.
function drag(event, view) {
  if (event.button !== 0 || event.shiftKey || event.altKey || event.detail > 1 || !event.target.closest('.number')) return false;
  const pos = view.posAtCoords({ x: event.clientX, y: event.clientY });
  const found = pos === null ? null : numberAt(view.state, pos);
  if (!found) return false;
  event.preventDefault();
  let now = found.text;
  let moved = false;
  const move = (next) => {
    const steps = Math.round((next.clientX - event.clientX) / STEP);
    moved = moved || steps !== 0;
    const text = stepped(found.text, steps);
    if (text === now) return;
    replaceNumber(view, found.from, now, text);
    now = text;
  };
  const stop = () => {
    window.removeEventListener('pointermove', move);
    window.removeEventListener('pointerup', stop);
    window.removeEventListener('pointercancel', stop);
    if (!moved) {
      view.dispatch({ selection: { anchor: pos } });
      view.focus();
    }
  };
  window.addEventListener('pointermove', move);
  window.addEventListener('pointerup', stop);
  window.addEventListener('pointercancel', stop);
  return true;
}

// An editor in `host`. `changed(text)` is called after every change.
export function makeEditor(host, changed) {
  const root = host.attachShadow({ mode: 'open' });
  const common = [
    lineNumbers(), history(), drawSelection(), highlightActiveLine(), bracketMatching(), closeBrackets(), look, syntaxHighlighting(colours),
    EditorState.tabSize.of(2), EditorView.lineWrapping,
    Prec.high(keymap.of([
      { key: 'Alt-ArrowUp', run: turn(1) }, { key: 'Alt-ArrowDown', run: turn(-1) },
      { key: 'Shift-Alt-ArrowUp', run: turn(10) }, { key: 'Shift-Alt-ArrowDown', run: turn(-10) },
    ])),
    keymap.of([...closeBracketsKeymap, ...defaultKeymap, ...historyKeymap, ...completionKeymap, ...lintKeymap]),
    EditorView.domEventHandlers({ mousedown: drag }),
    EditorView.updateListener.of((update) => update.docChanged && changed(update.state.doc.toString())),
  ];
  const script = [json(), autocompletion({ override: [complete] }), hover];
  const state = (name, text) => EditorState.create({
    doc: text,
    extensions: [...common, ...(name.endsWith('.json') ? script : []), EditorView.contentAttributes.of({ 'aria-label': `Text of ${name}` })],
  });
  const view = new EditorView({ parent: root, root, state: state('script.json', '') });
  // It scrolls by its keys, too.
  view.scrollDOM.tabIndex = 0;
  return {
    view,
    open: (name, text) => view.setState(state(name, text)),
    // Another text in place of this one: a change of what differs, which is undone by itself.
    replace(text) {
      const old = view.state.doc.toString();
      const most = Math.min(old.length, text.length);
      let [from, same] = [0, 0];
      while (from < most && old[from] === text[from]) from++;
      while (same < most - from && old[old.length - 1 - same] === text[text.length - 1 - same]) same++;
      view.dispatch({ changes: { from, to: old.length - same, insert: text.slice(from, text.length - same) }, annotations: isolateHistory.of('full') });
    },
    // Squiggles: `[{from: [line, column], to: [line, column], message, severity}]`, columns in characters.
    mark(found) {
      const { doc } = view.state;
      const place = ([line, column]) => {
        const { from, text } = doc.line(Math.min(Math.max(line, 1), doc.lines));
        return from + [...text].slice(0, column - 1).join('').length;
      };
      const diagnostics = found.map(({ from, to, message, severity }) => {
        const start = place(from);
        return { from: start, to: Math.max(start, to ? place(to) : doc.lineAt(start).to), message, severity };
      });
      // To draw nothing anew takes the editor a while, too: a number that is dragged has no time for that.
      if (diagnostics.length === 0 && diagnosticCount(view.state) === 0) return;
      view.dispatch(setDiagnostics(view.state, diagnostics));
    },
    // The cursor behind the first place that has this text.
    goBehind(text) {
      view.dispatch({ selection: { anchor: view.state.doc.toString().indexOf(text) + text.length }, scrollIntoView: true });
      view.focus();
    },
    goTo([line, column]) {
      const { from, text } = view.state.doc.line(Math.min(line, view.state.doc.lines));
      const anchor = from + [...text].slice(0, column - 1).join('').length;
      view.dispatch({ selection: { anchor }, scrollIntoView: true });
      view.focus();
    },
  };
}
