// A person votes: pairs come one after the other, and the keys 1, 2, = and S answer (webdemo/server/http/study_pages.py).

import { language, say, translate } from "../texts.js";

const NARROW = 640; // pixels: below, the two stand above each other
const KEYS = { 1: "1", 2: "2", "=": "=", s: "skip", S: "skip" };

document.documentElement.lang = language;
translate(document);
const main = document.querySelector(".pst");
const find = (selector) => main.querySelector(selector);
const { here, player, plotly } = main.dataset;
const buttons = [...main.querySelectorAll("[data-answer]")];

const dark = matchMedia("(prefers-color-scheme: dark)");
const paint = () => document.body.classList.toggle("dark", dark.matches);
dark.addEventListener("change", paint);
paint();

// What the player expects of the component that holds it in the lab's page.
const props = { value: null, busy: say("vote.opening"), progress: null, live: null };
const watchers = [];
function show(changes) {
  Object.assign(props, changes);
  for (const changed of watchers) changed();
}

let ticket = null;
let timer = 0;

function enable(on) {
  for (const button of buttons) button.disabled = !on;
}

function tell(sentence) {
  find(".pst-said").textContent = sentence;
  find(".pst-said").hidden = !sentence;
}

async function ask(what, body) {
  const answer = await fetch(`${here}/${what}`, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body) });
  const reply = await answer.json().catch(() => ({}));
  if (!answer.ok) throw new Error(reply.detail || say("vote.silent"));
  return reply;
}

/** Asks the server, and shows the pair that it sends or the end. */
async function go(what, body = {}) {
  enable(false);
  clearTimeout(timer);
  try {
    const reply = await ask(what, body);
    tell("");
    reply.pair ? next(reply) : end(reply);
  } catch (error) {
    tell(error.message === "Failed to fetch" ? say("vote.unreachable") : error.message);
    show({ busy: "" });
    enable(ticket !== null);
    find(".pst-stage").hidden = find(".pst-answers").hidden = ticket === null;
  }
}

function next({ pair, ticket: sent, wait, done, total }) {
  ticket = sent;
  find(".pst-progress").textContent = say("vote.pair", { number: done + 1, total });
  const [sample] = pair.samples;
  if (innerWidth < NARROW) {
    Object.assign(sample, { columns: [""], rows: ["", ""] });
    buttons[0].lastChild.textContent = say("vote.upper");
    buttons[2].lastChild.textContent = say("vote.lower");
  }
  // The same two motions may come again in another place, which must be a motion of its own to the player.
  show({ value: { ...pair, id: `${pair.id} ${sent}` }, busy: "" });
  timer = setTimeout(() => enable(true), 1000 * wait + 100);
}

function end({ total, result }) {
  ticket = null;
  show({ value: null, busy: "" });
  find(".pst-stage").hidden = find(".pst-answers").hidden = true;
  find(".pst-progress").textContent = say("vote.all_done", { total });
  find(".pst-end").hidden = false;
  find(".pst-thanks").textContent = say("vote.thanks");
  if (!result) return;
  const share = (value) => `${Math.round(100 * value)} %`;
  for (const each of result.comparisons) {
    const row = find("tbody").insertRow();
    const decided = each.wins + each.losses;
    for (const text of [
      say("vote.against", each), say(each.ties === 1 ? "vote.score_tie" : "vote.score", each),
      decided ? share(each.share) : "–", decided ? say("vote.range", { low: share(each.low), high: share(each.high) }) : "–",
    ]) row.insertCell().textContent = text;
  }
  find("table").hidden = false;
}

function answer(pressed) {
  if (ticket === null || buttons[0].disabled) return;
  go("vote", { ticket, answer: pressed });
}

find(".pst-answers").addEventListener("click", (event) => {
  const button = event.target.closest("[data-answer]");
  if (button) answer(button.dataset.answer);
});
// Before the player, which has other uses for these keys.
addEventListener("keydown", (event) => {
  const pressed = KEYS[event.key];
  if (!pressed || event.ctrlKey || event.metaKey || event.altKey || event.repeat || event.target.matches("select")) return;
  event.preventDefault();
  event.stopPropagation();
  answer(pressed);
}, true);

const { mount } = await import(player);
mount(find(".pst-stage"), props, (names, changed) => watchers.push(changed), { plotly, empty: "" });
go("next");
