// A person votes: pairs come one after the other, and the keys 1, 2 and = answer (webdemo/server/http/public_pages.py).

import { mount } from "../player/main.js";
import { follow } from "../player/palette.js";
import { say } from "../texts.js";

const NARROW = 640; // pixels: below, the two stand above each other
const SOONEST = 1000; // milliseconds before which nobody has seen a pair: a key that is pressed twice is one answer

const main = document.querySelector(".pst");
const find = (selector) => main.querySelector(selector);
const { here } = main.dataset;
const buttons = [...main.querySelectorAll("[data-answer]")];

follow();

// What the player expects of the component that holds it in the lab's page.
const props = { value: null, busy: say("vote.opening"), progress: null };
const watchers = [];
function show(changes) {
  Object.assign(props, changes);
  for (const changed of watchers) changed();
}

let number = null; // of the pair that is shown

function enable(on) {
  for (const button of buttons) button.disabled = !on;
}

/** Asks the server, and shows the pair that it sends or the end. */
async function go(what) {
  enable(false);
  const said = find(".pst-said");
  try {
    const answer = await fetch(`${here}/${what}`, { method: "POST" }).catch(() => {
      throw new Error(say("vote.unreachable"));
    });
    const reply = await answer.json().catch(() => ({}));
    if (answer.status === 422 && what !== "next") return go("next"); // it is counted, or the pair is gone
    if (!answer.ok) throw new Error(reply.detail || say("vote.silent"));
    said.hidden = true;
    next(reply);
  } catch (error) {
    said.textContent = error.message;
    said.hidden = false;
    show({ busy: "" });
    enable(number !== null);
    find(".pst-stage").hidden = find(".pst-answers").hidden = number === null;
  }
}

function next(reply) {
  const { pair, done, total } = reply;
  number = reply.number;
  find(".pst-stage").hidden = find(".pst-answers").hidden = !pair;
  find(".pst-progress").textContent = pair ? say("vote.pair", { number: done + 1, total }) : say("vote.all_done", { total });
  if (!pair) {
    show({ value: null, busy: "" });
    find(".pst-thanks").textContent = say("vote.thanks");
    find(".pst-thanks").hidden = false;
    return;
  }
  if (innerWidth < NARROW) {
    Object.assign(pair.samples[0], { columns: [""], rows: ["", ""] });
    buttons[0].lastChild.textContent = say("vote.upper");
    buttons[2].lastChild.textContent = say("vote.lower");
  }
  // The same two motions may come again in another place, which must be a motion of its own to the player.
  show({ value: { ...pair, id: `${pair.id} ${number}` }, busy: "" });
  setTimeout(() => enable(true), SOONEST);
}

for (const button of buttons) button.addEventListener("click", () => go(`vote/${number}/${button.dataset.answer}`));
// Before the player, which has other uses for these keys.
addEventListener("keydown", (event) => {
  const button = buttons.find((each) => each.dataset.answer === event.key);
  if (!button || event.ctrlKey || event.metaKey || event.altKey || event.repeat || event.target.matches("select")) return;
  event.preventDefault();
  event.stopPropagation();
  button.click(); // does nothing while it is disabled
}, true);

mount(find(".pst-stage"), props, (names, changed) => watchers.push(changed), null, "");
go("next");
