// Small shaders: one for solid things and one for dots. They compile at once even where a processor has to draw.
import { Color, DoubleSide, FrontSide, ShaderMaterial } from "three";

/** Solid objects: lighter on the side towards the eye. Instances may have colours of their own. A sheet is visible from both sides. */
export function solid(opacity = 1, isSheet = false) {
  return new ShaderMaterial({
    side: isSheet ? DoubleSide : FrontSide,
    uniforms: { tint: { value: new Color() }, opacity: { value: opacity } },
    transparent: opacity < 1,
    depthWrite: opacity === 1,
    vertexShader: `
      varying vec3 seen;
      varying vec3 shade;
      uniform vec3 tint;
      void main() {
        mat4 model = modelViewMatrix;
        shade = tint;
        #ifdef USE_INSTANCING
          model = model * instanceMatrix;
        #endif
        #ifdef USE_INSTANCING_COLOR
          shade = instanceColor;
        #endif
        // Instances are stretched along y alone, which leaves the sides of a rod as they are.
        seen = (model * vec4(normal, 0.0)).xyz;
        gl_Position = projectionMatrix * model * vec4(position, 1.0);
      }`,
    fragmentShader: `
      varying vec3 seen;
      varying vec3 shade;
      uniform float opacity;
      void main() {
        gl_FragColor = vec4(shade * (0.7 + 0.3 * abs(normalize(seen).z)), opacity);
      }`,
  });
}

/** Solid objects with flat faces, whose normals are those of the drawn triangles. */
export function faceted(opacity = 1) {
  return new ShaderMaterial({
    side: DoubleSide,
    uniforms: { tint: { value: new Color() }, opacity: { value: opacity } },
    transparent: opacity < 1,
    vertexShader: `
      varying vec3 place;
      void main() {
        // As the veil has it, to the last digit.
        vec4 seen = modelViewMatrix * vec4(position, 1.0);
        place = seen.xyz;
        gl_Position = projectionMatrix * seen;
      }`,
    fragmentShader: `
      varying vec3 place;
      uniform vec3 tint;
      uniform float opacity;
      void main() {
        vec3 normal = normalize(cross(dFdx(place), dFdy(place)));
        gl_FragColor = vec4(tint * (0.55 + 0.35 * abs(normal.z) + 0.1 * normal.y), opacity);
      }`,
  });
}

/** An invisible surface that hides objects behind it: drawn before transparent objects, it leaves only their front. */
export function veil() {
  return new ShaderMaterial({
    side: DoubleSide,
    transparent: true,
    colorWrite: false,
    vertexShader: "void main() { vec4 seen = modelViewMatrix * vec4(position, 1.0); gl_Position = projectionMatrix * seen; }",
    polygonOffset: true,
    polygonOffsetFactor: 1,
    polygonOffsetUnits: 1,
    fragmentShader: "void main() { gl_FragColor = vec4(0.0); }",
  });
}

/** Lines of one colour. */
export function flat() {
  return new ShaderMaterial({
    uniforms: { tint: { value: new Color() } },
    vertexShader: "void main() { gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }",
    fragmentShader: "uniform vec3 tint; void main() { gl_FragColor = vec4(tint, 1.0); }",
  });
}

/** Round dots of a size in metres. */
export function dot(size) {
  return new ShaderMaterial({
    uniforms: { tint: { value: new Color() }, size: { value: size }, height: { value: 600 } },
    transparent: true,
    depthWrite: false,
    vertexShader: `
      uniform float size;
      uniform float height;
      void main() {
        vec4 place = modelViewMatrix * vec4(position, 1.0);
        gl_Position = projectionMatrix * place;
        gl_PointSize = max(size * height * projectionMatrix[1][1] / (-2.0 * place.z), 2.0);
      }`,
    fragmentShader: `
      uniform vec3 tint;
      void main() {
        if (length(gl_PointCoord - 0.5) > 0.5) discard;
        gl_FragColor = vec4(tint, 0.45);
      }`,
  });
}
