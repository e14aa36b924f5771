// The replay in 3-D: robot, objects, goal and the end effector's path. World axes, z up, metres.

import {
  AmbientLight, BufferAttribute, BufferGeometry, Color, ConeGeometry, CylinderGeometry, DirectionalLight,
  Group, HemisphereLight, LineBasicMaterial, LineSegments, Matrix4, Mesh, MeshStandardMaterial, PCFShadowMap, PerspectiveCamera,
  PlaneGeometry, Scene, ShadowMaterial, SphereGeometry, Vector3, WebGLRenderer, type Material,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { Line2 } from 'three/examples/jsm/lines/Line2.js';
import { LineGeometry } from 'three/examples/jsm/lines/LineGeometry.js';
import { LineMaterial } from 'three/examples/jsm/lines/LineMaterial.js';

import { coreOf, type Core } from './distance';
import { placeAt, type MotionJson, type Placed } from './motion';
import type { Part } from './look';
import { quaternion, Robot, type ShapeJson } from './robot';
import { CollisionRows, kMoment, type Body, type CollisionParameters, type Row } from './rows';
import { solid } from './solid';
import type { Trace } from './trace';

interface BodyJson extends ShapeJson { name: string; quaternion?: number[]; motion?: MotionJson }

export interface WorldJson {
  goal: { position: number[]; quaternion: number[]; motion?: MotionJson };
  objects: BodyJson[];
}

export interface Colours {
  background: string; floor: string; grid: string; base: string; arm: string; object: string; moving: string; hit: string; goal: string; path: string; begin: string; ghost: string; wheel: string;
}

/** Lines one metre apart, in pieces of one metre: some drivers drop a long line that begins behind the camera. */
function grid(colour: string): LineSegments {
  const reach = 15;
  const points: number[] = [];
  for (let a = -reach; a <= reach; ++a) {
    for (let b = -reach; b < reach; ++b) points.push(a, b, 0, a, b + 1, 0, b, a, 0, b + 1, a, 0);
  }
  const shape = new BufferGeometry();
  shape.setAttribute('position', new BufferAttribute(Float32Array.from(points), 3));
  return new LineSegments(shape, new LineBasicMaterial({ color: new Color(colour) }));
}

function triad(size: number, solid: boolean): Group {
  const group = new Group();
  const axes: [Vector3, number][] = [[new Vector3(1, 0, 0), 0xd0453c], [new Vector3(0, 1, 0), 0x3d9a50], [new Vector3(0, 0, 1), 0x3b72c9]];
  for (const [axis, colour] of axes) {
    const material = new MeshStandardMaterial({ color: colour, transparent: !solid, opacity: solid ? 1 : 0.6, roughness: 0.6 });
    const rod = new Mesh(new CylinderGeometry(size * 0.045, size * 0.045, size * 0.82, 10), material);
    rod.position.y = size * 0.41;
    const head = new Mesh(new ConeGeometry(size * 0.11, size * 0.2, 14), material);
    head.position.y = size * 0.9;
    const arrow = new Group();
    arrow.add(rod, head);
    arrow.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), axis);
    group.add(arrow);
  }
  return group;
}

/** Another controller in the same world, on the same clock. */
export interface Ghost { robot: Robot; trace: Trace; look: readonly Part[] }

/** What is drawn of a robot and where: its visuals, and shapes of what has none. */
interface Skin { surface: BufferGeometry; link: string; local: Matrix4; colour: string | null }

/** Of links that are rigid to each other one visual is enough: their shapes, and the wheels of a base, are then left out. */
function skins(robot: Robot, look: readonly Part[]): Skin[] {
  const seen = new Set(look.filter((part) => robot.has(part.link)).map((part) => robot.rigid(part.link)));
  const bare = (link: string): boolean => !seen.has(robot.rigid(link));
  return [
    ...look.filter((part) => robot.has(part.link)),
    ...robot.shapes.filter((s) => robot.has(s.link) && bare(s.link)).map(({ link, shape, local }) => ({ surface: solid(shape), link, local, colour: null })),
  ];
}

/** Radius and place of a wheel's centre in base axes. */
function wheelsOf(robot: Robot, look: readonly Part[]): { radius: number; x: number; y: number }[] {
  const { radius, separation, wheelbase = 0 } = robot.wheels ?? {};
  if (radius === undefined || separation === undefined || look.some((part) => robot.has(part.link) && robot.rigid(part.link) === '@base')) return [];
  return (wheelbase > 0 ? [-wheelbase / 2, wheelbase / 2] : [0]).flatMap((x) => [-1, 1].map((side) => ({ radius, x, y: (side * separation) / 2 })));
}

