// tools/studio/pictures.js - Pictures: files for the board; after it is made, how each lies on it.
import {dropZone, el, fileUrl, fill, lead, notice, number, part, send, t, upload} from "./page.js";

let order = [], asked = {board: "", lamp: "", stand: "", machine: "", camera: ""};

function showStaged(root, state) {
  const names = state.project.pictures, working = state.work?.running;
  order = [...order.filter((name) => names.includes(name)), ...names.filter((name) => !order.includes(name))];
  lead(
      root, "lead" + names.length + working, t("picturesLead"), {
        words: t("make"),
        disabled: !names.length || working,
        action: () => send("/api/do", {action: "new", pictures: order, ...asked})
      },
      working          ? t("making") :
          names.length ? t("picturesMore") :
                         t("needPicture") + " " + t("picturesMore"));
  fill(
      part(root, "drop"), "drop",
      () =>
          [dropZone(
               t("drop"), t("dropHint"), "image/*,.heic,.heif,.exr,.hdr,.tif,.tiff",
               (files) => {
                 const bad = [];
                 upload("/api/picture", files, (_, words, isBad) => {
                   if (isBad) bad.push(words);
                   notice(bad.join(" ") || words);
                 });
               }),
  ]);
  fill(
      part(root, "cards"), order.join("|"),
      () => [el(
          "ul", {class: "cards"},
          order.map(
              (name, index) =>
                  el("li", {class: "card"}, el("img", {src: "/thumb?file=" + encodeURIComponent(name), alt: name}),
                     el("h3", {}, name),
                     el("div", {class: "row"},
                        el("button", {
                          class: "icon",
                          "aria-label": t("earlier") + ": " + name,
                          disabled: index === 0,
                          onclick: () => move(index, -1, root, state)
                        },
                           "←"),
                        el("button", {
                          class: "icon",
                          "aria-label": t("later") + ": " + name,
                          disabled: index === order.length - 1,
                          onclick: () => move(index, 1, root, state)
                        },
                           "→"),
                        el("button", {
                          "aria-label": t("remove") + ": " + name,
                          onclick: () => send("/api/remove?file=" + encodeURIComponent(name))
                        },
                           t("remove"))))))]);
  fill(part(root, "fields"), "fields", () => {
    const field = (key, words, hint) =>
        el("label", {}, el("span", {}, words),
           el("input", {value: asked[key], placeholder: hint, onchange: (event) => (asked[key] = event.target.value.trim())}));
    const choice = (key, words, choices) =>
        el("label", {}, el("span", {}, words),
           el("select", {onchange: (event) => (asked[key] = event.target.value)},
              choices.map(([value, text]) => el("option", {value, selected: value === asked[key]}, text))));
    return [
      el("div", {class: "fields"}, field("board", t("boardSize"), "200x150"),
         choice(
             "lamp", t("lampPlace"),
             [["above", t("lampAbove")], ["left", t("lampLeft")], ["right", t("lampRight")], ["below", t("lampBelow")]]),
         field("stand", t("standAway"), t("automatic") + " (1.2m)"),
         choice(
             "machine", t("machine"),
             [
               ["", "grbl-spring"],
               ...state.machines.split(/, | and | or /)
                   .map((m) => m.trim())
                   .filter((m) => m && m !== "grbl-spring")
                   .map((m) => [m, m])
             ])),
      el("details", {}, el("summary", {}, t("more")), el("div", {class: "fields"}, field("camera", t("camera"), "phone, 50mm")))
    ];
  });
}

function move(index, by, root, state) {
  [order[index], order[index + by]] = [order[index + by], order[index]];
  showStaged(root, state);
}

function targetUrl(view) {
  const {view: name, ...how} = view;
  return `/target?view=${encodeURIComponent(name)}&v=${encodeURIComponent(JSON.stringify(how))}`;
}

function controls(view) {
  const change = (values) => send("/api/edit", {what: "view", view: view.view, ...values});
  const lies = view.fit === "contain" ? "contain" : view.keep || "middle", levels = view.levels || [0, 1];
  const range = (words, value, least, most, step, set) =>
      el("label", {}, el("span", {}, words),
         el("input", {type: "range", min: least, max: most, step, value, onchange: (event) => set(Number(event.target.value))}));
  return el(
      "div", {class: "body"},
      el("label", {}, el("span", {}, t("lies")),
         el("select", {
           onchange: (event) =>
               change(event.target.value === "contain" ? {fit: "contain"} : {fit: "cover", keep: event.target.value})
         },
            [
              ["middle", "fillMiddle"], ["top", "fillTop"], ["bottom", "fillBottom"], ["left", "fillLeft"],
              ["right", "fillRight"], ["contain", "whole"]
            ].map(([value, key]) => el("option", {value, selected: value === lies}, t(key))))),
      el("details", {}, el("summary", {}, t("more")),
         el("div", {class: "body"},
            range(
                t("black") + ` ${number(100 * levels[0], 0)} %`, levels[0], 0, 0.6, 0.02,
                (black) => change({levels: [black, Math.max(levels[1], black + 0.1)]})),
            range(
                t("white") + ` ${number(100 * levels[1], 0)} %`, levels[1], 0.2, 1, 0.02,
                (white) => change({levels: [Math.min(levels[0], white - 0.1), white]})),
            range(t("weight") + ` ${number(view.weight ?? 1)}`, view.weight ?? 1, 0.2, 5, 0.1, (weight) => change({weight})),
            el("label", {}, el("span", {}, t("turn")), el("input", {
                 type: "number",
                 min: -360,
                 max: 360,
                 step: 1,
                 value: Number(view.rotation_deg) || 0,
                 onchange: (event) => change({rotation_deg: Number(event.target.value)})
               })),
            el("div", {class: "row"}, el("button", {onclick: () => paint(view)}, t("paint")),
               view.mask ? el("button", {onclick: () => change({mask: null})}, t("unpaint")) : null))));
}

