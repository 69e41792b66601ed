// One plotly 3D scene, driven past plotly's own update path.
//
// Plotly.restyle rebuilds every trace and reaches about 16 frames a second. Here the points are written into each
// trace's own line, point and mesh objects, and the scene is asked to redraw. These objects are plotly's inside: they
// are those of the copy in static/plotly, and take() says so where another one lacks them.
//
// Nothing is translucent: one translucent object makes plotly draw the whole scene twice. Skeletons beside bodies are
// drawn a little nearer to the eye instead, over bodies that stay solid.

import { css } from "./palette.js";
import { simplify } from "./shaders.js";

const HALF = 60; // metres; a box this wide around the origin makes scene units metres and clips nothing
const KINDS = {
  ground: "mesh", floor: "lines", bodyA: "mesh", bodyB: "mesh", things: "mesh", ghosts: "lines", paths: "lines",
  bones: "lines", joints: "mesh",
};
const HOLDERS = { lines: "linePlot", mesh: "mesh" }; // plotly's names for the drawing objects
const NOWHERE = [[NaN, NaN, NaN], [NaN, NaN, NaN], [NaN, NaN, NaN]];
const MOVING_RATIO = 1;
const STILL_RATIO = 2;
const LIVE_RATIO = 0.75;

// An axis that is not visible would be named "x", "y" or "z", and plotly would trace each letter's outline, half a second.
const axis = {
  title: { text: "" }, range: [-HALF, HALF], showspikes: false, tickmode: "array", tickvals: [], showticklabels: false,
  showgrid: false, zeroline: false, showline: false, showbackground: false,
};

export class Scene {
  constructor(host, Plotly) {
    this.host = host;
    this.Plotly = Plotly;
    this.layers = new Map();
    this.names = Object.keys(KINDS);
    this.software = softwareGl();
    this.ratio = this.software ? MOVING_RATIO : Math.min(window.devicePixelRatio || 1, 2);
  }

  /** Draws the empty scene. `background` is [r, g, b]. */
  async open(background) {
    const common = { x: [-1, 1, 0], y: [-1, 1, 0], z: [0, 1, 0], hoverinfo: "skip", showlegend: false };
    const color = css(background);
    const make = {
      lines: () => ({ ...common, type: "scatter3d", mode: "lines", line: { width: 4, color } }),
      mesh: () => ({ ...common, type: "mesh3d", i: [0], j: [1], k: [2], color }),
    };
    const traces = this.names.map((name) => ({ name, ...make[KINDS[name]]() }));
    const layout = {
      margin: { l: 0, r: 0, t: 0, b: 0 }, autosize: true, showlegend: false, paper_bgcolor: "rgba(0,0,0,0)",
      uirevision: "kept",
      scene: {
        xaxis: { ...axis }, yaxis: { ...axis }, zaxis: { ...axis }, bgcolor: css(background), hovermode: false,
        dragmode: false, aspectmode: "manual", aspectratio: { x: 2 * HALF, y: 2 * HALF, z: 2 * HALF },
        camera: { eye: { x: 4, y: 4, z: 2 }, center: { x: 0, y: 0, z: 1 }, up: { x: 0, y: 0, z: 1 } },
      },
    };
    const config = {
      displayModeBar: false, responsive: false, scrollZoom: false, doubleClick: false, showTips: false,
      plotGlPixelRatio: this.ratio,
    };
    const restore = this.software ? withoutMultisampling() : null;
    try {
      await this.Plotly.newPlot(this.host, traces, layout, config);
    } finally {
      restore?.();
    }
    this.take();
    for (const name of this.names) this.hide(name);
    return this;
  }

  get inside() {
    return this.host._fullLayout?.scene?._scene;
  }

  /** Takes hold of plotly's objects. */
  take() {
    const scene = this.inside;
    const gl = scene.glplot;
    this.objects = Object.fromEntries(this.names.map((name, index) => {
      const object = scene.traces[this.host._fullData[index].uid]?.[HOLDERS[KINDS[name]]];
      if (!object) throw new Error(`This plotly has no ${HOLDERS[KINDS[name]]}: use the copy in static/plotly.`);
      return [name, object];
    }));
    this.gl = gl;
    this.view ||= new Float64Array(16);
    this.size = [0, 0];
    gl.camera.tick = () => this.tick(gl.camera);
    this.skipPicking(gl);
    for (const name of this.names) if (KINDS[name] === "mesh") simplify(this.objects[name], gl.gl, name === "ground" ? "shaded" : "plain");
    rest(gl);
  }

  /** plotly asks this every frame whether the view changed; the view is ours, see orbit.js. */
  tick(camera) {
    const target = camera.view.computedMatrix;
    const size = [this.host.clientWidth, this.host.clientHeight];
    let changed = size[0] !== this.size[0] || size[1] !== this.size[1];
    this.size = size;
    for (let i = 0; i < 16; i++) {
      changed ||= target[i] !== this.view[i];
      target[i] = this.view[i];
    }
    return changed;
  }

  /** Hover labels are our own; without pick slots plotly draws no hidden picture to find points in. */
  skipPicking(gl) {
    for (const object of gl.objects) object.pickSlots = 0;
    const last = gl.objects[gl.objects.length - 1];
    gl.remove(last); // recounts the slots
    gl.add(last);
  }

  setView(matrix) {
    this.view.set(matrix);
  }