function poseAt(robot: Robot, trace: Trace, t: number): void {
  const at = Math.min(t, trace.end);
  robot.update(trace.at('base_x', at), trace.at('base_y', at), trace.at('base_phi', at), (i) => trace.at(`q${i}`, at));
}

export class ReplayScene {
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(38, 1, 0.05, 200);
  private readonly controls: OrbitControls;
  private content = new Group();
  private robot: Robot | null = null;
  private world: WorldJson | null = null;
  private trace: Trace | null = null;
  private links: { mesh: Mesh; link: string; local: Matrix4 }[] = [];
  private bodies: { mesh: Mesh; name: string; core: Core; start: Placed; motion: MotionJson | undefined }[] = [];
  private rowsOf: CollisionRows | null = null;
  private arrows = new Group();
  /** The collision rows at the time shown, nearest first. */
  rows: Row[] = [];
  private goal = new Group();
  private tip = new Group();
  private past: Line2 | null = null;
  private ghost: Ghost | null = null;
  private ghostPast: Line2 | null = null;
  private ghostLinks: { mesh: Mesh; link: string; local: Matrix4 }[] = [];
  private tolerance = 0;
  private lastBase = new Vector3();
  follow = false;

  constructor(private readonly canvas: HTMLCanvasElement, private colours: Colours, changed: () => void) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: false, powerPreference: 'low-power' });
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.maxPolarAngle = Math.PI / 2 - 0.02;
    this.controls.minDistance = 0.4;
    this.controls.maxDistance = 30;
    this.controls.addEventListener('change', changed);
    // The wheel scrolls the page until the scene has been clicked, and again once the pointer has left it.
    this.controls.enableZoom = false;
    canvas.addEventListener('pointerdown', () => { this.controls.enableZoom = true; });
    canvas.addEventListener('pointerleave', (event) => { if (event.pointerType !== 'touch') this.controls.enableZoom = false; });
    this.scene.add(this.content);
  }

  setColours(colours: Colours): void {
    this.colours = colours;
    if (this.robot !== null && this.world !== null && this.trace !== null) this.build();
  }

  /** `tolerance`: radius around the goal that counts as reached [m]. */
  show(robot: Robot, world: WorldJson, trace: Trace, hit: { link: string; object: string }, collision: CollisionParameters | null, tolerance: number, look: readonly Part[]): void {
    this.robot = robot;
    this.look = look;
    this.ghost = null;
    this.tolerance = tolerance;
    this.rowsOf = collision === null || !trace.has('command0') ? null : new CollisionRows(robot, collision);
    this.world = world;
    this.trace = trace;
    this.hit = hit;
    this.build();
    this.home();
  }

  /** Shows another motion in the same world too; null takes it away. The view stays. */
  beside(ghost: Ghost | null): void {
    this.ghost = ghost;
    this.build();
  }

  /** Shows the shapes that count in collisions in place of what the robot looks like. The view stays. */
  setShapes(only: boolean): void {
    if (only === this.shapesOnly) return;
    this.shapesOnly = only;
    this.build();
  }

  /** Triangles of the robot as it is shown. */
  triangles(): number {
    return this.links.reduce((sum, { mesh }) => sum + (mesh.geometry.index?.count ?? mesh.geometry.getAttribute('position').count) / 3, 0);
  }

  private look: readonly Part[] = [];
  private shapesOnly = false;
  private hit = { link: '', object: '' };

  private material(colour: string, more: Partial<MeshStandardMaterial> = {}): MeshStandardMaterial {
    const material = new MeshStandardMaterial({ color: new Color(colour), roughness: 0.62, metalness: 0.05 });
    return Object.assign(material, more);
  }

  private build(): void {
    const { robot, world, trace, colours } = this;
    if (robot === null || world === null || trace === null) return;
    this.dispose(this.content);
    this.scene.remove(this.content);
    this.content = new Group();
    this.scene.add(this.content);
    this.scene.background = new Color(colours.background);
    const sun = new DirectionalLight(0xffffff, 2.1);
    sun.position.set(3, -4, 8);
    sun.castShadow = true;
    sun.shadow.mapSize.set(2048, 2048);
    Object.assign(sun.shadow.camera, { left: -6, right: 6, top: 6, bottom: -6, near: 1, far: 25 });
    sun.shadow.normalBias = 0.02;
    this.content.add(new AmbientLight(0xffffff, 0.55), new HemisphereLight(0xffffff, 0x8a8a90, 0.9), sun);
    const floor = new Mesh(new PlaneGeometry(60, 60), new MeshStandardMaterial({ color: new Color(colours.floor), roughness: 1 }));
    floor.position.z = -0.004;
    const shade = new Mesh(new PlaneGeometry(60, 60), new ShadowMaterial({ opacity: 0.2 }));
    shade.receiveShadow = true;
    shade.position.z = -0.002;
    this.content.add(floor, shade, grid(colours.grid));

    const touched = (link: string): boolean => this.hit.link === link || this.hit.object === `self:${link}`;
    const look = this.shapesOnly ? [] : this.look;
    const hitBody = new Set(robot.shapes.map((s) => s.link).filter(touched).map((link) => robot.rigid(link)));
    this.links = skins(robot, look).map(({ surface, link, local, colour: own }) => {
      const hit = look.length > 0 ? hitBody.has(robot.rigid(link)) : touched(link);
      const colour = hit ? colours.hit : own ?? (link === '@base' ? colours.base : colours.arm);
      const mesh = new Mesh(surface, this.material(colour));
      mesh.matrixAutoUpdate = false;
      mesh.castShadow = true;
      this.content.add(mesh);
      return { mesh, link, local };
    });
    this.bodies = world.objects.map((body) => {
      const moving = body.motion !== undefined && body.motion.kind !== 'static';
      const hit = this.hit.object === body.name;
      const mesh = new Mesh(solid(body), this.material(hit ? colours.hit : moving ? colours.moving : colours.object, { transparent: true, opacity: 0.88 }));
      mesh.castShadow = true;
      this.content.add(mesh);
      const [x = 0, y = 0, z = 0] = body.position ?? [];
      return { mesh, name: body.name, core: coreOf(body), start: { position: new Vector3(x, y, z), turn: quaternion(body.quaternion) }, motion: body.motion };
    });

    for (const { radius, x, y } of wheelsOf(robot, look)) {
      const mesh = new Mesh(new CylinderGeometry(radius, radius, 0.05, 28), this.material(colours.wheel));
      mesh.matrixAutoUpdate = false;
      mesh.castShadow = true;
      this.content.add(mesh);
      this.links.push({ mesh, link: '@base', local: new Matrix4().makeTranslation(x, y, radius) });
    }
    this.addGhost();
    this.addGoal(robot);
    this.tip = triad(0.16, false);
    this.arrows = new Group();
    this.content.add(this.tip, this.arrows);
    this.past = this.addPath(robot, trace, colours.begin, colours.path);
  }

  private addGhost(): void {
    this.ghostLinks = [];
    this.ghostPast = null;
    const { ghost, colours } = this;
    if (ghost === null) return;
    this.ghostLinks = skins(ghost.robot, this.shapesOnly ? [] : ghost.look).map(({ surface, link, local }) => {
      const mesh = new Mesh(surface, this.material(colours.ghost, { transparent: true, opacity: 0.38, depthWrite: false }));
      mesh.matrixAutoUpdate = false;
      this.content.add(mesh);
      return { mesh, link, local };
    });
    this.ghostPast = this.addPath(ghost.robot, ghost.trace, colours.ghost, colours.ghost);
  }

  /** Axes, a ball as large as the tolerance, and the hand as it has to arrive. */
  private addGoal(robot: Robot): void {
    const { colours } = this;
    this.goal = triad(0.26, true);
    this.goal.add(new Mesh(new SphereGeometry(Math.max(this.tolerance, 0.008), 24, 16), this.material(colours.goal, { transparent: true, opacity: 0.75 })));
    poseAt(robot, this.trace as Trace, 0);
    const toTip = robot.tipPose(new Matrix4()).invert();
    for (const { surface, link, local } of skins(robot, this.shapesOnly ? [] : this.look)) {
      if (!robot.inHand(link)) continue;
      const mesh = new Mesh(surface, this.material(colours.goal, { transparent: true, opacity: 0.24, depthWrite: false }));
      mesh.matrixAutoUpdate = false;
      mesh.matrix.copy(toTip).multiply(robot.pose(link)).multiply(local);
      this.goal.add(mesh);
    }
    this.content.add(this.goal);
  }

  /** Path of an end effector, coloured from its begin to its end: all of it faint, what has been travelled bold. */
  private addPath(robot: Robot, trace: Trace, begin: string, end: string): Line2 {
    const points = new Float32Array(3 * trace.n);
    const shades = new Float32Array(3 * trace.n);
    const pose = new Matrix4();
    const [from, to] = [new Color(begin), new Color(end)];
    for (let i = 0; i < trace.n; ++i) {
      poseAt(robot, trace, trace.t[i] ?? 0);
      robot.tipPose(pose);
      points.set([pose.elements[12] ?? 0, pose.elements[13] ?? 0, pose.elements[14] ?? 0], 3 * i);
      const shade = from.clone().lerp(to, trace.end > 0 ? (trace.t[i] ?? 0) / trace.end : 0);
      shades.set([shade.r, shade.g, shade.b], 3 * i);
    }
    const line = (opacity: number, linewidth: number): Line2 => {
      const out = new Line2(new LineGeometry().setPositions(points).setColors(shades), new LineMaterial({ vertexColors: true, transparent: true, opacity, linewidth }));
      out.frustumCulled = false;
      return out;
    };
    const past = line(1, 3);
    this.content.add(line(0.45, 1.5), past);
    return past;
  }

  /** Moves everything to time t. */
  set(t: number): void {
    const { robot, trace, world } = this;
    if (robot === null || trace === null || world === null) return;
    if (this.ghost !== null) {
      poseAt(this.ghost.robot, this.ghost.trace, t);
      for (const { mesh, link, local } of this.ghostLinks) mesh.matrix.multiplyMatrices(this.ghost.robot.pose(link), local);
      if (this.ghostPast !== null) this.ghostPast.geometry.instanceCount = this.ghost.trace.locate(t)[0];
    }
    poseAt(robot, trace, t);
    for (const { mesh, link, local } of this.links) mesh.matrix.multiplyMatrices(robot.pose(link), local);
    for (const { mesh, start, motion } of this.bodies) {
      const now = placeAt(motion, start, t);
      mesh.position.copy(now.position);
      mesh.quaternion.copy(now.turn);
    }
    const [x = 0, y = 0, z = 0] = world.goal.position;
    const goal = placeAt(world.goal.motion, { position: new Vector3(x, y, z), turn: quaternion(world.goal.quaternion) }, t);
    this.goal.position.copy(goal.position);
    this.goal.quaternion.copy(goal.turn);
    const tip = robot.tipPose(new Matrix4());
    tip.decompose(this.tip.position, this.tip.quaternion, this.tip.scale);
    if (this.past !== null) this.past.geometry.instanceCount = trace.locate(t)[0];   // pieces between samples
    this.setArrows(t);
    const base = new Vector3().setFromMatrixPosition(robot.pose('@base'));
    if (this.follow) {
      const step = base.clone().sub(this.lastBase);
      this.camera.position.add(step);
      this.controls.target.add(step);
    }
    this.lastBase.copy(base);
  }

  /** Collision rows as arrows from the robot to what it must not touch; those that hold the command back bold. */
  private setArrows(t: number): void {
    this.dispose(this.arrows);
    this.arrows.clear();
    this.rows = [];
    const { trace, rowsOf } = this;
    if (trace === null || rowsOf === null) return;
    const place = (p: Placed): Matrix4 => new Matrix4().compose(p.position, p.turn, new Vector3(1, 1, 1));
    const bodies = this.bodies.map(({ name, core, start, motion }): Body => ({ name, core, now: place(placeAt(motion, start, t)), later: place(placeAt(motion, start, t + kMoment)) }));
    this.rows = rowsOf.at(trace, t, bodies);
    for (const row of this.rows) this.arrows.add(this.arrow(row));
  }

  private arrow({ first, second, active, kind }: Row): Group {
    const group = new Group();
    const along = second.clone().sub(first);
    const length = along.length();
    if (length < 1e-4) return group;
    const thick = active ? 0.008 : kind === 'passing' ? 0.006 : 0.003;
    const head = Math.min(0.5 * length, 5 * thick);
    const material = new MeshStandardMaterial({ color: new Color(active ? this.colours.hit : kind === 'passing' ? this.colours.goal : this.colours.path), transparent: !active, opacity: active ? 1 : 0.45, depthTest: !active });
    const rod = new Mesh(new CylinderGeometry(thick, thick, length - head, 8), material);
    rod.position.y = (length - head) / 2;
    const cone = new Mesh(new ConeGeometry(2.4 * thick, head, 12), material);
    cone.position.y = length - head / 2;
    group.add(rod, cone);
    group.renderOrder = active ? 2 : 1;
    group.position.copy(first);
    group.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), along.divideScalar(length));
    return group;
  }

  /** Where a point is in the picture, in CSS pixels; null behind the camera. */
  project(point: Vector3): [number, number] | null {
    const seen = point.clone().project(this.camera);
    return seen.z > 1 || Math.abs(seen.x) > 1 || Math.abs(seen.y) > 1 ? null
      : [((seen.x + 1) / 2) * this.canvas.clientWidth, ((1 - seen.y) / 2) * this.canvas.clientHeight];
  }

  /** Distance of the shown end effector from the goal: what the stored error says, by another way. */
  positionError(): number {
    return this.tip.position.distanceTo(this.goal.position);
  }

  /** Every tenth of a second: where base, hand and goal are, with some room around them. */
  private extent(): Vector3[] {
    const { world } = this;
    const out: Vector3[] = [];
    const pose = new Matrix4();
    for (const of of [this.robot !== null && this.trace !== null ? { robot: this.robot, trace: this.trace } : null, this.ghost]) {
      if (of === null) continue;
      for (let t = 0; t <= of.trace.end; t += Math.max(0.1, of.trace.end / 60)) {
        poseAt(of.robot, of.trace, t);
        const base = new Vector3().setFromMatrixPosition(of.robot.pose('@base'));
        const hand = new Vector3().setFromMatrixPosition(of.robot.tipPose(pose));
        for (const [x, y] of [[-0.4, -0.4], [-0.4, 0.4], [0.4, -0.4], [0.4, 0.4]] as const) out.push(base.clone().add(new Vector3(x, y, 0)), base.clone().add(new Vector3(x, y, 0.8)));
        out.push(hand.clone().add(new Vector3(0, 0, 0.15)));
      }
    }
    const [x = 0, y = 0, z = 0] = world?.goal.position ?? [];
    out.push(new Vector3(x, y, z + 0.25), new Vector3(x, y, 0));
    return out;
  }

  /** Looks from the side, as near as the whole motion allows. */
  home(): void {
    const { robot, world } = this;
    if (robot === null || world === null) return;
    const points = this.extent();
    this.set(0);
    const [gx = 0, gy = 0] = world.goal.position;
    const along = new Vector3(gx - this.lastBase.x, gy - this.lastBase.y, 0);
    if (along.length() < 1e-6) along.set(1, 0, 0);
    along.normalize();
    const towards = new Vector3(along.y, -along.x, 0).multiplyScalar(0.84).addScaledVector(along, -0.34).add(new Vector3(0, 0, 0.5)).normalize();
    const right = new Vector3(0, 0, 1).cross(towards).normalize();
    const up = towards.clone().cross(right);
    // In the camera's axes: the middle of what is to be seen, then the distance from which all of it is.
    const span = (axis: Vector3): [number, number] => { const values = points.map((p) => p.dot(axis)); return [Math.min(...values), Math.max(...values)]; };
    const [r, u, d] = [span(right), span(up), span(towards)];
    const middle = right.clone().multiplyScalar((r[0] + r[1]) / 2).addScaledVector(up, (u[0] + u[1]) / 2).addScaledVector(towards, (d[0] + d[1]) / 2);
    const tall = Math.tan((this.camera.fov * Math.PI) / 360) * 0.9;
    const wide = tall * this.camera.aspect;
    let away = 0.6;
    // What is near looks larger than what is far: the middle is moved to that of the picture, a few times.
    for (let k = 0; k < 6; ++k) {
      const of = points.map((point) => point.clone().sub(middle)).map((p) => ({ d: p.dot(towards), r: p.dot(right), u: p.dot(up) }));
      away = Math.max(0.6, ...of.map((p) => p.d + Math.max(Math.abs(p.r) / wide, Math.abs(p.u) / tall)));
      const across = (to: 'r' | 'u'): number => {
        const seen = of.map((p) => p[to] / Math.max(0.05, away - p.d));
        return (away * (Math.min(...seen) + Math.max(...seen))) / 2;
      };
      const [x, y] = [across('r'), across('u')];
      middle.addScaledVector(right, x).addScaledVector(up, y);
    }
    this.controls.target.copy(middle);
    this.camera.position.copy(middle).addScaledVector(towards, away);
    this.controls.update();
  }

  render(): void {
    const { clientWidth, clientHeight } = this.canvas;
    const ratio = Math.min(devicePixelRatio, 2);
    if (clientWidth === 0 || clientHeight === 0) return;
    if (this.canvas.width !== Math.floor(clientWidth * ratio) || this.canvas.height !== Math.floor(clientHeight * ratio)) {
      this.renderer.setPixelRatio(ratio);
      this.renderer.setSize(clientWidth, clientHeight, false);
      this.camera.aspect = clientWidth / clientHeight;
      this.camera.updateProjectionMatrix();
    }
    this.renderer.render(this.scene, this.camera);
  }

  private dispose(group: Group): void {
    group.traverse((node) => {
      const mesh = node as Partial<Mesh>;
      mesh.geometry?.dispose();
      const materials = mesh.material === undefined ? [] : Array.isArray(mesh.material) ? mesh.material : [mesh.material];
      for (const material of materials as Material[]) material.dispose();
    });
  }
}

