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

  // ---- whether something runs ----------------------------------------------------------------------

  let running = 0; // Gradio's events that are not answered yet
  const sent = window.fetch.bind(window);
  window.fetch = async (...request) => {
    const address = new URL(request[0]?.url ?? request[0], location.href).pathname;
    const joins = address.endsWith("/queue/join");
    const counts = joins || address.endsWith("/upload");
    running += counts;
    const answer = await sent(...request);
    running -= counts && !(joins && answer.ok);
    if (!address.endsWith("/queue/data") || !answer.body) return answer;
    const text = new TextDecoder();
    let rest = "";
    const counted = new TransformStream({
      transform(part, onwards) {
        const lines = (rest + text.decode(part, { stream: true })).split("\n\n");
        rest = lines.pop();
        running -= lines.filter((line) => line.includes('"process_completed"')).length;
        onwards.enqueue(part);
      },
    });
    return new Response(answer.body.pipeThrough(counted), { status: answer.status, headers: answer.headers });
  };

  const seen = (e) => e.checkVisibility({ visibilityProperty: true });
  const shown = (selector) => [...document.querySelectorAll(selector)].filter(seen);
  const waits = () => running > 0 || shown(".pd-busy, .pd-run:disabled").length > 0;
  const sleep = (milliseconds) => new Promise((done) => setTimeout(done, milliseconds));
  const wrong = () => shown(".pd-error, .toast-body.error, .pdd-error").map((e) => e.textContent.trim());

  async function idle(limit) {
    const until = performance.now() + limit;
    for (let calm = 0; calm < 2; ) {
      await sleep(40);
      calm = waits() ? 0 : calm + 1;
      if (performance.now() > until) throw new Error(`Something runs on: ${running} events, ${shown(".pd-busy, .pd-run:disabled").length} signs.`);
    }
  }

  // ---- using a control as its kind is used ---------------------------------------------------------

  function type(control, value) {
    const kind = control.tagName === "TEXTAREA" ? HTMLTextAreaElement : HTMLInputElement;
    Object.getOwnPropertyDescriptor(kind.prototype, "value").set.call(control, value);
    for (const event of ["input", "change"]) control.dispatchEvent(new Event(event, { bubbles: true }));
  }

  function another(control) {
    const [value, step] = [Number(control.value || control.min || 1), Number(control.step) || 1];
    return String(control.max && value >= Number(control.max) ? value - step : value + step);
  }

  function use(control) {
    const { value } = control;
    if (control.tagName === "SELECT") {
      for (const chosen of [[...control.options].map((option) => option.value).findLast((other) => other !== value), value]) {
        if (chosen !== undefined) control.value = chosen;
        for (const event of ["input", "change"]) control.dispatchEvent(new Event(event, { bubbles: true }));
      }
    } else if (control.matches("textarea, input:not([type=checkbox], [type=radio], [type=button])")) {
      control.focus();
      if (control.type === "date") type(control, "2026-01-02");
      else type(control, ["number", "range"].includes(control.type) ? another(control) : `${value} again`);
      type(control, value);
      control.blur();
    } else if (control.matches("[role=slider], [data-point]")) {
      control.focus();
      for (const key of ["ArrowRight", "ArrowLeft"]) document.activeElement.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true }));
    } else control.click();
  }

  const tour = (window.tour = {
    seen: {},
    used: {},
    wrong: [],
    look() {
      for (const e of document.querySelectorAll(CONTROLS)) if (usable(e)) tour.seen[keyOf(e)] ??= e.outerHTML.slice(0, 160);
    },
    find: (key) => [...document.querySelectorAll(CONTROLS)].find((e) => usable(e) && keyOf(e) === key) ?? null,
    note(after) {
      for (const sentence of wrong()) if (!tour.wrong.some(([, noted]) => noted === sentence)) tour.wrong.push([after, sentence]);
    },
    take() {
      tour.look();
      const found = { seen: tour.seen, used: tour.used, wrong: tour.wrong };
      tour.seen = {};
      tour.used = {};
      tour.wrong = [];
      return found;
    },
    async settle(limit) {
      await idle(limit);
      tour.note("");
      return tour.take();
    },
    // Uses each control as often as told, and waits only where that starts something; gives what only real keys can use.
    async press(keys, times, limit) {
      const left = [];
      for (const key of keys) {
        for (let i = 0; i < times; i++) {
          const control = tour.find(key);
          if (!control) break;
          if (control.matches("input[role=listbox], input[role=combobox]")) {
            left.push(key);
            break;
          }
          use(control);
          await sleep(30);
          if (waits()) await idle(limit);
          tour.note(key);
        }
      }
      return left;
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
