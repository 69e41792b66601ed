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

export function remove({ plan, beats }, id) {
  return ordered({ ...plan, acts: plan.acts.filter((act) => act.id !== id) }, beats);
}

/** The same act by the other person. */
export function hand({ plan, beats }, id) {
  const acts = plan.acts.map((act) => (act.id !== id ? act : {
    ...act, agents: act.agents.map((who) => OTHER[who]),
    patient: OTHER[act.patient] ?? null, part_of: OTHER[act.part_of] ?? null,
  }));
  return ordered({ ...plan, acts }, beats);
}

/** A new act in the place of a part that was not understood: behind what stands before it in the text. */
export function understand({ plan, beats }, number, entry) {
  const { words } = plan.unread[number];
  const unread = plan.unread.filter((_, other) => other !== number);
  const before = new Set(plan.acts.filter((act) => act.words && act.words.start < words.start).map((act) => act.id));
  const id = String(1 + Math.max(0, ...plan.acts.map((act) => Number(act.id) || 0)));
  const at = beats.findLastIndex((beat) => beat.some((other) => before.has(other))) + 1;
  const more = [...beats];
  more.splice(at, 0, [id]);
  const [agents, patient] = entry.mutual ? [["a", "b"], null] : [["a"], entry.patient ? "b" : null];
  const act = { id, act: entry.name, agents, patient, order: [], words };
  return ordered({ ...plan, unread, acts: [...plan.acts, act] }, more);
}
