/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The editor of a scene: CodeMirror with the language's keys, and the engine's messages below their lines. */
import { autocompletion, closeBrackets, closeBracketsKeymap, completionKeymap } from "@codemirror/autocomplete";
import { defaultKeymap, history, historyKeymap } from "@codemirror/commands";
import { yaml } from "@codemirror/lang-yaml";
import {
  HighlightStyle, bracketMatching, ensureSyntaxTree, foldGutter, foldKeymap, indentOnInput, syntaxHighlighting,
  syntaxTree
} from "@codemirror/language";
import { lintGutter, lintKeymap, setDiagnostics } from "@codemirror/lint";
import { EditorState, StateEffect, StateField, Transaction } from "@codemirror/state";
import {
  Decoration, EditorView, WidgetType, drawSelection, highlightActiveLine, hoverTooltip, keymap, lineNumbers
} from "@codemirror/view";
import { tags } from "@lezer/highlight";
import { make } from "./files.js";
import { descriptionAt, keysAt, pathOfNode, placeAt, schemasAt, wordsAt } from "./language.js";

const colours = HighlightStyle.define([
  { tag: [tags.propertyName, tags.definition(tags.propertyName)], class: "code-key" },
  { tag: [tags.string, tags.content], class: "code-text" },
  { tag: tags.comment, class: "code-comment" },
  { tag: [tags.punctuation, tags.separator, tags.bracket], class: "code-mark" }
]);

/* ---- what the schema knows ---- */

let schema = null; /* once the engine has told it */

/** Sets the JSON Schema that completion and hover read. */
export function useSchema(loaded) { schema = loaded; }

const firstLine = (text) => (text || "").split("\n")[0];
const lastPart = (text) => (text || "").split("\n\n").slice(1).join(" ");

function describe(text) {
  const parts = text.split("\n\n").map((part) => make("p", { textContent: part }));
  return make("div", { className: "code-help" }, ...parts);
}

function keyOptions(path) {
  return Object.entries(keysAt(schema, path)).map(([key, value]) => ({
    label: key, type: "property", apply: key + ": ", detail: firstLine(lastPart(value.description)),
    info: () => describe(value.description || "")
  }));
}

function complete(context) {
  if (!schema) return null;
  const place = placeAt(context.state, context.pos);
  const begun = "key" in place ? place.key : place.value;
  if (!begun && !context.explicit) return null;
  const options = "key" in place ? keyOptions(place.path)
    : wordsAt(schema, place.path).map((word) => ({ label: word, type: "enum" }));
  return options.length ? { from: context.pos - begun.length, options, validFor: /^[\w-]*$/ } : null;
}

const help = hoverTooltip((view, position) => {
  if (!schema) return null;
  ensureSyntaxTree(view.state, position, 50);
  const node = syntaxTree(view.state).resolveInner(position, 1);
  if (node.from > position || node.name === "Comment" || node.name === "Document") return null;
  const path = pathOfNode(view.state, node), text = descriptionAt(schema, path);
  if (!text || !schemasAt(schema, path).length) return null;
  return { pos: node.from, end: node.to, above: true, create: () => ({ dom: describe(text) }) };
}, { hoverTime: 250 });

/* ---- messages ---- */

class Note extends WidgetType {
  constructor(text) {
    super();
    this.text = text;
  }
  eq(other) { return other.text === this.text; }
  toDOM() {
    return make("div", { className: "code-note", role: "note", textContent: this.text });
  }
}

const setNotes = StateEffect.define();
const notes = StateField.define({
  create: () => Decoration.none,
  update(shown, change) {
    shown = shown.map(change.changes);
    for (const effect of change.effects) if (effect.is(setNotes)) shown = effect.value;
    return shown;
  },
  provide: (field) => EditorView.decorations.from(field)
});

/* The offset of a column counted in code points. */
function offsetOf(line, column) {
  const letters = Array.from(line.text).slice(0, Math.max(0, column - 1));
  return Math.min(line.to, line.from + letters.join("").length);
}

function diagnosticOf(doc, message) {
  const line = doc.line(Math.min(Math.max(message.line, 1), doc.lines));
  const from = offsetOf(line, message.column);
  const to = Math.max(Math.min(from + 1, line.to), offsetOf(line, message.column + (message.length || 1)));
  const hint = message.hint ? "; did you mean '" + message.hint + "'?" : "";
  const text = message.text.includes("did you mean") ? message.text : message.text + hint;
  return { from, to, severity: "error", message: text, line };
}

