/**
 * Bodies in three dimensions on a canvas, turned by mouse, touch and keys. A frame is drawn only when something changed.
 */
import * as THREE from "./three.module.min.js";

/** Radians for each pixel and for each press of a key; how much nearer a press goes. */
const TURN = 0.008;
const STEP = Math.PI / 24;
const NEARER = 1.15;
/** The first look: from the front right, above. */
const FIRST = { around: -0.6, above: 0.75 };
const FIELD = 30;
const HIGHEST = Math.PI / 2 - 0.001;

/** A view of bodies. */
export class SpaceView {
  /**
   * @param {HTMLCanvasElement} canvas
   * @param {WebGL2RenderingContext} context of the canvas
   */
  constructor(canvas, context) {
    this.canvas = canvas;
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
    this.around = FIRST.around;
    this.above = FIRST.above;
    this.size = 1;
    this.far = 1;
    this.target = new THREE.Vector3();
    this.waiting = false;
    this.pointers = new Map();
    this.listen();
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  /**
   * Show other bodies, seen whole.
   * @param {import("./glb-reading.js").Body[]} bodies
   */
  show(bodies) {
    this.clear();
    for (const body of bodies) {
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", new THREE.BufferAttribute(body.positions, 3));
      geometry.setAttribute("normal", new THREE.BufferAttribute(body.normals, 3));
      geometry.setIndex(new THREE.BufferAttribute(body.triangles, 1));
      const [red, green, blue] = body.colour;
      const material = new THREE.MeshLambertMaterial({ polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 });
      material.color.setRGB(red, green, blue);
      const mesh = new THREE.Mesh(geometry, material);
      const edges = new THREE.EdgesGeometry(geometry, 40);
      mesh.add(new THREE.LineSegments(edges, new THREE.LineBasicMaterial({ color: 0x20242c, transparent: true, opacity: 0.55 })));
      mesh.name = body.name;
      this.group.add(mesh);
      this.shown.push({ mesh, opens: body.opens });
    }
    const box = new THREE.Box3().setFromObject(this.group);
    box.getCenter(this.target);
    this.middle = this.target.clone();
    this.size = box.getSize(new THREE.Vector3()).length() || 1;
    this.fit();
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
  }

  /** See everything from where it is seen first. */
  fit() {
    this.look(FIRST.around, FIRST.above);
    this.target.copy(this.middle ?? this.target);
    const narrow = Math.min(1, this.canvas.clientWidth / Math.max(1, this.canvas.clientHeight));
    this.far = (0.5 * this.size) / Math.tan((FIELD * Math.PI) / 360) / narrow;
    this.draw();
  }

  /** Turn the view to angles in radians. */
  look(around, above) {
    this.around = around;
    this.above = Math.max(-HIGHEST, Math.min(HIGHEST, above));
    this.draw();
  }

  /** Open what moves by a length in metres. */
  open(by) {
    for (const { mesh, opens } of this.shown) {
      if (opens) mesh.position.set(opens[0] * by, opens[1] * by, opens[2] * by);
    }
    this.draw();
  }

  /** Go nearer, or farther where the factor is below 1. */
  zoom(factor) {
    this.far = Math.max(0.05 * this.size, Math.min(20 * this.size, this.far / factor));
    this.draw();
  }

  /** Move what is seen by pixels. */
  shift(right, down) {
    const scale = (2 * this.far * Math.tan((FIELD * Math.PI) / 360)) / Math.max(1, this.canvas.clientHeight);
    const x = new THREE.Vector3().setFromMatrixColumn(this.camera.matrix, 0);
    const y = new THREE.Vector3().setFromMatrixColumn(this.camera.matrix, 1);
    this.target.addScaledVector(x, -right * scale).addScaledVector(y, down * scale);
    this.draw();
  }

  /** Draw with the next frame. */
  draw() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.render();
    });
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
    const level = Math.cos(this.above) * this.far;
    const way = new THREE.Vector3(Math.sin(this.around) * level, Math.sin(this.above) * this.far, Math.cos(this.around) * level);
    this.camera.position.copy(this.target).add(way);
    this.camera.lookAt(this.target);
    this.renderer.render(this.scene, this.camera);
  }

  /** Listen to mouse, touch and keys. */
  listen() {
    const { canvas, pointers } = this;
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, [event.clientX, event.clientY]);
    });
    canvas.addEventListener("pointermove", (event) => this.moved(event));
    for (const name of ["pointerup", "pointercancel", "lostpointercapture"]) {
      canvas.addEventListener(name, (event) => pointers.delete(/** @type {PointerEvent} */ (event).pointerId));
    }
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(Math.exp(-Math.sign(event.deltaY) * 0.12));
    }, { passive: false });
    canvas.addEventListener("keydown", (event) => this.pressed(event));
  }

  /** One finger or the mouse turns; two fingers, the right button or Shift move, and two fingers zoom. */
  moved(event) {
    const before = this.pointers.get(event.pointerId);
    if (!before) return;
    const [dx, dy] = [event.clientX - before[0], event.clientY - before[1]];
    const spread = () => {
      const [[ax, ay], [bx, by]] = [...this.pointers.values()];
      return Math.hypot(ax - bx, ay - by);
    };
    const two = this.pointers.size === 2;
    const apart = two ? spread() : 1;
    this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
    if (two) {
      if (apart > 0) this.zoom(spread() / apart);
      this.shift(dx / 2, dy / 2);
    } else if (event.buttons === 2 || event.shiftKey) this.shift(dx, dy);
    else this.look(this.around - dx * TURN, this.above + dy * TURN);
  }

  /** Arrows turn, with Shift they move; plus and minus zoom, 0 shows all. */
  pressed(event) {
    const arrow = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (arrow && event.shiftKey) this.shift(arrow[0] * 40, arrow[1] * 40);
    else if (arrow) this.look(this.around + arrow[0] * STEP, this.above - arrow[1] * STEP);
    else if (event.key === "+" || event.key === "=") this.zoom(NEARER);
    else if (event.key === "-") this.zoom(1 / NEARER);
    else if (event.key === "0") this.fit();
    else return;
    event.preventDefault();
  }
}
