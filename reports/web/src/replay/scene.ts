// The replay in 3-D: robot, objects, goal and the end effector's path. World axes, z up, metres.

import {
  AmbientLight, Color, DirectionalLight, Group, HemisphereLight, Matrix4, Mesh, MeshStandardMaterial, PCFShadowMap,
  PerspectiveCamera, PlaneGeometry, Scene, ShadowMaterial, Vector3, WebGLRenderer, type MeshStandardMaterialParameters, type Object3D,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import type { Line2 } from 'three/examples/jsm/lines/Line2.js';

import { palette } from '../theme';
import { fieldMark, floorPath, goalMark, grid, handPath, matt, rowArrow, triad } from './marks';
import { extent, fit } from './fit';
import { poseAt, skins, solid, wheels, type Skin } from './look';
import { gazeAt, kCells, mapMark, pictureAt, type Cells, type SeenMap } from './map';
import { clocksOf, placeAt, vector, type MotionJson, type Placed } from './motion';
import { detourTarget, pathAhead } from './plan';
import { quaternion, Robot, type SensorJson, type ShapeJson } from './robot';
import { carried, type Row } from './rows';
import type { Trace } from './trace';

interface BodyJson extends ShapeJson { name: string; quaternion?: number[]; motion?: MotionJson; yields?: unknown }

interface GoalJson { position: number[]; quaternion: number[]; motion?: MotionJson; stop?: boolean; take?: string; leave?: string }

export interface WorldJson {
  goal?: GoalJson;
  goals?: GoalJson[];   // of several, one after the other
  held?: { object: string };   // in the hand from the start
  objects: BodyJson[];
}

/** When the hand went on from each goal of several [s]: `reached` as the store has them, and a dwell where it stopped. */
export function reachedTimes(reached: string, { goals = [] }: WorldJson, dwell: number): number[] {
  const rows = reached === '' ? [] : JSON.parse(reached) as { time_s: number }[];
  return rows.map(({ time_s }, i) => time_s + (goals[i]?.stop === false ? 0 : dwell));
}

/** A motion of a robot, with what the robot looks like. */
export interface Moved { robot: Robot; trace: Trace; look: readonly Skin[] }

/**
 * A motion in its world: when it went on to the next goal [s], what was hit, the rows of each sample, the controller's map, the
 * radius around the goal that counts as reached [m].
 */
export interface Shown extends Moved { world: WorldJson; reached: readonly number[]; hit: { link: string; object: string }; rows: readonly (readonly Row[])[]; map: SeenMap | null; tolerance: number }

/** An object in the hand from one time to another [s]: its pose in E, and where it is left. */
interface Grip { from: number; to: number; inHand: Matrix4; left: Placed }

interface Body { mesh: Mesh; name: string; start: Placed; motion: MotionJson | undefined; clock: string; grips: Grip[] }   // clock: column with the time of its motion; '': that of the trial

const kWall = 1.8;   // boxes that are higher are seen through [m]
const IN_SCALE = new Vector3(1, 1, 1);

function placed(pose: Matrix4): Placed {
  const place = { position: new Vector3(), turn: quaternion([]) };
  pose.decompose(place.position, place.turn, new Vector3());
  return place;
}

/** Where a body is at time t, with the robot in its pose then. */
function bodyAt({ motion, clock, start, grips }: Body, robot: Robot, trace: Trace, t: number): Placed {
  const grip = grips.filter(({ from }) => t >= from).at(-1);
  if (grip === undefined) return placeAt(motion, start, clock === '' ? t : trace.at(clock, t));
  return t < grip.to ? placed(robot.tipPose(new Matrix4()).multiply(grip.inHand)) : grip.left;
}

/** When the hand held the body called `name`. */
function gripsOf(name: string, start: Placed, { robot, trace, world, reached }: Shown): Grip[] {
  const grips: Grip[] = [];
  const take = (from: number, hand: Matrix4, { position, turn }: Placed): void => {
    grips.push({ from, to: Infinity, inHand: hand.invert().multiply(new Matrix4().compose(position, turn, IN_SCALE)), left: { position, turn } });
  };
  if (world.held?.object === name) {
    poseAt(robot, trace, 0);
    take(0, robot.tipPose(new Matrix4()), start);
  }
  for (const [i, { take: taken, leave }] of (world.goals ?? []).entries()) {
    const time = reached[i];
    if (time === undefined) break;
    if (taken !== name && leave !== name) continue;
    poseAt(robot, trace, time);
    const hand = robot.tipPose(new Matrix4()), last = grips.at(-1);
    if (taken === name) {
      take(time, hand, last?.left ?? start);
    } else if (last !== undefined) {
      last.to = time;
      last.left = placed(hand.multiply(last.inHand));
    }
  }
  return grips;
}

/** What may be left out: boxes of the map, the sensors' fields of view. */
export type Layer = Cells | 'fields';

/** A surface of a robot in the scene. */
interface Drawn { mesh: Mesh; link: string; local: Matrix4 }

/** A robot in the scene, with what its hand has travelled. */
interface Actor extends Moved { links: readonly Drawn[]; past: Line2 }

export class ReplayScene {
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(38, 1, 0.05, 200);
  private readonly controls: OrbitControls;
  private content = new Group();
  /** The picture before, until the new one is drawn. */
  private former: Group | null = null;
  private shown: Shown | null = null;
  private shapesOnly = false;
  private actors: Actor[] = [];   // the shown motion's last
  private bodies: Body[] = [];
  private arrows = new Group();
  private plan = new Group();
  private layers: Record<Layer, Group> = { occupied: new Group(), unseen: new Group(), fields: new Group() };
  private readonly off = new Set<Layer>();
  private fields: { mark: Group; sensor: SensorJson }[] = [];
  /** The picture of the map that is in the scene; -1 if none is. */
  private picture = -1;
  readonly boxes: Record<Cells, number> = { occupied: 0, unseen: 0 };
  /** Line of the base's path or detour at the shown time; empty without one. */
  planned: [number, number][] = [];
  rows: Row[] = [];
  private goals: { mark: Group; start: Placed; motion: MotionJson | undefined }[] = [];
  /** The goal that the hand is on its way to. */
  private goal = new Group();
  private tip = new Group();
  private ghost: Moved | null = null;   // another controller in the same world, on the same clock
  private lastBase = new Vector3();
  follow = false;

  constructor(private readonly canvas: HTMLCanvasElement, changed: () => void) {
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

  show(shown: Shown): void {
    this.shown = shown;
    this.ghost = null;
    this.build();
    this.home();
  }

  /** Shows another motion in the same world too; null takes it away. The view stays. */
  beside(ghost: Moved | null): void {
    this.ghost = ghost;
    this.build();
  }

  /** Shows the shapes that count in collisions in place of what the robot looks like. The view stays. */
  setShapes(only: boolean): void {
    this.shapesOnly = only;
    this.build();
  }

  showLayer(layer: Layer, on: boolean): void {
    if (on) this.off.delete(layer);
    else this.off.add(layer);
    this.layers[layer].visible = on;
  }

  triangles(): number {
    return (this.actors.at(-1)?.links ?? []).reduce((sum, { mesh }) => sum + (mesh.geometry.index?.count ?? mesh.geometry.getAttribute('position').count) / 3, 0);
  }

  /** Puts a surface of a robot into the scene; what is seen through casts no shadow. */
  private draw({ surface, link, local }: Skin, colour: string, more: MeshStandardMaterialParameters = {}): Drawn {
    const mesh = new Mesh(surface, matt(colour, more));
    mesh.matrixAutoUpdate = false;
    mesh.castShadow = more.transparent !== true;
    this.content.add(mesh);
    return { mesh, link, local };
  }

  /** Makes all that is shown anew, in the colours of the page. */
  build(): void {
    const { shown, ghost } = this;
    if (shown === null) return;
    const colours = palette().scene;
    const { robot, world } = shown;
    // Shaders live as long as a material needs them, and take longer to compile than to use: the materials of what was
    // shown go when those of what is shown have been drawn.
    if (this.former === null) this.former = this.content;
    else this.dispose(this.content);
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
    const floor = new Mesh(new PlaneGeometry(60, 60), new MeshStandardMaterial({ color: colours.floor, roughness: 1 }));
    floor.position.z = -0.004;
    const shade = new Mesh(new PlaneGeometry(60, 60), new ShadowMaterial({ opacity: 0.2 }));
    shade.receiveShadow = true;
    shade.position.z = -0.002;
    this.content.add(floor, shade, grid(colours.grid));

    const touched = (link: string): boolean => shown.hit.link === link || shown.hit.object === `self:${link}`;
    const look = this.shapesOnly ? [] : shown.look;
    const hitBody = new Set(robot.shapes.map((s) => s.link).filter(touched).map((link) => robot.rigid(link)));
    const links = skins(robot, look).map((skin) => {
      const hit = look.length > 0 ? hitBody.has(robot.rigid(skin.link)) : touched(skin.link);
      return this.draw(skin, hit ? colours.hit : skin.colour ?? (skin.link === '@base' ? colours.base : colours.arm));
    }).concat(wheels(robot, look).map((wheel) => this.draw(wheel, colours.wheel)));
    const clocks = clocksOf(world.objects);
    this.bodies = world.objects.map((body, i) => {
      const moving = body.motion !== undefined && body.motion.kind !== 'static';
      const hit = shown.hit.object === body.name || shown.hit.link === `carried:${body.name}`;
      // Walls would hide what is in the rooms.
      const wall = body.shape === 'box' && (body.size?.[2] ?? 0) > kWall;
      const glass = { transparent: true, opacity: wall ? 0.15 : 0.88, depthWrite: !wall };
      const mesh = new Mesh(solid(body), matt(hit ? colours.hit : moving ? colours.moving : colours.object, glass));
      mesh.castShadow = !wall;
      this.content.add(mesh);
      const start = { position: vector(body.position), turn: quaternion(body.quaternion) };
      return { mesh, name: body.name, start, motion: body.motion, clock: clocks[i] ?? '', grips: gripsOf(body.name, start, shown) };
    });

    this.actors = [];
    if (ghost !== null) this.add(ghost, skins(ghost.robot, this.shapesOnly ? [] : ghost.look).map((skin) => this.draw(skin, colours.ghost, { transparent: true, opacity: 0.38, depthWrite: false })), colours.ghost, colours.ghost);
    this.goals = (world.goals ?? (world.goal === undefined ? [] : [world.goal])).map(({ position, quaternion: q, motion }) => {
      const mark = goalMark(robot, skins(robot, look), shown.tolerance, colours.goal);
      this.content.add(mark);
      return { mark, start: { position: vector(position), turn: quaternion(q) }, motion };
    });
    this.tip = triad(0.16, false);
    this.arrows = new Group();
    this.plan = new Group();
    this.layers = { occupied: new Group(), unseen: new Group(), fields: new Group() };
    for (const layer of this.off) this.layers[layer].visible = false;
    this.fields = robot.sensors.map((sensor) => ({ mark: fieldMark(sensor, colours.fields), sensor }));
    for (const { mark } of this.fields) this.layers.fields.add(mark);
    this.picture = -1;
    Object.assign(this.boxes, { occupied: 0, unseen: 0 });
    this.content.add(this.tip, this.arrows, this.plan, ...Object.values(this.layers));
    this.add(shown, links, colours.begin, colours.path);
  }

  /** Adds a robot, whose surfaces are drawn, with the path of its hand from one colour to another. */
  private add(moved: Moved, links: readonly Drawn[], begin: string, end: string): void {
    const { all, travelled } = handPath(moved.robot, moved.trace, begin, end);
    this.content.add(all, travelled);
    this.actors.push({ ...moved, links, past: travelled });
  }

  set(t: number): void {
    if (this.shown === null) return;
    const { robot, trace, reached } = this.shown;
    for (const actor of this.actors) {
      poseAt(actor.robot, actor.trace, t);
      for (const { mesh, link, local } of actor.links) mesh.matrix.multiplyMatrices(actor.robot.pose(link), local);
      actor.past.geometry.instanceCount = actor.trace.locate(t)[0];   // pieces between samples
    }
    const put = (what: Object3D, { position, turn }: Placed): void => {
      what.position.copy(position);
      what.quaternion.copy(turn);
    };
    for (const body of this.bodies) put(body.mesh, bodyAt(body, robot, trace, t));
    for (const { mark, start, motion } of this.goals) put(mark, placeAt(motion, start, t));
    this.goal = this.goals[Math.min(reached.filter((time) => time < t).length, this.goals.length - 1)]?.mark ?? this.goal;
    const tip = robot.tipPose(new Matrix4());
    tip.decompose(this.tip.position, this.tip.quaternion, this.tip.scale);
    this.setArrows(this.shown, t);
    this.setMap(this.shown, t);
    for (const [i, { mark, sensor }] of this.fields.entries()) mark.matrix.copy(robot.sensorPose(sensor, gazeAt(this.shown.map, i, t)));
    const base = new Vector3().setFromMatrixPosition(robot.pose('@base'));
    this.setPlan(trace, base, t);
    if (this.follow) {
      const step = base.clone().sub(this.lastBase);
      this.camera.position.add(step);
      this.controls.target.add(step);
    }
    this.lastBase.copy(base);
  }

  /** Collision rows as arrows from the robot to what it must not touch; those that hold the command back bold. */
  private setArrows({ robot, trace, rows: recorded }: Shown, t: number): void {
    const [sample] = trace.locate(t);
    const rows = recorded[sample] ?? [];
    const names = [...new Set(rows.flatMap((row) => [row.link, row.other]))];
    const placesAt = (when: number): Map<string, Matrix4> => {
      poseAt(robot, trace, when);
      return new Map(names.map((name) => [name, this.placeOf(robot, trace, name, when)]));
    };
    const places = { then: placesAt(trace.t[sample] ?? 0), now: placesAt(t) };
    this.rows = carried(rows, (name, when) => places[when].get(name) ?? new Matrix4());
    this.refill(this.arrows, this.rows.map((row) => rowArrow(row, palette().scene)));
  }

  /** Boxes of the map: they stand where the controller has them, by the measured pose of its base. */
  private setMap({ map }: Shown, t: number): void {
    if (map === null) return;
    const picture = pictureAt(map, t);
    if (picture === this.picture) return;
    this.picture = picture;
    for (const cells of kCells) {
      const boxes = map.boxes.filter((box) => box.cells === cells && box.from <= picture && picture < box.to);
      this.refill(this.layers[cells], [mapMark(cells, boxes, palette().scene[cells])]);
      this.boxes[cells] = boxes.length;
    }
  }

  /** Pose of a link or of an object at time t; the floor has the world's axes. */
  private placeOf(robot: Robot, trace: Trace, name: string, t: number): Matrix4 {
    if (robot.has(name)) return robot.pose(name).clone();
    const body = this.bodies.find((one) => one.name === name);
    const { position, turn } = body === undefined ? { position: new Vector3(), turn: quaternion([]) } : bodyAt(body, robot, trace, t);
    return new Matrix4().compose(position, turn, IN_SCALE);
  }

  /** The path that the base follows, from where it should be now; or the straight line to where a detour leads. */
  private setPlan(trace: Trace, { x, y }: Vector3, t: number): void {
    const detour = detourTarget(trace, t);
    this.planned = detour === null ? pathAhead(trace, t) : [[x, y], detour];
    this.refill(this.plan, [floorPath(this.planned, palette().scene.plan)]);
  }

  private refill(group: Group, content: readonly Group[]): void {
    this.dispose(group);
    group.clear();
    for (const part of content) group.add(part);
  }

  /** Projection of a point into the picture [CSS px]; null behind the camera. */
  project(point: Vector3): [number, number] | null {
    const seen = point.clone().project(this.camera);
    return seen.z > 1 || Math.abs(seen.x) > 1 || Math.abs(seen.y) > 1 ? null
      : [((seen.x + 1) / 2) * this.canvas.clientWidth, ((1 - seen.y) / 2) * this.canvas.clientHeight];
  }

  /** Distance of the shown end effector from the goal: what the stored error says, by another way. */
  positionError(): number {
    return this.tip.position.distanceTo(this.goal.position);
  }

  /** Looks from the side, as near as the whole motion allows. */
  home(): void {
    const { shown, ghost } = this;
    if (shown === null) return;
    const { robot, trace } = shown;
    const moved = [...extent(robot, trace), ...(ghost === null ? [] : extent(ghost.robot, ghost.trace))];
    this.set(0);
    const points = [...moved, ...this.goals.flatMap(({ mark: { position: { x, y, z } } }) => [new Vector3(x, y, z + 0.25), new Vector3(x, y, 0)])];
    const { x: gx, y: gy } = this.goals.at(-1)?.mark.position ?? new Vector3();
    const along = new Vector3(gx - this.lastBase.x, gy - this.lastBase.y, 0);
    if (along.length() < 1e-6) along.set(1, 0, 0);
    along.normalize();
    const towards = new Vector3(along.y, -along.x, 0).multiplyScalar(0.84).addScaledVector(along, -0.34).add(new Vector3(0, 0, 0.5)).normalize();
    this.controls.target.copy(fit(this.camera, points, towards));
    this.controls.update();
  }

  /** Makes the picture as large as its canvas; false where that is not seen. */
  resize(): boolean {
    const { clientWidth, clientHeight } = this.canvas;
    const ratio = Math.min(devicePixelRatio, 2);
    if (clientWidth === 0 || clientHeight === 0) return false;
    if (this.canvas.width !== Math.floor(clientWidth * ratio) || this.canvas.height !== Math.floor(clientHeight * ratio)) {
      this.renderer.setPixelRatio(ratio);
      this.renderer.setSize(clientWidth, clientHeight, false);
      this.camera.aspect = clientWidth / clientHeight;
      this.camera.updateProjectionMatrix();
    }
    return true;
  }

  render(): void {
    if (!this.resize()) return;
    this.renderer.render(this.scene, this.camera);
    if (this.former !== null) this.dispose(this.former);
    this.former = null;
  }

  private dispose(group: Group): void {
    group.traverse((node) => {
      if (node instanceof DirectionalLight) node.dispose();   // its map of shadows
      const mesh = node as Partial<Mesh>;
      mesh.geometry?.dispose();
      for (const material of [mesh.material ?? []].flat()) material.dispose();
    });
  }
}

