// Notes which controls of the page can be seen and which were used, by names that outlive a redrawn list.

(() => {
  const CONTROLS = "button, input, textarea, select, summary, [role=slider], [role=button]";
  const MADE = /^(html-|range_id|component-|radio-|checkbox-|id_)/;
  const OURS = /^(pdd|pds|pdn|pdcam|pdlive|pst)-/;
  const clean = (text) => (text || "").trim().replace(/\s+/g, " ").replace(/\d+([.,]\d+)?/g, "#").replace("Copied", "Copy").slice(0, 40);
  const isUpload = (e) => e.type === "file" || e.matches(".upload-container");

  const tabOf = () => document.querySelector("[role=tab][aria-selected=true]")?.textContent.trim() ?? "";

  function scopeOf(control) {
    for (let box = control.closest("[id]"); box; box = box.parentElement?.closest("[id]")) if (!MADE.test(box.id)) return box.id;
    return "";
  }

  function nameOf(e) {
    if (isUpload(e)) return "upload";
    const data = ["act", "camera", "pose", "field", "find", "answer"].map((key) => e.dataset[key] && `${key}=${e.dataset[key]}`).find(Boolean);
    if (data) return data + (e.type === "radio" ? ` ${e.value}` : "");
    if ("point" in e.dataset) return "point";
    for (const kept of ["choose", "save"]) if (kept in e.dataset) return kept;
    const ours = [...e.classList].find((name) => OURS.test(name));
    if (ours && ours !== "pds-selected") return ours + (e.dataset.lane ? ` ${e.dataset.lane}` : "");
    if (e.type === "radio") return `radio ${clean(e.labels?.[0]?.textContent)}`;
    if (e.matches(".label-wrap")) return "fold";
    return clean(e.ariaLabel || e.title || e.textContent || e.placeholder) || e.tagName.toLowerCase();
  }

  const keyOf = (e) => (e.getAttribute("role") === "tab" ? `tabs / ${clean(e.textContent)}` : `${tabOf()} / ${scopeOf(e)} / ${nameOf(e)}`);
  const fixed = (e) => e.disabled || e.type === "file" || (e.readOnly && e.role !== "listbox") || e.closest(".visually-hidden");
  const usable = (e) => !fixed(e) && e.checkVisibility({ visibilityProperty: true, opacityProperty: true });

  const tour = (window.tour = {
    seen: {},
    used: {},
    look() {
      for (const e of document.querySelectorAll(CONTROLS)) if (usable(e)) tour.seen[keyOf(e)] ??= e.outerHTML.slice(0, 160);
    },
    find: (key) => [...document.querySelectorAll(CONTROLS)].find((e) => usable(e) && keyOf(e) === key) ?? null,
    take() {
      tour.look();
      const found = { seen: tour.seen, used: tour.used };
      tour.seen = {};
      tour.used = {};
      return found;
    },
  });
  for (const kind of ["click", "input", "change", "keydown", "pointerdown"]) {
    window.addEventListener(
      kind,
      (event) => {
        const control = event.target.closest?.(CONTROLS);
        if (!control || control.disabled) return;
        const key = keyOf(control);
        tour.used[key] ??= {};
        tour.used[key][kind] = (tour.used[key][kind] ?? 0) + 1;
      },
      true,
    );
  }
  addEventListener("DOMContentLoaded", () => setInterval(tour.look, 400));
})();
