// tools/studio/place.js - Place: board, lamps and eyes from above and from the side, dragged into bench.json.
import {el, fill, lead, number, part, send, t} from "./page.js";
import {drawSetup, roughFigures, setupOf} from "./setup.js";

export function showPlace(root, state, go) {
  const {bench, board} = state.project;
  lead(
      root, "lead" + state.project.made, t("placeLead"),
      {words: t("toDesign"), disabled: !state.project.made, action: () => go("design")}, t("placeMore"));
  if (!bench || !board) return;
  const measured = (state.project.boards || []).some((one) => one.measured);
  const content = part(root, "content");
  if (content.dataset.busy) return;  // not under a person's hand
  fill(content, JSON.stringify([bench, measured]), () => {
    const setup = setupOf(bench, board), rows = el("tbody"), drawings = el("div", {class: "halves"});
    const save = (kind, name, at) => send("/api/edit", {what: "place", [kind === "lamp" ? "lamps" : "eyes"]: {[name]: at}});
    const moved = (kind, name, at, done) => {
      content.dataset.busy = done ? "" : "1";
      if (!done) return fillRows();
      delete content.dataset.busy;
      content.dataset.key = "";
      save(kind, name, at).then(() => {
        draw();
        fillRows();
      });
    };
    const draw = () => drawings.replaceChildren(drawSetup(setup, false, {moved}), drawSetup(setup, true, {moved}));
    const row = (kind, name, at) => {
      const inputs = ["right", "up", "out"].map((axis, i) => el("td", {}, el("input", {
                                                                  type: "number",
                                                                  step: 1,
                                                                  disabled: setup.posed.includes(name),
                                                                  value: Math.round(at[i]),
                                                                  "aria-label": `${name}, ${t(axis)}, mm`,
                                                                  onchange: (event) => {
                                                                    at[i] = Number(event.target.value);
                                                                    moved(kind, name, at, true);
                                                                  }
                                                                })));
      let words = "", bad = false;
      if (kind === "eye") {
        const rough = roughFigures(setup, name);
        bad = rough.mirror < 12;
        words = t("away", {d: number(rough.away, 0)}) + ", " + t("mirror", {d: number(rough.mirror, 0)}) +
            (rough.neighbour < 180 ? ", " + t("neighbour", {d: number(rough.neighbour, 0)}) : "");
        if (bad) words += ". " + t("glare");
      }
      return el(
          "tr", {}, el("th", {scope: "row"}, kind === "lamp" && name === "lamp" ? t("lampPlace") : t(kind, {name})), inputs,
          el("td", {class: "small " + (bad ? "warning" : "soft")}, words));
    };
    const fillRows = () => rows.replaceChildren(
        ...Object.entries(setup.lamps).map(([name, at]) => row("lamp", name, at)),
        ...Object.entries(setup.eyes).map(([name, at]) => row("eye", name, at)));
    draw();
    fillRows();
    return [
      measured || setup.posed.length ? el("p", {class: "warning"}, t("fixedPlace")) : null, drawings,
      el("details", {open: window.innerWidth > 900}, el("summary", {}, t("position")), el("table", {class: "places"}, rows)),
      el("p", {class: "soft small"}, t("coarse"))
    ];
  });
  fill(
      part(root, "undo", {class: "row"}), "undo" + state.project.former,
      () => [state.project.former ? el("button", {onclick: () => send("/api/edit", {what: "undo"})}, t("undo")) : null]);
}
