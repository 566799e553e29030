// tools/studio/design.js - Design: start and stop the search, its frames as they come, quality over carving time.
import {el, fileUrl, fill, lead, newestBoard, number, part, send, t} from "./page.js";

const wish = {
  time: "",
  count: "",
  "carve-time": "",
  travel: "",
  pixels: "",
  iterations: ""
};
const given = () => Object.fromEntries(Object.entries(wish).filter(([, value]) => value));

function curve(points) {
  const width = 560, height = 260, left = 46, bottom = 34, mean = (p) => p.psnr_db.reduce((a, b) => a + b, 0) / p.psnr_db.length;
  const most = Math.max(...points.map((p) => p.hours)), values = points.map(mean), low = Math.min(...values) - 0.5,
        high = Math.max(...values) + 0.5;
  const x = (p) => left + (p.hours / most) * (width - left - 18),
        y = (p) => height - bottom - ((mean(p) - low) / (high - low)) * (height - bottom - 16);
  const svg = el(
      "svg", {class: "curve", viewBox: `0 0 ${width} ${height}`, role: "group", "aria-label": t("quality")},
      el("line", {x1: left, x2: width, y1: height - bottom, y2: height - bottom}),
      el("text", {x: width - 10, y: height - 8, "text-anchor": "end"}, `${number(most)} ${t("hours")}`),
      el("text", {x: 4, y: y({psnr_db: [high - 0.5]}) + 4}, t("db", {v: number(high - 0.5)})),
      el("path", {d: [...points].sort((a, b) => a.hours - b.hours).map((p, i) => `${i ? "L" : "M"}${x(p)} ${y(p)}`).join("")}));
  const said = el("p", {class: "soft small"}, t("chosen"));
  for (const p of points) {
    const choose = () => {
      wish["carve-time"] = `${Math.ceil(p.hours * 60)}min`;
      said.textContent = t("choosePoint", {h: number(p.hours), db: number(mean(p))}) + " " + t("chosen");
      for (const other of svg.querySelectorAll("circle")) other.classList.toggle("on", other === dot);
    };
    const words = t("choosePoint", {h: number(p.hours), db: number(mean(p))});
    const dot =
        el("circle", {
          cx: x(p),
          cy: y(p),
          r: 8,
          tabindex: 0,
          role: "button",
          "aria-label": words,
          onclick: choose,
          onkeydown: (event) => {
            if (event.key === "Enter" || event.key === " ") {
              event.preventDefault();
              choose();
            }
          }
        },
           el("title", {}, words));
    svg.append(dot);
  }
  return [el("h2", {}, t("quality")), svg, said];
}

const figure = (board, view, key, words) =>
    el("figure", {},
       el("img",
          {class: "shot", src: fileUrl(`${board.name}/design/${view[key]}`, board.report.stamp), alt: `${view.view}, ${words}`}),
       el("figcaption", {}, words));

