// What a skeleton's joint names say about how to draw it.

// Half the width of the limb about the bone that ends in a joint, metres; the first pattern that matches wins.
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
const SMPL22 = [
  "pelvis", "left_hip", "right_hip", "spine1", "left_knee", "right_knee", "spine2", "left_ankle", "right_ankle", "spine3",
  "left_foot", "right_foot", "neck", "left_collar", "right_collar", "head", "left_shoulder", "right_shoulder",
  "left_elbow", "right_elbow", "left_wrist", "right_wrist",
].join();

const sideOf = (name) => (/left|^l[_A-Z]/.test(name) ? "left" : /right|^r[_A-Z]/.test(name) ? "right" : "middle");
const radiusOf = (name) => (RADII.find(([pattern]) => pattern.test(name.toLowerCase())) || [null, 0.045])[1];
const find = (names, ...patterns) => {
  for (const pattern of patterns) {
    const at = names.findIndex((name) => pattern.test(name.toLowerCase()));
    if (at >= 0) return at;
  }
  return -1;
};

/** Bones, joints and those that the player names, from names and parents. */
export function describe(names, parents) {
  const bones = [];
  parents.forEach((parent, joint) => {
    if (parent < 0) return;
    const fromTrunk = sideOf(names[parent]) === "middle"; // limbs begin at the collar and the hip
    bones.push({ from: parent, to: joint, side: fromTrunk ? "middle" : sideOf(names[joint]), radius: radiusOf(names[joint]) });
  });
  const joints = names.map((name) => ({ side: sideOf(name) }));
  const pelvis = Math.max(find(names, /pelvis|hips$/, /base_of_spine/, /torso/), 0);
  const wrists = names.map((n, i) => (/wrist/.test(n.toLowerCase()) ? i : -1)).filter((i) => i >= 0);
  return {
    wears: names.join() === SMPL22, // whether bodies fit
    bones, joints, pelvis, wrists,
    head: find(names, /^head$/, /head/), neck: find(names, /neck/),
    hips: [find(names, /left_?hip|l_?hip/), find(names, /right_?hip|r_?hip/)],
  };
}
