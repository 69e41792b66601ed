// What a skeleton's joint names say about how to draw it.

// Half the drawn width of the bone that ends in a joint, metres; the first pattern that matches wins.
const RADII = [
  [/head/, 0.045],
  [/neck/, 0.045],
  [/collar/, 0.05],
  [/shoulder/, 0.05],
  [/elbow/, 0.042],
  [/wrist|hand|thumb/, 0.034],
  [/hip/, 0.07],
  [/knee/, 0.062],
  [/ankle/, 0.046],
  [/foot|toe/, 0.036],
  [/spine|torso|chest|pelvis/, 0.08],
];
const HEAD_RADIUS = 0.092;

const sideOf = (name) => (/left|^l[_A-Z]/.test(name) ? "left" : /right|^r[_A-Z]/.test(name) ? "right" : "middle");
const radiusOf = (name) => (RADII.find(([pattern]) => pattern.test(name.toLowerCase())) || [null, 0.045])[1];
const find = (names, ...patterns) => {
  for (const pattern of patterns) {
    const at = names.findIndex((name) => pattern.test(name.toLowerCase()));
    if (at >= 0) return at;
  }
  return -1;
};

/** Bones, joint sizes and the joints that the player names, from names and parents. */
export function describe(names, parents) {
  const bones = [];
  parents.forEach((parent, joint) => {
    if (parent < 0) return;
    const fromTrunk = sideOf(names[parent]) === "middle"; // limbs begin at the collar and the hip
    bones.push({ from: parent, to: joint, side: fromTrunk ? "middle" : sideOf(names[joint]), radius: radiusOf(names[joint]) });
  });
  // A ball as wide as the thickest bone that ends there, or begins there on its side, rounds square ends.
  const joints = names.map((name, joint) => {
    const side = sideOf(name);
    const here = bones.filter((b) => b.to === joint || (b.from === joint && b.side === side));
    return { side, radius: Math.max(0, ...here.map((b) => b.radius)) || radiusOf(name) };
  });
  const pelvis = Math.max(find(names, /pelvis|hips$/, /base_of_spine/, /torso/), 0);
  const wrists = names.map((n, i) => (/wrist/.test(n.toLowerCase()) ? i : -1)).filter((i) => i >= 0);
  return {
    bones, joints, pelvis, wrists, headRadius: HEAD_RADIUS,
    head: find(names, /^head$/, /head/), neck: find(names, /neck/),
    hips: [find(names, /left_?hip|l_?hip/), find(names, /right_?hip|r_?hip/)],
  };
}
