// A public page (webdemo/ui/public_html.py): plays its motion.

import { mount } from "../player/main.js";

const asked = new URLSearchParams(location.search).get("theme"); // an embedding page may ask for one
const dark = matchMedia("(prefers-color-scheme: dark)");
const paint = () => document.body.classList.toggle("dark", asked === "dark" || (asked !== "light" && dark.matches));
dark.addEventListener("change", paint);
paint();

const motion = document.getElementById("motion");
if (motion) {
  const { plotly, playerStyle } = document.body.dataset;
  const absolute = (path) => new URL(path, document.baseURI).href;
  const props = { value: JSON.parse(motion.textContent), busy: "", progress: null, live: null };
  mount(document.querySelector(".psh-stage"), props, () => {}, {
    plotly: absolute(plotly), styles: absolute(playerStyle), empty: "player.cannot_show",
  });
}
for (const code of document.querySelectorAll(".psh-more textarea")) code.addEventListener("focus", () => code.select());