export function showDesign(root, state, go) {
  const board = newestBoard(state), running = state.work?.running && state.work.action === "loop",
        busy = state.work?.running || state.at_work;
  const ready = board?.files.some((file) => file.name === "board.gcode"), report = board?.report;
  const start = (extra) => send("/api/do", {action: "loop", "carve-curve": true, ...given(), ...extra});
  const stages = state.status?.data?.stages || [], interrupted = stages.some((stage) => stage.condition === "interrupted");
  lead(
      root, ["lead", ready, Boolean(busy), running, state.work?.stopping, interrupted, state.project.made, Boolean(board)].join(),
      t(ready && !busy  ? "designReady" :
            running     ? "designRuns" :
            interrupted ? "designStopped" :
                          "designLead"),
      ready && !busy ?
          {words: t("toCarve"), action: () => go("carve")} :
          running ?
          {words: t(state.work.stopping ? "stopping" : "stop"), disabled: state.work.stopping, action: () => send("/api/stop")} :
          {
            words:
                t(interrupted ? "keepIt" :
                      board   ? "goOn" :
                                "start"),
            disabled: Boolean(busy) || !state.project.made,
            action: () => start(interrupted ? {"allow-stale": true} : {})
          },
      t((ready || interrupted) && !busy ? "readyMore" : "designMore"));
  const two = part(root, "two", {class: "two"}), left = part(two, "left"), right = part(two, "right");
  const live = running && board?.live;
  if (live) {
    const url = fileUrl(board.name + "/design/live.png", board.live);
    fill(left, "live", () => [el("div", {class: "live"}, el("img", {alt: t("searching")}))]);
    const next = new Image();  // the old frame stays until the new one is there
    next.onload = () => {
      const shown = left.querySelector(".live img");
      if (shown) shown.src = url;
    };
    next.src = url;
  } else if (report?.views && !running) {
    fill(
        left, "report" + JSON.stringify(report.views),
        () =>
            [el("ul", {class: "cards"},
                report.views.map(
                    (view) =>
                        el("li", {class: "card"},
                           el("div", {class: "pair"},
                              [["preview", "asDesigned"], ["target", "asWanted"]].map(
                                  ([key, words]) => figure(board, view, key, t(words)))),
                           el("h3", {}, view.view),
                           el("div", {class: "value"}, t("db", {v: number(view.eye_psnr_db ?? view.psnr_db)})),
                           view.achievable ?
                               el("details", {}, el("summary", {class: "small"}, t("asPossible")),
                                  figure(board, view, "achievable", t("db", {v: number(view.achievable_psnr_db ?? 0)}))) :
                               null))),
             el("p", {class: "soft"},
                t("scratchesLine", {n: report.scratches, m: number((report.length_mm?.total || 0) / 1000)}))]);
  } else if (!running && state.project.files?.includes("preview.png")) {
    fill(
        left, "first",
        () =>
            [el("img", {class: "shot", src: fileUrl("preview.png"), alt: t("firstLookAlt")}),
             el("p", {class: "soft small"}, t("firstLook"))]);
  } else if (!left.firstChild || !running) {
    fill(left, "searching", () => [el("div", {class: "live"}, t("searching"))]);
  }
  const points = report?.carving_curve?.points;
  fill(part(right, "settings"), "settings" + Boolean(ready || interrupted), () => {
    const field = (key, words, hint) => el("label", {}, el("span", {}, words), el("input", {
                                             value: wish[key],
                                             placeholder: hint,
                                             id: "wish-" + key,
                                             onchange: (event) => (wish[key] = event.target.value.trim())
                                           }));
    return el(
        "section", {class: "panel"},
        el("label", {}, el("span", {}, t("howLong")),
           el("select", {id: "wish-time", onchange: (event) => (wish.time = event.target.value)},
              [["", "noLimit"], ["1min", "minute"], ["10min", "tenMinutes"], ["1h", "hour"]].map(
                  ([value, key]) => el("option", {value, selected: value === wish.time}, t(key))))),
        el("details", {}, el("summary", {}, t("more")),
           el("div", {class: "fields"}, field("count", t("count"), "12000"), field("carve-time", t("carveTime"), "6h30min"),
              field("travel", t("travel"), "300x180"), field("pixels", t("pixels"), t("automatic")),
              field("iterations", t("iterations"), t("automatic")))),
        ready || interrupted ?
            el("div", {class: "row"}, el("button", {id: "anew", onclick: () => start({force: "design"})}, t("designAgain"))) :
            null);
  });
  fill(
      part(right, "curve"), JSON.stringify(points || []),
      () => points?.length > 1 ? el("section", {class: "panel"}, curve(points)) : []);
  const first = (state.project.boards || [])[0],
        compares = first && first !== board && first.report?.views && report?.views && !running;
  fill(
      part(root, "compare"), compares ? JSON.stringify([first.report.views, report.views]) : "",
      () => compares ?
          el("details", {}, el("summary", {}, t("compare")),
             el("ul", {class: "cards"},
                report.views.map((view) => [first.report.views.find((one) => one.view === view.view), view])
                    .filter(([old]) => old)
                    .map(
                        ([old, view]) =>
                            el("li", {class: "card"},
                               el("div", {class: "pair"}, figure(first, old, "preview", `${t("boardNumber", {n: 1})}: ${t("db", {
                                                                   v: number(old.eye_psnr_db ?? old.psnr_db)
                                                                 })}`),
                                  figure(board, view, "preview", `${t("boardNumber", {
                                           n: state.project.boards.length
                                         })}: ${t("db", {v: number(view.eye_psnr_db ?? view.psnr_db)})}`)),
                               el("h3", {}, view.view))))) :
          []);
  const viewer = state.project.viewer, isNew = report && viewer > report.stamp;  // not of a former design
  fill(
      part(root, "hand"), "hand" + isNew + viewer + Boolean(busy) + Boolean(board),
      () => !board ? [] :
          isNew ?
                     [
                       el("h2", {}, t("inHand")),
                       el("iframe", {src: fileUrl("view.html", viewer), title: t("inHand"), sandbox: "allow-scripts"})
                     ] :
                     el("button", {disabled: Boolean(busy), onclick: () => send("/api/do", {action: "view"})}, t("inHand")));
}
