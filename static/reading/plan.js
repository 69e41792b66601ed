// Edits of a plan by hand. A draft is a plan with its beats, lists of ids; each edit gives a new one.

const OTHER = { a: "b", b: "a" };

/** The acts of a plan in the order of its beats, with the relations that say the same. */
export function ordered(plan, beats) {
  const acts = new Map(plan.acts.map((act) => [act.id, act]));
  const kept = beats.map((beat) => beat.filter((id) => acts.has(id))).filter((beat) => beat.length);
  const listed = kept.flatMap((beat, number) => beat.map((id, place) => {
    const beside = acts.get(id).order.filter(({ kind, act }) => ["while", "until"].includes(kind) && beat.includes(act));
    const order = place ? [{ kind: "with", act: beat[0] }] : number ? [{ kind: "after", act: kept[number - 1][0] }] : [];
    return { ...acts.get(id), order: [...order, ...beside].slice(0, 8) };
  }));
  return { plan: { ...plan, acts: listed, reader: "hand" }, beats: kept };
}

const without = (beats, id) => beats.map((beat) => beat.filter((other) => other !== id)).filter((beat) => beat.length);

export function remove({ plan, beats }, id) {
  const acts = plan.acts.filter((act) => act.id !== id);
  return ordered({ ...plan, acts }, without(beats, id));
}

/** Another act in the place of one; details that were the old one's go with it. `entry` is as in the list of acts. */
export function change({ plan, beats }, id, entry) {
  const acts = plan.acts.map((act) => {
    if (act.id !== id) return act;
    const { agents, order, seconds, times, words } = act;
    return { ...made(entry, agents, act.patient), id, order, seconds, times, words };
  });
  return ordered({ ...plan, acts }, beats);
}

/** The same act by the other person. */
export function hand({ plan, beats }, id) {
  const acts = plan.acts.map((act) => (act.id !== id ? act : {
    ...act, agents: act.agents.map((who) => OTHER[who]),
    patient: OTHER[act.patient] ?? null, part_of: OTHER[act.part_of] ?? null,
  }));
  return ordered({ ...plan, acts }, beats);
}

/** An act a step earlier (-1) or later (1): out of the beat that it shares, into the next one, or past a beat of the same people. */
export function shift(draft, id, by) {
  const { plan, beats } = draft;
  const at = beats.findIndex((beat) => beat.includes(id));
  const next = at + by;
  if (beats[at].length > 1) {
    const left = beats.map((beat) => beat.filter((other) => other !== id));
    left.splice(by < 0 ? at : at + 1, 0, [id]);
    return ordered(plan, left);
  }
  if (next < 0 || next >= beats.length) return draft;
  const agents = (one) => plan.acts.find((act) => act.id === one).agents;
  const busy = beats[next].flatMap(agents);
  const moved = beats.map((beat) => [...beat]);
  if (agents(id).some((who) => busy.includes(who))) [moved[at], moved[next]] = [moved[next], moved[at]];
  else {
    moved[next].push(id);
    moved.splice(at, 1);
  }
  return ordered(plan, moved);
}

/** A new act in a beat of its own: behind the beat of the act `after`, or at the end. */
export function add({ plan, beats }, entry, agents, after = null) {
  const id = freeId(plan);
  const at = beats.findIndex((beat) => beat.includes(after));
  const more = [...beats];
  more.splice(at < 0 ? beats.length : at + 1, 0, [id]);
  return ordered({ ...plan, acts: [...plan.acts, { ...made(entry, agents), id }] }, more);
}

/** A new act in the place of a part that was not understood: behind what stands before it in the text. */
export function understand({ plan, beats }, number, entry) {
  const { words } = plan.unread[number];
  const unread = plan.unread.filter((_, other) => other !== number);
  const before = new Set(plan.acts.filter((act) => act.words && act.words.start < words.start).map((act) => act.id));
  const id = freeId(plan);
  const at = beats.findLastIndex((beat) => beat.some((other) => before.has(other))) + 1;
  const more = [...beats];
  more.splice(at, 0, [id]);
  const act = { ...made(entry, entry.mutual ? ["a", "b"] : ["a"]), id, words };
  return ordered({ ...plan, unread, acts: [...plan.acts, act] }, more);
}

function made(entry, agents, patient = null) {
  const whom = agents.length === 1 && entry.patient ? patient ?? OTHER[agents[0]] : null;
  return { act: entry.name, agents, patient: whom, order: [] };
}

function freeId(plan) {
  const taken = new Set(plan.acts.map((act) => act.id));
  let number = plan.acts.length + 1;
  while (taken.has(`${number}`)) number += 1;
  return `${number}`;
}

/** The acts of the list that have all the words that are sought: the nearest to the beginning of their name first. */
export function search(entries, sought, most = 8) {
  const words = sought.toLowerCase().split(/\s+/).filter(Boolean);
  const found = [];
  for (const entry of entries) {
    const text = `${entry.said} ${entry.name.replaceAll("-", " ")} ${entry.caption}`.toLowerCase();
    const places = words.map((word) => text.indexOf(word));
    if (places.every((place) => place >= 0)) found.push({ entry, rank: Math.max(0, ...places) });
  }
  return found.sort((one, other) => one.rank - other.rank).slice(0, most).map(({ entry }) => entry);
}
