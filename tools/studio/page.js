// tools/studio/page.js - what all places share: elements without HTML texts, requests, uploads, words.
import {words} from "./words.js";

const languages = Object.keys(words);
let language = localStorage.getItem("language") || (navigator.language || "en").slice(0, 2);
if (!languages.includes(language)) language = "en";
document.documentElement.lang = language;

/** The sentence of a key in the chosen language, with {name}s filled in. */
export function t(key, values = {}) {
  const text = words[language][key] ?? words.en[key] ?? key;
  return text.replace(/\{(\w+)\}/g, (_, name) => values[name] ?? "");
}

export function setUpLanguage(select) {
  select.value = language;
  select.setAttribute("aria-label", t("language"));
  select.addEventListener("change", () => {
    localStorage.setItem("language", select.value);
    location.reload();
  });
}

/** An element. Names beginning with "on" are listeners; children are elements or texts, never HTML. */
export function el(tag, properties = {}, ...children) {
  const svg = ["svg", "g", "circle", "rect", "line", "path", "text", "title", "polygon"].includes(tag);
  const node = svg ? document.createElementNS("http://www.w3.org/2000/svg", tag) : document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (value === undefined || value === null || value === false) continue;
    if (name.startsWith("on"))
      node.addEventListener(name.slice(2), value);
    else if (["value", "checked", "disabled", "selected", "open", "multiple"].includes(name))
      node[name] = value;
    else
      node.setAttribute(name, value === true ? "" : value);
  }
  node.append(...children.flat().filter((child) => child !== null && child !== undefined && child !== false));
  return node;
}

/** Replaces an element's children only if their description changed, so that focus and loaded pictures stay. */
export function fill(node, key, make) {
  if (node.dataset.key === key) return;
  node.dataset.key = key;
  node.replaceChildren(...[make()].flat().filter(Boolean));
}

export class Refusal extends Error {}

async function answerOf(response) {
  const text = await response.text();
  let json = {};
  try {
    json = JSON.parse(text);
  } catch {
    if (!response.ok) throw new Refusal(text || response.statusText);
  }
  if (!response.ok) {
    const error = json.error || {};
    throw new Refusal(
        error.what ? `${error.where ? error.where + " " : ""}${error.what}. ${error.remedy || ""}` :
                     error.message || response.statusText);
  }
  return json;
}

export async function ask(path, options = {}) { return answerOf(await fetch(path, options)); }

/** Sends a request that changes something; a refusal is shown on the page. Returns its answer, or null. */
export async function send(path, body) {
  try {
    notice("");
    return await ask(path, {method: "POST", body: body instanceof Blob ? body : JSON.stringify(body ?? {})});
  } catch (error) {
    notice(error instanceof Refusal ? error.message : t("gone"));
    return null;
  }
}

/** Sends files one after the other, each as it is; tries again after a dropped connection. `said(index, words, bad)` */
export async function upload(path, files, said) {
  let sent = 0;
  for (const [index, file] of [...files].entries()) {
    for (let attempt = 0;; ++attempt) {
      try {
        said(index, t("sending", {name: file.name}), false);
        await ask(`${path}${path.includes("?") ? "&" : "?"}name=${encodeURIComponent(file.name)}`, {method: "POST", body: file});
        ++sent;
        said(index, "", false);
        break;
      } catch (error) {
        if (error instanceof Refusal || attempt >= 4) {
          said(index, error instanceof Refusal ? `${file.name}: ${error.message}` : t("notSent", {name: file.name}), true);
          break;
        }
        await pause(500 * 2 ** attempt);
      }
    }
  }
  return sent;
}

export const pause = (ms) => new Promise((done) => setTimeout(done, ms));

export function notice(words) {
  const box = document.getElementById("notice");
  box.hidden = !words;
  box.replaceChildren();
  if (words) box.append(el("span", {}, words), el("button", {onclick: () => notice("")}, t("close")));
}

export function announce(words) { document.getElementById("said").textContent = words; }

/** A place to drop files, with its button for the keyboard. */
export function dropZone(title, hint, accept, take, small = false) {
  const input = el("input", {
    type: "file",
    multiple: true,
    accept,
    onchange: () => {
      take(input.files);
      input.value = "";
    }
  });
  const zone =
      el("label", {class: small ? "drop small-drop" : "drop"}, el("strong", {}, title), el("span", {class: "soft"}, hint), input);
  for (const kind of ["dragover", "dragleave", "drop"])
    zone.addEventListener(kind, (event) => {
      event.preventDefault();
      zone.classList.toggle("over", kind === "dragover");
      if (kind === "drop" && event.dataTransfer.files.length) take(event.dataTransfer.files);
    });
  return zone;
}

export const number = (value, digits = 1) =>
    Number(value).toLocaleString(language, {maximumFractionDigits: digits, minimumFractionDigits: digits});

/** Follows the state at `path`; asks nothing while the page is hidden. `extra()`: more of the query. */
export function follow(path, extra, update) {
  let seen = 0, controller = new AbortController(), lost = false;
  const wake = () => controller.abort();
  document.addEventListener("visibilitychange", wake);
  (async () => {
    for (;;) {
      if (document.hidden) await new Promise((done) => document.addEventListener("visibilitychange", done, {once: true}));
      controller = new AbortController();
      try {
        const state = await ask(`${path}?seen=${seen}${extra()}`, {signal: controller.signal});
        if (lost) notice("");
        lost = false;
        const same = seen === state.revision;
        seen = state.revision;
        if (!same) update(state);
        await pause(100);
      } catch (error) {
        if (error.name === "AbortError") continue;
        if (!lost) notice(error instanceof Refusal ? error.message : t("gone"));
        lost = true;
        await pause(2000);
      }
    }
  })();
  return wake;
}

/** The part of a place with this name, made when it is first asked for. */
export function part(root, name, attributes = {}) {
  const found = [...root.children].find((child) => child.dataset.part === name);
  if (found) return found;
  const node = el("div", {"data-part": name, ...attributes});
  root.append(node);
  return node;
}

/** Sentence, main button and a softer line: the head of each place. */
export function lead(root, key, sentence, button, more) {
  fill(
      part(root, "lead", {class: "lead"}), key,
      () =>
          [el("h1", {}, sentence),
           button &&
               el(button.href ? "a" : "button", {
                 class: "main button",
                 id: "main",
                 href: button.href,
                 download: button.download,
                 disabled: button.disabled,
                 onclick: button.action
               },
                  button.words),
           more && el("p", {class: "more"}, more)]);
}

export const fileUrl = (path, version) =>
    "/file/" + path.split("/").map(encodeURIComponent).join("/") + (version ? `?v=${version}` : "");
export const newestBoard = (state) => (state.project.boards || []).at(-1);
export const has = (board, name) => Boolean(board && board.files.some((file) => file.name === name));

/** Errors, then warnings, then notes, each with its remedy. */
export function findings(list) {
  const order = {error: 0, warning: 1, note: 2};
  return el(
      "ul", {class: "findings"},
      [...list]
          .sort((a, b) => (order[a.severity] ?? 3) - (order[b.severity] ?? 3))
          .map(
              (one) => el(
                  "li", {class: one.severity}, el("b", {}, (one.file ? one.file + ": " : "") + (one.message ?? one.what ?? "")),
                  one.remedy ? el("span", {}, one.remedy) : null)));
}
