/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What the language's JSON Schema says of a place in a scene: keys and values to complete, and the text on hover.
 * The place is a path of keys, such as ["members", "m1", "stiffness"]; items of lists are "[]".
 */
import { syntaxTree } from "@codemirror/language";

const MOST_FORMS = 60;

/* All forms that a schema may take: references followed, branches of conditions and alternatives side by side. */
function formsOf(root, schema, found = new Set()) {
  if (!schema || typeof schema !== "object" || found.has(schema) || found.size > MOST_FORMS)
    return found;
  found.add(schema);
  const next = [schema.then, schema.else, ...(schema.anyOf || []), ...(schema.oneOf || []),
    ...(schema.allOf || [])];
  if (schema.$ref) next.push(root.definitions[decodeURIComponent(schema.$ref.slice("#/definitions/".length))]);
  for (const form of next) formsOf(root, form, found);
  return found;
}

function stepInto(root, schema, key) {
  const found = [];
  for (const form of formsOf(root, schema)) {
    if (key === "[]") found.push(form.items);
    else if (form.properties && Object.hasOwn(form.properties, key)) found.push(form.properties[key]);
    else if (form.additionalProperties) found.push(form.additionalProperties);
  }
  return found.filter((form) => form && typeof form === "object");
}

/** The schemas at a path. */
export function schemasAt(root, path) {
  let schemas = [root];
  for (const key of path) schemas = schemas.flatMap((schema) => stepInto(root, schema, key));
  return schemas;
}

/** {key: schema} of all keys that may stand at a path. */
export function keysAt(root, path) {
  const found = {};
  for (const schema of schemasAt(root, path))
    for (const form of formsOf(root, schema)) Object.assign(found, form.properties);
  return found;
}

/** The words that may stand at a path as a value. */
export function wordsAt(root, path) {
  const words = schemasAt(root, path).flatMap((schema) =>
    [...formsOf(root, schema)].flatMap((form) => form.enum || []));
  return [...new Set(words.map(String))];
}

/** The description at a path: what the key is, its units and its default; "" where there is none. */
export function descriptionAt(root, path) {
  for (const schema of schemasAt(root, path)) if (schema.description) return schema.description;
  return "";
}

/* ---- places in the text ---- */

const textOf = (state, node) => state.sliceDoc(node.from, node.to);

/** The text of a scalar without its quotes. */
export const unquoted = (text) => text.replace(/^(["'])(.*)\1$/, "$2");

/** The key of a Pair in the tree of YAML. */
export function keyOf(state, pair) {
  const key = pair.getChild("Key");
  return key ? unquoted(textOf(state, key)) : "";
}

/** The path to a node of the tree, from the keys and lists around it. */
export function pathOfNode(state, node) {
  const path = [];
  for (let at = node; at; at = at.parent) {
    if (at.name === "Pair") path.unshift(keyOf(state, at));
    else if (at.name === "Item") path.unshift("[]");
    else if (at.parent && at.parent.name === "FlowSequence" && at.name !== "[") path.unshift("[]");
  }
  return path;
}

const HEAD = /^(\s*)((?:- +)*)(?:("[^"]*"|'[^']*'|[^\s:#{}[\],"'][^:#{}[\],]*?)\s*:(?=\s|$))?/;

/* The keys of lines above that are indented less, from the outermost. */
function blockPath(doc, lineNumber, indent) {
  const path = [];
  for (let n = lineNumber - 1; n > 0 && indent > 0; n--) {
    const text = doc.line(n).text;
    if (!text.trim() || text.trim().startsWith("#")) continue;
    const [, space, dashes, key] = HEAD.exec(text);
    const at = space.length + dashes.length;
    if (at < indent) {
      if (key) path.unshift(unquoted(key));
      indent = at;
    }
    if (dashes && space.length < indent) {
      path.unshift("[]");
      indent = space.length;
    }
  }
  return path;
}

function flowAt(state, position) {
  for (let at = syntaxTree(state).resolveInner(position, -1); at; at = at.parent) {
    const inside = position > at.from && (position < at.to || !"]}".includes(state.sliceDoc(at.to - 1, at.to)));
    if ((at.name === "FlowMapping" || at.name === "FlowSequence") && inside) return at;
  }
  return null;
}

/* Inside braces or brackets: what stands since the last of "{[,". */
function flowPlace(state, flow, position) {
  const before = state.sliceDoc(flow.from, position), path = pathOfNode(state, flow);
  const part = /[^{[,]*$/.exec(before)[0], match = /^\s*([^:]*?)\s*:\s+(.*)$/.exec(part);
  if (flow.name === "FlowSequence") return { path: [...path, "[]"], value: part.trimStart() };
  if (match) return { path: [...path, unquoted(match[1])], value: match[2] };
  return { path, key: part.trimStart() };
}

/** The place of the cursor: {path, key} where a key is begun, {path, value} where a value is. */
export function placeAt(state, position) {
  const flow = flowAt(state, position);
  if (flow) return flowPlace(state, flow, position);
  const line = state.doc.lineAt(position), before = line.text.slice(0, position - line.from);
  const [head, space, dashes, key] = HEAD.exec(before);
  const indent = space.length + dashes.length;
  const path = blockPath(state.doc, line.number, dashes ? space.length + 1 : indent);
  if (dashes) path.push("[]");
  if (key) return { path: [...path, unquoted(key)], value: before.slice(head.length).trimStart() };
  return { path, key: before.slice(indent) };
}

/** Where a value stands that a path of keys leads to: {from, to, text}, or null. */
export function valueAt(state, path) {
  let node = syntaxTree(state).topNode.getChild("Document");
  for (const wanted of path) {
    const mapping = node && (node.getChild("BlockMapping") || node.getChild("FlowMapping"));
    const pair = mapping && mapping.getChildren("Pair").find((p) => keyOf(state, p) === wanted);
    if (!pair) return null;
    node = pair;
  }
  const value = node.lastChild;
  if (!value || value.name === "Key" || value.name === ":") return null;
  return { from: value.from, to: value.to, text: textOf(state, value), pair: node };
}

/** Keys of the mapping at a path, in their order. */
export function keysIn(state, path) {
  const value = valueAt(state, path), mapping = value && value.pair.lastChild;
  return mapping && /Mapping$/.test(mapping.name)
    ? mapping.getChildren("Pair").map((pair) => keyOf(state, pair)) : [];
}