  /**
   * New content for a layer of lines: `points` [x, y, z] each, NaN breaks a line; `colors` one [r, g, b] or one a point;
   * `sizes` in CSS pixels, one or one a point, the width of the segment that starts there. Meshes take theirs by
   * setTriangles().
   */
  set(name, layer) {
    const { points, colors = [0, 0, 0], sizes = 1 } = layer;
    this.layers.set(name, layer);
    const scale = this.inside.dataScale;
    const position = points.map((p) => [p[0] * scale[0], p[1] * scale[1], p[2] * scale[2]]);
    // gl-line3d halves the width it is given
    const lineWidth = Array.isArray(sizes) ? sizes.map((s) => 2 * s) : 2 * sizes;
    this.objects[name].update({ position, color: colors, lineWidth, connectGaps: false });
  }

  /**
   * New content for a mesh: typed arrays with three corners a triangle, `positions` (3 a corner, times the scene's
   * scale), `colors` (4) and, for a picture laid over them, `places` in it (2). Lit already; plotly lights nothing.
   */
  setTriangles(name, layer) {
    this.layers.set(name, layer);
    const { positions, colors, places } = layer;
    const corners = positions.length / 3;
    const mesh = this.objects[name];
    mesh.trianglePositions.update(positions);
    mesh.triangleColors.update(colors);
    if (mesh.triangleCount !== corners / 3) {
      mesh.triangleNormals.update(new Float32Array(3 * corners).fill(1)); // of no use, but none may be nothing
      mesh.triangleUVs.update(places ?? new Float32Array(2 * corners));
      mesh.triangleIds.update(new Uint32Array(corners));
      mesh.triangleCount = corners / 3;
    } else if (places) mesh.triangleUVs.update(places);
    mesh.hasAlpha = false;
    mesh.dirty = true;
  }

  /** Multiplies a picture onto a mesh: `pixels` RGBA, `size` each way. */
  setShade(name, pixels, size) {
    const { texture } = this.objects[name];
    const { gl } = this.gl;
    gl.bindTexture(gl.TEXTURE_2D, texture.handle);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.pixelStorei(gl.UNPACK_FLIP_Y_WEBGL, false);
    if (texture.shaded !== size) {
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, size, size, 0, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
      for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, filter, gl.LINEAR);
      for (const wrap of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, wrap, gl.CLAMP_TO_EDGE);
      texture.shaded = size;
    } else gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, size, size, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  }

  /** What a metre is multiplied by along each axis. */
  get scale() {
    return this.inside?.dataScale ?? [1, 1, 1];
  }

  hide(name) {
    const nothing = { points: NOWHERE, hidden: true };
    if (KINDS[name] === "lines") return this.set(name, nothing);
    this.layers.set(name, nothing);
    Object.assign(this.objects[name], { triangleCount: 0, hasAlpha: false });
  }

  draw() {
    if (this.inside.glplot !== this.gl) this.take(); // plotly made a new one after a lost context
    this.inside.glplot.redraw();
  }

  setBackground(color) {
    this.inside.glplot.setClearColor([...color, 1]);
    this.inside.fullSceneLayout.bgcolor = css(color);
  }

  /** After the box changed its size: plotly draws its own traces anew, so every layer is given again. */
  async resize() {
    await this.Plotly.Plots.resize(this.host);
    if (!this.objects) return;
    for (const [name, layer] of this.layers) {
      if (layer.hidden) this.hide(name);
      else if (layer.positions) this.setTriangles(name, layer);
      else this.set(name, layer);
    }
    this.draw();
  }

  /**
   * Where the processor draws, a picture that stands still is drawn at twice the size for smooth edges,
   * which it could not keep up while moving. One that follows a person `live` is drawn smaller, because finding that
   * person needs the processor too. Says whether that changed anything.
   */
  setStill(still, live = false) {
    const gl = this.inside?.glplot;
    if (!this.software || !gl) return false;
    const moving = live ? LIVE_RATIO : MOVING_RATIO;
    const ratio = still ? STILL_RATIO : moving;
    if (gl.pixelRatio === ratio) return false;
    gl.pixelRatio = ratio;
    return true;
  }

  /** The scene alone as a canvas, whatever its drawing buffer keeps. */
  async picture() {
    const image = new Image();
    image.src = this.inside.toImage("png");
    await image.decode();
    return image;
  }

  close() {
    this.Plotly.purge(this.host);
    this.objects = null;
  }
}

/**
 * Ends plotly's own loop, which asks at every frame of the screen whether anything changed: it costs a tenth of a
 * core for nothing. It runs while `_stopped` is false, so it is only just then when something is asked of it.
 */
function rest(gl) {
  for (const name of ["redraw", "update", "add", "remove", "dispose"]) {
    const act = gl[name];
    gl[name] = (...given) => {
      gl._stopped = false;
      const result = act.apply(gl, given);
      gl._stopped = true;
      return result;
    };
  }
  gl._stopped = true;
}

/**
 * plotly always asks for multisampling, which halves the frame rate where the processor draws.
 * Until the returned function is called, WebGL contexts are made without.
 */
function withoutMultisampling() {
  const original = HTMLCanvasElement.prototype.getContext;
  HTMLCanvasElement.prototype.getContext = function getContext(kind, options) {
    return original.call(this, kind, kind === "webgl" ? { ...options, antialias: false } : options);
  };
  return () => {
    HTMLCanvasElement.prototype.getContext = original;
  };
}

/** Whether WebGL runs on the processor, as on machines without a graphics card and in tests. */
let software = null;
function softwareGl() {
  if (software === null) {
    const gl = document.createElement("canvas").getContext("webgl");
    if (!gl) throw new Error("This browser offers no WebGL");
    const info = gl.getExtension("WEBGL_debug_renderer_info");
    software = /swiftshader|llvmpipe|software|basic render/i.test(info ? gl.getParameter(info.UNMASKED_RENDERER_WEBGL) : "");
    gl.getExtension("WEBGL_lose_context")?.loseContext();
  }
  return software;
}
