// Which words of a sentence are whose: it is cut into pieces where its marks begin and end.

import { say } from "../texts.js";

const MOST = 60; // characters of a part that are quoted

/**
 * The pieces of a sentence, in its order.
 *
 * A piece has its `text`; `who`, "", "a", "b" or "ab", by whose acts it is about; `acts`, their ids; and `unread`, the
 * number of the part that was not understood in which it lies, or -1: of parts that lie in each other, the shorter one
 * says which it is. The server counts code points, JavaScript halves.
 */
export function pieces(sentence, acts, unread) {
  const letters = Array.from(sentence);
  const marks = [
    ...acts.map((act) => ({ ...act.words, act })),
    ...unread.map((part, number) => ({ ...part.words, number })),
  ].filter((mark) => mark.stop > mark.start);
  const cuts = new Set([0, letters.length]);
  for (const mark of marks) for (const at of [mark.start, mark.stop]) cuts.add(Math.min(at, letters.length));
  const at = [...cuts].sort((one, other) => one - other);
  return at.slice(1).map((stop, i) => {
    const over = marks.filter((mark) => mark.start < stop && mark.stop > at[i]);
    const own = over.filter((mark) => mark.act).map((mark) => mark.act);
    const [inner] = over.sort((one, other) => one.stop - one.start - (other.stop - other.start));
    return {
      text: letters.slice(at[i], stop).join(""),
      who: ["a", "b"].filter((who) => own.some((act) => act.agents.includes(who))).join(""),
      acts: own.map((act) => act.id),
      unread: inner?.number ?? -1,
    };
  });
}

/** The words of a span, the first sixty characters of them at most. */
export function wordsOf(sentence, span) {
  const words = Array.from(Array.from(sentence).slice(span.start, span.stop).join("").trim());
  return words.length > MOST ? `${words.slice(0, MOST - 1).join("")}…` : words.join("");
}

/** The acts that are offered, by name: those that are known, one for each of the words in which `known` says them. */
export function offers(names, known) {
  const said = names.map((name) => known[name]?.said);
  return names.filter((_, i) => said[i] && said.indexOf(said[i]) === i);
}

/** The people of an act as its chip shows them: "A", "A → B", "A + B". */
export function people(act) {
  const agents = act.agents.map((who) => who.toUpperCase()).join(" + ");
  return act.patient ? `${agents} → ${act.patient.toUpperCase()}` : agents;
}

/** An act as a screen reader says it: "A to B: pats on right shoulder, 2 times". */
export function spoken(act, said) {
  const agents = act.agents.map((who) => who.toUpperCase()).join(say("reading.and"));
  const whom = act.patient ? say("reading.to", { person: act.patient.toUpperCase() }) : "";
  return `${agents}${whom}: ${said.replace(/ ×(\d+)/, (_, count) => say("reading.times", { count }))}`;
}

/** How much was understood. */
export function summary(plan) {
  const parts = plan.unread.length;
  return say("reading.understood", { count: plan.acts.length }) + (parts ? say("reading.parts_not", { count: parts }) : "");
}