/** A brush over the picture in its own frame; white counts in the design. */
function paint(view) {
  const picture = el("img", {src: "/thumb?file=" + encodeURIComponent(view.target), alt: view.view}), canvas = el("canvas");
  const size = el("input", {type: "range", min: 2, max: 30, value: 10, "aria-label": t("brush")}),
        frame = el("div", {class: "paint"}, picture, canvas);
  const draw = canvas.getContext("2d");
  picture.addEventListener("load", () => {
    canvas.width = picture.naturalWidth;
    canvas.height = picture.naturalHeight;
  });
  let last = null;
  const at = (event) => {
    const box = canvas.getBoundingClientRect();
    return [((event.clientX - box.left) / box.width) * canvas.width, ((event.clientY - box.top) / box.height) * canvas.height];
  };
  const line = (event) => {
    const now = at(event);
    Object.assign(draw, {strokeStyle: "#ffb347", lineWidth: (size.value / 100) * canvas.width, lineCap: "round"});
    draw.beginPath(), draw.moveTo(...last), draw.lineTo(...now), draw.stroke();
    last = now;
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    last = at(event);
    line(event);
  });
  canvas.addEventListener("pointermove", (event) => last && line(event));
  canvas.addEventListener("pointerup", () => (last = null));
  const save = async () => {
    const mask = document.createElement("canvas");
    [mask.width, mask.height] = [canvas.width, canvas.height];
    const ink = mask.getContext("2d"), pixels = draw.getImageData(0, 0, canvas.width, canvas.height);
    for (let i = 0; i < pixels.data.length; i += 4) {
      const value = pixels.data[i + 3] > 127 ? 255 : 0;
      pixels.data.set([value, value, value, 255], i);
    }
    ink.putImageData(pixels, 0, 0);
    const blob = await new Promise((done) => mask.toBlob(done, "image/png"));
    if (await send("/api/mask?view=" + encodeURIComponent(view.view), blob)) dialog.close();
  };
  const dialog =
      el("dialog", {"aria-label": t("paintTitle"), onclose: () => dialog.remove()}, el("h2", {}, t("paintTitle")),
         el("p", {class: "soft"}, t("paintHint")), frame, el("label", {}, el("span", {}, t("brush")), size),
         el("div", {class: "row"}, el("button", {class: "main", onclick: save}, t("save")),
            el("button", {onclick: () => draw.clearRect(0, 0, canvas.width, canvas.height)}, t("clear")),
            el("button", {onclick: () => dialog.close()}, t("cancel"))));
  document.body.append(dialog);
  dialog.showModal();
}

function showMade(root, state, go) {
  const views = state.project.design?.views || [];
  lead(root, "made", t("madeLead"), {words: t("toPlace"), action: () => go("place")}, t("madeMore"));
  const list = part(root, "views");
  fill(
      list, "list" + views.map((view) => view.view).join("|"),
      () => [el(
          "ul", {class: "cards"},
          views.map(
              (view) =>
                  el("li", {class: "card"}, el("img", {alt: t("onBoard", {view: view.view})}), el("h3", {}, view.view),
                     el("div"))))]);
  views.forEach((view, index) => {
    const card = list.firstChild.children[index], url = targetUrl(view);
    const open = card.querySelector("details")?.open;
    if (card.firstChild.getAttribute("src") !== url) card.firstChild.setAttribute("src", url);
    fill(card.lastChild, JSON.stringify(view), () => [controls(view)]);
    if (open) card.querySelector("details").open = true;
  });
  fill(
      part(root, "undo", {class: "row"}), "undo" + state.project.former,
      () => [state.project.former ? el("button", {onclick: () => send("/api/edit", {what: "undo"})}, t("undo")) : null]);
  const preview = state.project.files?.includes("preview.png") && !(state.project.boards || []).length;
  fill(
      part(root, "preview"), "preview" + preview,
      () => preview ?
          [
            el("h2", {}, t("firstLook")), el("img", {class: "shot", src: fileUrl("preview.png"), alt: t("firstLookAlt")}),
            el("p", {class: "soft small"}, t("firstLookAlt"))
          ] :
          []);
}

export function showPictures(root, state, go) {
  const kind = state.project.made ? "made" : "staged";
  if (root.dataset.kind !== kind)
    [...root.children].filter((child) => child.dataset.part !== "question").forEach((child) => child.remove());
  root.dataset.kind = kind;
  state.project.made ? showMade(root, state, go) : showStaged(root, state);
}
