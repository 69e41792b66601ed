// Colours (sRGB) and lamps of both themes. What is exported is plain JSON: Python reads it from this file as well
// (motion/looks.py, webdemo/view/theme.py), so that films, contact sheets and models look like the page.
//
// `floor` is the floor at the camera's target, `far` the floor in the distance, `horizon` the sky right above it.
// `people` are the middle, left and right limbs of A's and B's skeletons; `given` those of a motion that is given.
export default {
  "light": {
    "background": "#eef1f6",
    "sky": "#c3d5ec", "horizon": "#f3f7fc", "far": "#d8dce4", "floor": "#efedea",
    "grid": "#d6d8dc", "gridStrong": "#bfc4cc",
    "shade": [0.46, 0.47, 0.52],
    "ghost": "#8e99aa", "ink": "#475569",
    "lamps": {
      "key": [0.94, 0.86, 0.74], "sky": [0.36, 0.41, 0.49], "ground": [0.25, 0.24, 0.23],
      "rim": [0.42, 0.48, 0.58], "shine": 0.05
    },
    "bodies": [
      { "top": "#2f70de", "trousers": "#2b3c60", "shoes": "#23262e", "skin": "#d09a74", "hair": "#30241d", "grey": "#c6c2bc", "eyes": "#2a1c14", "whites": "#eeebe6" },
      { "top": "#ea7d1d", "trousers": "#6a4630", "shoes": "#33231a", "skin": "#dfae8c", "hair": "#7b4a2a", "grey": "#d3cec7", "eyes": "#2a1c14", "whites": "#eeebe6" }
    ],
    "people": [["#2468d8", "#5c9cf5", "#17479e"], ["#e07a10", "#f7a944", "#b25606"]],
    "given": [["#7186ab", "#9fb2d2", "#566a8c"], ["#b09070", "#cdb498", "#8c7053"]],
    "curve": ["#475569", "#94a3b8"]
  },
  "dark": {
    "background": "#141922",
    "sky": "#0d1017", "horizon": "#202938", "far": "#171c25", "floor": "#2a303b",
    "grid": "#353d4a", "gridStrong": "#48525f",
    "shade": [0.26, 0.27, 0.31],
    "ghost": "#667389", "ink": "#cbd5e1",
    "lamps": {
      "key": [0.92, 0.83, 0.71], "sky": [0.27, 0.32, 0.42], "ground": [0.15, 0.15, 0.16],
      "rim": [0.85, 0.98, 1.2], "shine": 0.06
    },
    "bodies": [
      { "top": "#4083f0", "trousers": "#3a4c74", "shoes": "#2c313c", "skin": "#d39d78", "hair": "#3a2c24", "grey": "#c6c2bc", "eyes": "#2a1c14", "whites": "#eeebe6" },
      { "top": "#f58b2b", "trousers": "#7a523a", "shoes": "#42302a", "skin": "#e2b392", "hair": "#87532f", "grey": "#d3cec7", "eyes": "#2a1c14", "whites": "#eeebe6" }
    ],
    "people": [["#4f94f7", "#8fc0ff", "#2f6bd0"], ["#f2933a", "#ffc27a", "#c96a14"]],
    "given": [["#7f92b5", "#a9bad6", "#64769a"], ["#b59a7d", "#d0bba2", "#93795e"]],
    "curve": ["#cbd5e1", "#64748b"]
  }
};
