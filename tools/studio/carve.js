// tools/studio/carve.js - Carve: the check first, files for the machine, pages to print, the tool's way over time.
import {el, fileUrl, fill, findings, has, lead, newestBoard, number, part, send, t} from "./page.js";

async function showPath(box, url) {
  const rows = (await (await fetch(url)).text()).trim().split("\n"), names = rows[0].split(",");
  const columns = ["x0_mm", "y0_mm", "x1_mm", "y1_mm"].map((name) => names.indexOf(name));
  if (columns.includes(-1)) return;
  const lines = rows.slice(1).map((row) => {
    const cells = row.split(",");
    return columns.map((c) => Number(cells[c]));
  });
  const low = [0, 1].map((i) => lines.reduce((m, l) => Math.min(m, l[i], l[i + 2]), Infinity)),
        high = [0, 1].map((i) => lines.reduce((m, l) => Math.max(m, l[i], l[i + 2]), -Infinity));
  const scale = 1000 / (high[0] - low[0] || 1), canvas = el("canvas", {
                                                  class: "shot",
                                                  width: 1020,
                                                  height: Math.round((high[1] - low[1]) * scale) + 20,
                                                  role: "img",
                                                  "aria-label": t("path")
                                                });
  const slider = el("input", {type: "range", min: 0, max: lines.length, value: lines.length, "aria-label": t("path")}),
        words = el("p", {class: "soft small"}), draw = canvas.getContext("2d");
  const show = () => {
    draw.clearRect(0, 0, canvas.width, canvas.height);
    const part = (from, to, color) => {
      draw.strokeStyle = color;
      draw.beginPath();
      for (const [x0, y0, x1, y1] of lines.slice(from, to)) {
        draw.moveTo(10 + (x0 - low[0]) * scale, canvas.height - 10 - (y0 - low[1]) * scale);
        draw.lineTo(10 + (x1 - low[0]) * scale, canvas.height - 10 - (y1 - low[1]) * scale);
      }
      draw.stroke();
    };
    const n = Number(slider.value);
    part(0, Math.max(0, n - 40), "#8f8a80"), part(Math.max(0, n - 40), n, "#ffc46b");
    words.textContent = t("pathHint", {n, all: lines.length});
  };
  slider.addEventListener("input", show);
  show();
  box.replaceChildren(canvas, slider, words);
}

export function showCarve(root, state, go) {
  const board = newestBoard(state), busy = Boolean(state.work?.running || state.at_work), ready = has(board, "board.gcode");
  lead(
      root, "lead" + ready + board?.name, ready ? t("carveLead") : t("carveNone"),
      ready ? {
        words: t("download"),
        href: fileUrl(board.name + "/board.gcode") + "?save=1",
        download: `${state.name}-${board.name}.gcode`
      } :
              {words: t("toDesign"), action: () => go("design")},
      ready ? t("carveMore") : null);
  if (!ready) return;
  const sealed = board.photos.length > 0;
  const errors = (state.work?.events || []).filter((event) => event.event === "diagnostic" && event.severity === "error");
  fill(
      part(root, "errors"), JSON.stringify([errors, sealed]),
      () => [errors.length ? findings(errors) : null, sealed ? el("p", {class: "good"}, t("sealed")) : null]);
  const version = state.revision > 0 ? board.files.map((file) => file.bytes).join("-") : "";
  fill(
      part(root, "check"), "check" + version,
      () => has(board, "carve-check.html") ?
          [
            el("h2", {}, t("check")), el("iframe", {
              src: fileUrl(board.name + "/carve-check.html", version),
              class: "short",
              title: t("check"),
              sandbox: "allow-scripts"
            })
          ] :
          []);
  const halves = part(root, "halves", {class: "halves"});
  const project = state.project.files || [];
  fill(part(halves, "files"), JSON.stringify([board.files, project.filter((f) => /tags|sheet|coupon/.test(f)), busy]), () => {
    const item = (path, words) =>
        el("li", {}, el("a", {href: fileUrl(path) + "?save=1", download: path.split("/").at(-1)}, path.split("/").at(-1)),
           el("span", {class: "soft small"}, words));
    const words = {"board-frame.gcode": "frame", "sent.csv": "sentFile", "board.svg": "drawing"};
    const made = (action, label, shown) =>
        (shown ? null : el("button", {disabled: busy, onclick: () => send("/api/do", {action})}, t(label)));
    return el(
        "section", {class: "panel"}, el("h2", {}, t("files")),
        el("ul", {class: "files"},
           board.files.filter((file) => file.name.endsWith(".gcode") || words[file.name])
               .map((file) => item(board.name + "/" + file.name, t(words[file.name] || "gcode"))),
           project.includes("tags.pdf") ? item("tags.pdf", t("tagsPdf")) : null,
           project.includes("sheet.pdf") ? item("sheet.pdf", t("sheetPdf")) : null,
           project.includes("coupon/coupon.gcode") ? item("coupon/coupon.gcode", t("couponFile")) : null),
        el("div", {class: "row"}, made("print", "makeTags", project.includes("tags.pdf")),
           made("sheet", "makeSheet", project.includes("sheet.pdf")),
           made("coupon", "makeCoupon", project.includes("coupon/coupon.gcode"))),
        el("p", {class: "soft small"}, t("resume", {command: `burin toolpath --resume ${board.name}/board.gcode --at-line N`})));
  });
  const path = part(halves, "path");
  fill(path, "path" + version, () => {
    const box = el("div");
    showPath(box, fileUrl(board.name + "/sent.csv", version))
        .catch(() => box.replaceChildren(el("img", {class: "shot", src: fileUrl(board.name + "/board.svg"), alt: t("path")})));
    return el("section", {class: "panel"}, el("h2", {}, t("path")), box);
  });
  fill(part(root, "next", {class: "row"}), "next", () => [el("button", {onclick: () => go("look")}, t("toLook"))]);
}
