// tools/studio/studio.js - the frame around the five places: steps, running work, questions. It follows the server's state.
import {showCarve} from "./carve.js";
import {showDesign} from "./design.js";
import {showLook} from "./look.js";
import {announce, el, fill, findings, follow, part, send, setUpLanguage, t} from "./page.js";
import {showPictures} from "./pictures.js";
import {showPlace} from "./place.js";

const places = {
  pictures: showPictures,
  place: showPlace,
  design: showDesign,
  carve: showCarve,
  look: showLook
};
const main = document.getElementById("place");
let current = location.hash.slice(1), state = null, wake = () => {}, wasRunning = false;

function isDone(name) {
  const boards = state.project.boards || [], board = boards.at(-1);
  return {
    pictures: state.project.made,
    place: boards.length > 0,
    design: Boolean(board?.files.some((f) => f.name === "scratches.csv")),
    carve: (board?.photos.length ?? 0) > 0,
    look: boards.some((b) => b.measured)
  }[name];
}

function firstPlace() {
  if (!state.project.made) return "pictures";
  const board = (state.project.boards || []).at(-1);
  if (!board) return "place";
  if (!board.files.some((f) => f.name === "board.gcode")) return "design";
  return board.photos.length || board.measured ? "look" : "carve";
}

export function go(name) {
  current = name;
  history.replaceState(null, "", "#" + name);
  main.replaceChildren();
  show();
  main.focus({preventScroll: true});
  window.scrollTo(0, 0);
  if (name === "look") wake();
}

function showSteps() {
  const nav = document.getElementById("steps");
  nav.setAttribute("aria-label", t("steps"));
  fill(
      nav, Object.keys(places).map((name) => [name, isDone(name), name === current]).join(),
      () => Object.keys(places).map(
          (name, index) =>
              el("button",
                 {class: isDone(name) ? "done" : "", "aria-current": name === current ? "step" : null, onclick: () => go(name)},
                 el("span", {class: "mark", "aria-hidden": "true"}, isDone(name) ? "✓" : String(index + 1)), t(name))));
}

function showWork() {
  const footer = document.getElementById("work"), work = state.work;
  footer.hidden = !work?.running && !state.at_work;
  if (work?.running) {
    const stage = work.events.findLast((event) => event.event === "stage");
    const words = t("action_" + work.action) + (stage ? ": " + t("stage_" + stage.stage.split("/").at(-1)) : "");
    fill(
        footer, "running" + work.action + work.stopping,
        () =>
            [el("div", {class: "words"}),
             el("div", {
               class: "bar",
               role: "progressbar",
               "aria-valuemin": 0,
               "aria-valuemax": 100,
               "aria-label": t("action_" + work.action)
             },
                el("div")),
             el("button", {disabled: work.stopping, onclick: () => send("/api/stop")}, t(work.stopping ? "stopping" : "stop"))]);
    footer.querySelector(".words").textContent = words + (work.stage ? " – " + work.stage : "");
    const bar = footer.querySelector(".bar"), percent = Math.round(100 * work.fraction);
    bar.setAttribute("aria-valuenow", percent);
    bar.firstChild.style.width = percent + "%";
    if (footer.dataset.said !== words) announce((footer.dataset.said = words));
  } else if (state.at_work) {
    fill(footer, state.at_work, () => [el("div", {class: "words"}, t("otherWork", {work: state.at_work}))]);
  }
  if (wasRunning && !work?.running) announce(t("done", {action: t("action_" + work.action)}));
  wasRunning = Boolean(work?.running);
}

/** What a command refused, with its own remedy; where it asks, the answers that it takes. */
function showQuestion() {
  const stages = state.status?.data?.stages || [];
  const interrupted = stages.some((stage) => stage.condition === "interrupted");  // Design's main button answers it
  const asking = stages.filter((stage) => stage.asks), result = state.work?.running ? null : state.work?.result;
  const errors = result && result.exit_code !== 0 ?
      result.diagnostics.filter(
          (one) => one.severity === "error" && one.code !== "stopped" && !(one.code === "question" && interrupted)) :
      [];
  const open = state.work?.events.findLast((event) => event.event === "undetermined")?.parameters || [];  // of a measurement
  const box = part(main, "question");
  if (main.firstChild !== box) main.prepend(box);
  const shown = !state.work?.running && !state.at_work && state.project.made && (asking.length || errors.length) ||
      (!state.project.made && errors.length);
  fill(box, shown ? JSON.stringify([errors, asking.map((s) => [s.stage, s.words])]) : "", () => {
    if (!shown) return [];
    const answer = (wish) => async () => {
      if (await send("/api/do", {action: "loop", ...wish})) go("design");
    };
    return el(
        "section", {class: "panel question"}, el("h2", {}, t(asking.length || open.length ? "question" : "failed")),
        errors.length ? findings(errors.map((one) => (asking.length ? {...one, remedy: ""} : one))) :
                        findings(asking.map((stage) => ({severity: "warning", message: stage.stage + ": " + stage.words}))),
        asking.length ? el("div", {class: "row"},
                           asking.slice(0, 1).map((stage) => el("button", {onclick: answer({force: stage.stage})}, t("again", {
                                                                  stage: t("stage_" + stage.stage.split("/").at(-1))
                                                                }))),
                           el("button", {onclick: answer({"allow-stale": true})}, t("keep"))) :
                        null,
        open.length && errors.length ?
            el("div", {class: "row"},
               el("button", {onclick: answer({"allow-undetermined": open})}, t("without", {names: open.join(", ")}))) :
            null);
  });
}

function show() {
  if (!state) return;
  if (!places[current]) current = firstPlace();
  document.getElementById("name").textContent = state.name;
  document.title = state.name + " – Burin";
  showSteps();
  showQuestion();
  places[current](main, state, go);
  showWork();
}

document.getElementById("skip").textContent = t("skip");
setUpLanguage(document.getElementById("language"));
window.addEventListener("hashchange", () => {
  if (location.hash.slice(1) !== current) go(location.hash.slice(1));
});
wake = follow("/api/state", () => (current === "look" ? "&looks=1" : ""), (news) => {
  state = news;
  show();
});
