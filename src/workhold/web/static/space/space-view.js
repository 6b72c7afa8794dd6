/**
 * Bodies in three dimensions on a canvas, drawn by the graphics card, or by what stands in for one.
 */
import { edgesOf } from "./edges.js";
import { FIELD, Orbit } from "./orbit.js";
import * as THREE from "./three.module.min.js";

/** A view of bodies with WebGL. */
export class SpaceView extends Orbit {
  /**
   * @param {HTMLCanvasElement} canvas
   * @param {WebGL2RenderingContext} context of the canvas
   */
  constructor(canvas, context) {
    super(canvas);
    this.renderer = new THREE.WebGLRenderer({ canvas, context, antialias: true, alpha: true });
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(FIELD, 1, 0.001, 100);
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x8a8f99, 2.2), this.camera);
    const lamp = new THREE.DirectionalLight(0xffffff, 1.6);
    lamp.position.set(-0.4, 0.8, 0.6);
    this.camera.add(lamp);
    this.group = new THREE.Group();
    this.scene.add(this.group);
    /** @type {{mesh: any, opens: number[]|null}[]} */
    this.shown = [];
    this.opened = 0;
  }

  /**
   * Show other bodies, seen whole.
   * @param {import("./glb-reading.js").Body[]} bodies
   * @param {boolean} [still] whether they are opened and looked at as those before
   */
  show(bodies, still = false) {
    const by = still ? this.opened : 0;
    this.clear();
    for (const body of bodies) {
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", new THREE.BufferAttribute(body.positions, 3));
      geometry.setAttribute("normal", new THREE.BufferAttribute(body.normals, 3));
      geometry.setIndex(new THREE.BufferAttribute(body.triangles, 1));
      const [red, green, blue] = body.colour;
      const material = new THREE.MeshLambertMaterial({ polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 });
      material.color.setRGB(red, green, blue);
      if (body.colours) {
        geometry.setAttribute("color", new THREE.BufferAttribute(body.colours, 3));
        material.vertexColors = true;
      }
      const mesh = new THREE.Mesh(geometry, material);
      const edges = new THREE.BufferGeometry();
      edges.setAttribute("position", new THREE.BufferAttribute(edgesOf(body), 3));
      mesh.add(new THREE.LineSegments(edges, new THREE.LineBasicMaterial({ color: 0x20242c, transparent: true, opacity: 0.55 })));
      mesh.name = body.name;
      this.group.add(mesh);
      this.shown.push({ mesh, opens: body.opens });
    }
    this.open(by);
    this.frame(bodies, still);
  }

  /** Take away all bodies and what the graphics card holds of them. */
  clear() {
    for (const { mesh } of this.shown) {
      mesh.traverse((one) => {
        one.geometry.dispose();
        one.material.dispose();
      });
    }
    this.group.clear();
    this.shown = [];
    this.draw();
  }

  /** Open what moves by a length in metres. */
  open(by) {
    this.opened = by;
    for (const { mesh, opens } of this.shown) {
      if (opens) mesh.position.set(opens[0] * by, opens[1] * by, opens[2] * by);
    }
    this.draw();
  }

  /** The number of the body at a place of the canvas, see Orbit. */
  bodyAt(x, y) {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const caster = new THREE.Raycaster();
    caster.setFromCamera(new THREE.Vector2((2 * x) / width - 1, 1 - (2 * y) / height), this.camera);
    const [hit] = caster.intersectObjects(this.shown.map(({ mesh }) => mesh), false);
    return hit ? this.shown.findIndex(({ mesh }) => mesh === hit.object) : null;
  }

  /** Draw now. */
  render() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!width || !height) return;
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.near = Math.max(1e-4, this.far - 2 * this.size);
    this.camera.far = this.far + 2 * this.size;
    this.camera.updateProjectionMatrix();
    const way = this.axes()[2];
    const target = new THREE.Vector3(...this.target);
    this.camera.position.copy(target).addScaledVector(new THREE.Vector3(...way), this.far);
    this.camera.lookAt(target);
    this.renderer.render(this.scene, this.camera);
  }
}
