// tools/studio/phone.js - the phone's page: the next shot with its drawing, its photos as they are, and the judgment.
import {judgedList, nextShot, photoEvents} from "./look.js";
import {el, fill, follow, lead, notice, part, setUpLanguage, t, upload} from "./page.js";

const main = document.getElementById("place");
setUpLanguage(document.getElementById("language"));

follow("/api/shots", () => "", (state) => {
  document.getElementById("name").textContent = state.name;
  document.title = state.name + " – Burin";
  const shot = nextShot(state.judge, state.bench, state.board);
  lead(
      main, "lead" + shot.words + state.measuring, state.measuring ? t("measuring") : t("phoneLead"), null,
      shot.words || t("lookMore"));
  fill(part(main, "take"), state.lamps.join(), () => {
    const lamp = state.lamps.length > 1 ? el("select", {}, state.lamps.map((name) => el("option", {value: name}, name))) : null;
    const input = el("input", {
      type: "file",
      accept: "image/*",
      multiple: true,
      onchange: () => {
        const bad = [];
        upload("/api/photo" + (lamp ? "?lamp=" + encodeURIComponent(lamp.value) : ""), input.files, (_, words, isBad) => {
          if (isBad) bad.push(words);
          notice(bad.join(" ") || words);
        }).then(() => (input.value = ""));
      }
    });
    return [
      lamp ? el("label", {}, el("span", {}, t("whichLamp")), lamp) : null,
      el("label", {class: "main button take"}, t("take"), input)
    ];
  });
  const last = photoEvents(state.judge).at(-1);
  fill(part(main, "drawing", {class: "halves"}), shot.words + JSON.stringify(last?.eye_mm), () => shot.drawings);
  fill(
      part(main, "photos"), JSON.stringify(photoEvents(state.judge)),
      () => [shot.state ? el("p", {class: "soft"}, t("state", {state: shot.state})) : null, judgedList(state.judge)]);
  fill(part(main, "plain"), "plain", () => el("p", {class: "soft small"}, t("plain")));
});
