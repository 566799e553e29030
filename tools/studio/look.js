// tools/studio/look.js - Look: photos in, each judged at once; the next shot with its drawing; measuring and verdict.
import {dropZone, el, fileUrl, fill, has, lead, newestBoard, notice, number, part, send, t, upload} from "./page.js";
import {drawSetup, setupOf} from "./setup.js";

export const photoEvents = (judge) =>
    (judge?.events || []).filter((event) => event.event === "photo" || event.event === "unreadable");

/** The latest judgment of each photo, newest first. */
export function judgedList(judge) {
  const latest = new Map();
  for (const event of judge?.events || []) {
    if (event.event === "gone") latest.delete(event.photo);
    if (event.event !== "photo" && event.event !== "unreadable") continue;
    latest.delete(event.photo);
    latest.set(event.photo, event);
  }
  return el("ul", {class: "findings"}, [...latest.values()].reverse().map((event) => {
    const faults = event.faults || [{severity: "error", what: event.words}];
    const worst = faults.some((f) => f.severity === "error") ? "error" :
        faults.some((f) => f.severity === "warning")         ? "warning" :
                                                               "good";
    return el(
        "li", {class: worst},
        el("b", {}, (event.photo || "").split("/").at(-1) + (event.shot ? " – " + t("shot", {name: event.shot}) : "")),
        faults.map((fault) => el("span", {}, fault.what + (fault.remedy ? ". " + fault.remedy : ""))));
  }));
}

/** What to take next, in the program's words, and where. */
export function nextShot(judge, bench, board) {
  const events = judge?.events || [], photos = photoEvents(judge), last = photos.at(-1);
  const words = last?.now ?? events.find((event) => event.event === "began")?.words.split("now: ").at(-1).trim() ?? "";
  const wanted = bench ? (bench.views || []).map((view) => view.view).find((name) => words.includes(`"${name}"`)) : null;
  const setup = bench && board ? setupOf(bench, board) : null;
  return {
    words,
    state: last?.state,
    drawings: setup ? [false, true].map((side) => drawSetup(setup, side, {took: last?.eye_mm, wanted})) : []
  };
}

export function showLook(root, state, go) {
  const boards = state.project.boards || [], board = newestBoard(state), carved = has(board, "board.json"),
        busy = Boolean(state.work?.running || state.at_work);
  const photos = board?.photos.length || 0, judge = state.judge;
  lead(
      root, ["lead", carved, photos > 0, busy].join(), carved ? t("lookLead") : t("lookNone"),
      carved ? {words: t("measure"), disabled: !photos || busy, action: () => send("/api/do", {action: "loop"})} :
               {words: t("carve"), action: () => go("carve")},
      carved ? (photos ? t("lookMore") : t("measureNeeds") + " " + t("lookMore")) : null);
  const halves = part(root, "halves", {class: "two"}), left = part(halves, "left"), right = part(halves, "right");
  if (carved) {
    const lamps = [...new Set((state.project.design?.views || []).map((view) => view.light).filter(Boolean))];
    fill(part(left, "drop"), lamps.join(), () => {
      const lamp = lamps.length > 1 ? el("select", {id: "lamp"}, lamps.map((name) => el("option", {value: name}, name))) : null;
      return [
        lamp ? el("label", {}, el("span", {}, t("whichLamp")), lamp) : null,
        dropZone(
            t("dropPhotos"), t("dropPhotosHint"), "image/*,.dng,.cr2,.cr3,.nef,.arw,.raf,.orf,.rw2,.pef,.heic",
            (files) => {
              const bad = [];
              upload("/api/photo" + (lamp ? "?lamp=" + encodeURIComponent(lamp.value) : ""), files, (_, words, isBad) => {
                if (isBad) bad.push(words);
                notice(bad.join(" ") || words);
              });
            },
            true)
      ];
    });
    const shot = nextShot(judge, state.project.bench, state.project.board);
    fill(
        part(left, "next"), shot.words + shot.state + JSON.stringify(photoEvents(judge).at(-1)?.eye_mm),
        () => shot.words ? el("section", {class: "panel"}, el("h2", {}, t("next")), el("p", {}, shot.words),
                              shot.state ? el("p", {class: "soft"}, t("state", {state: shot.state})) : null,
                              el("div", {class: "halves"}, shot.drawings)) :
                           []);
    fill(
        part(right, "photos"), JSON.stringify(photoEvents(judge)) + photos,
        () =>
            el("section", {class: "panel"}, el("h2", {}, `${t("photos")}: ${photos}`),
               photos ? judgedList(judge) : el("p", {class: "soft"}, t("noPhotos"))));
    fill(
        part(right, "phone"), "phone" + state.phone,
        () =>
            el("section", {class: "panel"}, el("h2", {}, t("phone")),
               state.phone ?
                   [
                     el("img", {class: "qr", src: "/qr.svg", alt: state.phone}), el("p", {class: "small"}, t("phoneHint")),
                     el("p", {class: "soft small"}, state.phone)
                   ] :
                   el("p", {class: "soft"}, t("phoneOff"))));
  }
  const measured = boards.filter((one) => has(one, "report.html")), rounds = state.project.rounds?.rounds || [],
        next = state.status?.data?.next;
  const card = (round, view) => el(
      "li", {class: "card"}, el("h3", {}, `${round.round}: ${view.view}`),
      view.promised_db != null ? el("p", {}, t("promised", {v: number(view.promised_db)})) : null,
      view.photographed_db != null ? el("p", {class: "value"}, t("photographed", {v: number(view.photographed_db)})) : null);
  const another = async () => {
    if (await send("/api/do", {action: "loop", another: true})) go("design");
  };
  fill(part(root, "verdict"), JSON.stringify([rounds, measured.map((one) => one.name), next, busy]), () => !measured.length ? [] : [
    el("h2", {}, t("verdict")),
    el("ul", {class: "cards"}, rounds.flatMap((round) => (round.views || []).map((view) => card(round, view)))),
    next ? el("p", {class: "soft"}, next) : null,
    el("div", {class: "row"}, el("button", {disabled: busy, onclick: another}, t("nextBoard"))),
    el("h2", {}, t("report")),
    el("iframe", {
      src: fileUrl(measured.at(-1).name + "/report.html", measured.length),
      title: t("report"),
      sandbox: "allow-scripts",
    })
  ]);
}
