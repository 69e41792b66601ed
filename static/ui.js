// What the page's document runs beside Gradio: a key that starts a run, and menus that close by themselves.
// Gradio takes Enter in a prompt; this adds Ctrl+Enter and Cmd+Enter.
document.addEventListener("keydown", (event) => {
  if (event.key !== "Enter" || !(event.ctrlKey || event.metaKey)) return;
  const ask = event.target.closest?.(".pd-ask:has(textarea:focus)");
  if (!ask) return;
  event.preventDefault();
  ask.querySelector("button.pd-run:enabled")?.click();
});
// A press beside an open menu, Escape, or what starts a run in it closes it.
const shut = ({ type, key, target }) => {
  if (type === "keydown" && key !== "Escape") return;
  const starts = type === "click" && target.closest(".pd-menu :is(.pd-chip, [id$=grid-make])");
  if (type === "click" && !starts) return;
  for (const fold of document.querySelectorAll(".pd-menu > .label-wrap.open")) {
    if (type !== "pointerdown" || !fold.parentElement.contains(target)) fold.click();
  }
};
document.addEventListener("click", shut);
document.addEventListener("pointerdown", shut);
document.addEventListener("keydown", shut, { capture: true }); // the player keeps its keys to itself
// A menu under a resting mouse is open until the mouse leaves it; a press in it keeps it open, one on its name shut.
{
  const label = (menu) => menu?.querySelector(":scope > .label-wrap");
  let rested = null; // the menu that the mouse has opened
  let closed = null; // one that stays shut until the mouse has left it
  let soon;
  const rest = (menu) => {
    const open = document.querySelector(".pd-menu > .label-wrap.open");
    if (open && (open !== label(rested) || menu === rested)) return; // it was pressed, or the mouse is on it again
    open?.click();
    rested = menu;
    label(menu)?.click();
  };
  document.addEventListener("pointerover", ({ pointerType, target }) => {
    const menu = pointerType === "mouse" ? target.closest(".pd-menu") : null;
    clearTimeout(soon);
    if (menu !== closed) closed = null;
    if (menu !== closed || !menu) soon = setTimeout(rest, 200, menu);
  });
  document.addEventListener("click", (event) => {
    const menu = event.isTrusted && event.target.closest(".pd-menu");
    if (!menu) return;
    const shuts = label(menu).contains(event.target) && label(menu).classList.contains("open");
    if (shuts && menu === rested) event.stopPropagation();
    else if (shuts) closed = menu;
    rested = null;
  }, { capture: true });
  document.addEventListener("keydown", ({ key }) => {
    if (key === "Escape") [closed, rested] = [rested, null];
  }, { capture: true });
}