const NEAR = 6; /* lines from the one that is written, within which messages are seen */

/* ---- the editor ---- */

const theme = EditorView.theme({
  "&": { height: "100%", fontSize: "13px", color: "var(--ink)", backgroundColor: "var(--paper)" },
  ".cm-scroller": { fontFamily: "ui-monospace, 'DejaVu Sans Mono', monospace", lineHeight: "1.45" },
  ".cm-gutters": { backgroundColor: "var(--ground)", color: "var(--soft)", border: "none" },
  ".cm-activeLine": { backgroundColor: "color-mix(in srgb, var(--accent) 7%, transparent)" },
  ".cm-content": { caretColor: "var(--ink)" },
  ".cm-cursor": { borderLeftColor: "var(--ink)" },
  "&.cm-focused .cm-selectionBackground, .cm-selectionBackground": {
    backgroundColor: "color-mix(in srgb, var(--accent) 25%, transparent) !important"
  },
  ".cm-tooltip": { backgroundColor: "var(--paper)", color: "var(--ink)", border: "1px solid var(--line)" },
  ".cm-tooltip-autocomplete ul li[aria-selected]": { backgroundColor: "var(--accent)", color: "var(--paper)" },
  ".cm-foldPlaceholder": { backgroundColor: "var(--ground)", color: "var(--soft)", borderColor: "var(--line)" }
});

/* Has a person replaced all of the text, as by pasting another scene? */
function replacesAll({ changes, startState }) {
  let all = false;
  changes.iterChanges((from, to) => { all = all || (from === 0 && to > 0 && to === startState.doc.length); });
  return all;
}

/** An editor in `host`. `onEdit(replaced)` hears what a person changes, or replaces, not what setText does. */
export function createEditor(host, onEdit) {
  let silent = false;
  const heard = EditorView.updateListener.of((update) => {
    if (update.docChanged && !silent) onEdit(replacesAll(update));
  });
  const extensions = [
    lineNumbers(), foldGutter(), history(), drawSelection(), indentOnInput(), bracketMatching(),
    closeBrackets(), highlightActiveLine(), lintGutter(), yaml(), syntaxHighlighting(colours), notes, help,
    autocompletion({ override: [complete], icons: false }), theme, heard,
    EditorView.contentAttributes.of({ "aria-label": "The scene's YAML", spellcheck: "false" }),
    keymap.of([...closeBracketsKeymap, ...defaultKeymap.filter((k) => k.key !== "Mod-Enter"), ...historyKeymap,
      ...foldKeymap, ...completionKeymap, ...lintKeymap])
  ];
  const view = new EditorView({ parent: host, state: EditorState.create({ extensions }) });
  return {
    view,
    get state() {
      ensureSyntaxTree(view.state, view.state.doc.length, 200);
      return view.state;
    },
    get text() { return view.state.doc.toString(); },
    /** Another text, without history and messages. */
    setText(text) {
      silent = true;
      view.setState(EditorState.create({ doc: text, extensions }));
      silent = false;
    },
    /** Replaces parts {from, to, insert} of the text, as one step that can be undone. */
    replace(changes) {
      view.dispatch({ changes, annotations: Transaction.userEvent.of("input") });
    },
    /** Shows located messages {text, line, column, length, hint}. */
    showMessages(messages) {
      const { state } = view, found = messages.filter((m) => m.line > 0).map((m) => diagnosticOf(state.doc, m));
      found.sort((a, b) => a.from - b.from);
      const below = found.map((d) => ({ at: d.line.to, text: d.message }));
      const here = state.doc.lineAt(state.selection.main.head);
      if (found.length && view.hasFocus && !found.some((d) => Math.abs(d.line.number - here.number) < NEAR))
        below.push({ at: here.to, text: "line " + found[0].line.number + ": " + found[0].message });
      view.dispatch({ effects: setNotes.of(Decoration.set(below.map(({ at, text }) =>
        Decoration.widget({ widget: new Note(text), block: true, side: 1 }).range(at)), true)) });
      view.dispatch(setDiagnostics(view.state, found.map(({ from, to, severity, message }) =>
        ({ from, to, severity, message }))));
      if (found.length && !view.hasFocus)
        view.dispatch({ effects: EditorView.scrollIntoView(found[0].from, { y: "center" }) });
    }
  };
}
