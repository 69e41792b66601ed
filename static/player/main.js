// Entry point: gives an element of the page a player and keeps it in step with its Python side.

import { warmBodies } from "./clothes.js";
import { loadPlotly, loadStyles } from "./loader.js";
import { node } from "./node.js";
import { follow } from "./palette.js";
import { loops, Player } from "./player.js";
import { say } from "../texts.js";

const players = new Set();

/** What tests and curious people look at: the player in view that was made last. */
const hooks = {
  get player() {
    const newest = [...players].reverse();
    return newest.find((player) => player.stage.clientWidth) ?? newest[0] ?? null;
  },
  get count() {
    return players.size;
  },
  get loops() {
    return loops.running;
  },
  get frame() {
    return hooks.player?.frameShown ?? null;
  },
  get playing() {
    return hooks.player?.clock.playing ?? false;
  },
  /** World coordinates (Y up), metres: [person][joint][x, y, z]. */
  get positions() {
    return hooks.player?.pose?.map((points) => points.map(([z, x, y]) => [x, y, z])) ?? null;
  },
};

let early = null; // gives the player of `begin` to the page, once that has a place for it

/** Plays the example of the page that Gradio is given this configuration of, where the page's first player will be. */
export function begin({ components }) {
  const first = components.find(({ props }) => props.elem_id === "player")?.props;
  follow(new URLSearchParams(location.search).get("__theme"));
  if (!first?.value) return;
  warmBodies();
  const place = node("div", "pdd-early");
  place.innerHTML = first.html_template;
  document.body.append(place);
  mount(place, { ...first.props, value: first.value }, (names, sync, become) => {
    early = (element, props, watch) => {
      early = null;
      element.querySelector(".pdd").replaceWith(place.firstElementChild);
      place.remove();
      document.dispatchEvent(new Event("pdd-here"));
      watch(names, sync);
      become(props);
    };
  });
}

/**
 * `element` holds player.html; `props` are the component's, watched by `watch`. `empty` is the key of what is said while
 * there is no motion: on a second line what comes of it.
 * Safe to call again for an element that was hidden and shown.
 */
export async function mount(element, props, watch, trigger, empty = "player.empty") {
  if (early && element.closest("#player")) return early(element, props, watch);
  const root = element.querySelector(".pdd");
  const player = new Player(root);
  root.player = player; // for what stands about it and follows its clock
  document.dispatchEvent(new Event("pdd-here"));
  let shown;
  let covered = false;
  let opening = true;
  const sync = () => {
    const waits = opening && props.value ? say("player.opening") : "";
    player.controls.setBusy(props.busy || waits, props.progress);
    player.cover(Boolean(props.busy));
    const uncovered = covered && !props.busy;
    covered = Boolean(props.busy);
    const id = props.value?.id ?? null;
    // A live stream (stream.js) stands in for the value until that is given anew, be it the same.
    if (player.scene && (id !== shown || (uncovered && player.data?.stream))) {
      shown = id;
      player.load(props.value || null);
    }
  };
  player.controls.setEmptyText(say(empty));
  sync();
  watch(["value", "busy", "progress"], sync, (others) => {
    props = others;
    sync();
  });
  try {
    const styled = loadStyles(new URL("player.css", import.meta.url).href).finally(() => root.classList.add("pdd-styled")); // the empty state is there at once
    const [Plotly] = await Promise.all([loadPlotly(), styled]);
    if (!root.isConnected) return;
    await player.open(Plotly);
  } catch (error) {
    opening = false;
    sync();
    player.controls.setEmptyText(say("player.no_webgl"));
    console.error(error);
    return;
  }
  opening = false;
  players.add(player);
  player.onclose = () => players.delete(player);
  sync(); // the value may have come before the scene was ready, with nothing left for watch to see
}

window.__pasdedeux = hooks;
