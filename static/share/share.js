// A public page (webdemo/ui/public_html.py): plays its motion.

import { mount } from "../player/main.js";
import { follow } from "../player/palette.js";

follow(new URLSearchParams(location.search).get("theme")); // an embedding page may ask for one

const motion = document.getElementById("motion");
if (motion) {
  const props = { value: JSON.parse(motion.textContent), busy: "", progress: null };
  mount(document.querySelector(".psh-stage"), props, () => {}, null, "player.cannot_show");
}
for (const code of document.querySelectorAll(".psh-more textarea")) code.addEventListener("focus", () => code.select());
