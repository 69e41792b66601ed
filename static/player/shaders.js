// Drawing meshes whose corners are coloured and lit already. plotly's own shaders also compute highlights, clip at the
// axes and look up a picture for every pixel, which takes software two to four times as long.

const CORNER = `
attribute vec3 position;
attribute vec4 color;
attribute vec2 uv;
uniform mat4 model, view, projection;
varying vec4 hue;
varying vec2 place;
void main() {
  hue = color;
  place = uv;
  gl_Position = projection * (view * (model * vec4(position, 1.0)));
}`;
const PIXEL = {
  plain: `
precision mediump float;
varying vec4 hue;
void main() { gl_FragColor = hue; }`,
  shaded: `
precision highp float;
uniform sampler2D picture;
varying vec4 hue;
varying vec2 place;
void main() { gl_FragColor = hue * texture2D(picture, place); }`,
};
const PLACES = { position: 0, color: 2, uv: 3 }; // of gl-mesh3d's buffers

/** A program of one of the kinds of PIXEL. */
function program(gl, kind) {
  const made = gl.createProgram();
  for (const [type, source] of [[gl.VERTEX_SHADER, CORNER], [gl.FRAGMENT_SHADER, PIXEL[kind]]]) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(made, shader);
  }
  for (const [name, place] of Object.entries(PLACES)) gl.bindAttribLocation(made, place, name);
  gl.linkProgram(made);
  return made;
}

/**
 * Draws a mesh's triangles as they are coloured, and for the kind "shaded" multiplied by the picture that Scene.setShade()
 * lays over them.
 */
export function simplify(mesh, gl, kind) {
  const { triShader } = mesh;
  const own = program(gl, kind);
  const at = Object.fromEntries(["model", "view", "projection", "picture"].map((name) => [name, gl.getUniformLocation(own, name)]));
  mesh.triShader = {
    bind: () => gl.useProgram(own),
    set uniforms(values) {
      for (const name of ["model", "view", "projection"]) gl.uniformMatrix4fv(at[name], false, values[name]);
      if (at.picture) gl.uniform1i(at.picture, values.texture);
    },
    dispose: () => {
      triShader.dispose();
      gl.deleteProgram(own);
    },
  };
}
