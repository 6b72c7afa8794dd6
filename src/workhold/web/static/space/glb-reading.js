/**
 * Bodies of a GLB file as the server writes them: each node with a mesh of its own, triangles with normals.
 */

/**
 * @typedef {Object} Body
 * @property {string} name
 * @property {string} kind part, peg, clamp, plate, wall or support
 * @property {{most: number, error: number, times: number, warnings: string[]}|null} bent how far clamping bends it at most, in mm, how many times as far it is shown, and warnings
 * @property {number[]|null} opens unit vector along which it moves away when opened
 * @property {number[]} colour red, green and blue from 0 to 1, linear light
 * @property {Float32Array|null} colours of the vertices, as colour
 * @property {Float32Array} positions in metres, y up
 * @property {Float32Array} normals
 * @property {Uint32Array} triangles
 */

const JSON_START = 20;

/**
 * @param {ArrayBuffer} content
 * @returns {Body[]}
 */
export function bodiesOf(content) {
  const size = new DataView(content).getUint32(12, true);
  const told = JSON.parse(new TextDecoder().decode(new Uint8Array(content, JSON_START, size)));
  // Behind the JSON stand the length and the kind of the second chunk.
  const start = JSON_START + size + 8;
  /** @param {number} number of an accessor */
  const values = (number) => {
    const { bufferView, count, type } = told.accessors[number];
    const at = start + told.bufferViews[bufferView].byteOffset;
    return type === "VEC3" ? new Float32Array(content, at, 3 * count) : new Uint32Array(content, at, count);
  };
  return told.nodes
    .filter((node) => node.mesh !== undefined)
    .map((node) => {
      const [{ attributes, indices, material }] = told.meshes[node.mesh].primitives;
      return {
        name: node.name,
        kind: node.extras.kind,
        bent: node.extras.bent ?? null,
        opens: node.extras.opens ?? null,
        colour: told.materials[material].pbrMetallicRoughness.baseColorFactor,
        colours: attributes.COLOR_0 === undefined ? null : values(attributes.COLOR_0),
        positions: values(attributes.POSITION),
        normals: values(attributes.NORMAL),
        triangles: values(indices),
      };
    });
}
