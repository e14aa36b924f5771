// The stored robot: its link tree from the URDF's text, held joints, shapes; and forward kinematics.

import { Euler, Matrix4, Quaternion, Vector3 } from 'three';

interface PoseJson { position?: number[]; rpy?: number[]; rotation?: number[] }

export interface ShapeJson extends PoseJson {
  link?: string; shape: string; size?: number[]; vertices?: (number | number[])[]; triangles?: (number | number[])[];
}

/** Wheels of the base [m]: two, or four with a wheelbase between the axles. */
export interface Wheels { radius?: number; separation?: number; wheelbase?: number; width?: number }

/** Angles of a head: about the z axis of its link, and about the y axis that turns with it [rad]. */
export interface Gaze { pan: number; tilt: number }

/** A depth camera or scanner: rays about the x axis of its frame. On a head it turns about `axes`. */
export interface SensorJson extends PoseJson { name: string; link?: string; field_of_view: number[]; range: number; head?: { axes?: number[] } }

interface RobotJson {
  urdf_text: string;
  base: { mount?: PoseJson; footprint?: ShapeJson; wheels?: Wheels };
  arm: { tip: string; tool?: PoseJson; locked?: Record<string, number>; limits?: Record<string, { lower?: number; upper?: number }>; ready?: number[] };
  collision?: { shapes?: ShapeJson[] };
  sensors?: SensorJson[];
}

type Joint = ReturnType<typeof readJoints>[number];

interface Driven { name: string; lower: number; upper: number }

export function poseMatrix(pose: PoseJson | undefined): Matrix4 {
  const { rotation: r, rpy: [roll = 0, pitch = 0, yaw = 0] = [], position: [x = 0, y = 0, z = 0] = [] } = pose ?? {};
  const matrix = r !== undefined && r.length === 9
    ? new Matrix4().set(r[0]!, r[1]!, r[2]!, 0, r[3]!, r[4]!, r[5]!, 0, r[6]!, r[7]!, r[8]!, 0, 0, 0, 0, 1)
    : new Matrix4().makeRotationFromEuler(new Euler(roll, pitch, yaw, 'ZYX'));   // Rz(yaw) Ry(pitch) Rx(roll), as in URDF
  return matrix.setPosition(x, y, z);
}

function numbers(text: string | null | undefined, fallback: number[]): number[] {
  const values = (text ?? '').trim().split(/\s+/).map(Number);
  return values.length === fallback.length && values.every(Number.isFinite) ? values : fallback;
}

function number(element: Element | null, name: string): number | null {
  const text = element?.getAttribute(name);
  return text === null || text === undefined ? null : Number(text);
}

function readJoints(urdf: string) {
  const root = new DOMParser().parseFromString(urdf, 'application/xml').documentElement;
  const child = (of: Element, tag: string): Element | null => [...of.children].find((c) => c.tagName === tag) ?? null;
  return [...root.children].filter((c) => c.tagName === 'joint').map((element) => {
    const origin = child(element, 'origin');
    const mimic = child(element, 'mimic');
    const limit = child(element, 'limit');
    return {
      name: element.getAttribute('name') ?? '', type: element.getAttribute('type') ?? 'fixed',
      parent: child(element, 'parent')?.getAttribute('link') ?? '', child: child(element, 'child')?.getAttribute('link') ?? '',
      origin: poseMatrix({ position: numbers(origin?.getAttribute('xyz'), [0, 0, 0]), rpy: numbers(origin?.getAttribute('rpy'), [0, 0, 0]) }),
      axis: new Vector3(...numbers(child(element, 'axis')?.getAttribute('xyz'), [1, 0, 0]) as [number, number, number]).normalize(),
      lower: number(limit, 'lower'), upper: number(limit, 'upper'),
      mimic: mimic === null ? null : { joint: mimic.getAttribute('joint') ?? '', multiplier: number(mimic, 'multiplier') ?? 1, offset: number(mimic, 'offset') ?? 0 },
    };
  });
}

function moves(joint: Joint): boolean {
  return ['revolute', 'continuous', 'prismatic'].includes(joint.type);
}

/** Wheels of a given width are boxes of the base, behind its footprint: front and left first, as the controller has them. */
function wheelBoxes(wheels: Wheels | undefined): ShapeJson[] {
  const { radius = 0, separation = 0, wheelbase = 0, width } = wheels ?? {};
  if (width === undefined) return [];
  return (wheelbase === 0 ? [0] : [wheelbase / 2, -wheelbase / 2]).flatMap((x) => [separation / 2, -separation / 2]
    .map((y) => ({ shape: 'box', size: [2 * radius, width, 2 * radius], position: [x, y, radius] })));
}

export class Robot {
  readonly driven: Driven[] = [];
  readonly wheels: Wheels | null;
  readonly shapes: { link: string; shape: ShapeJson; local: Matrix4 }[] = [];
  readonly sensors: readonly SensorJson[];
  /** "@base" and every link, parents first. */
  private readonly order: { link: string; parent: string; joint: Joint | null; driven: number; held: number }[] = [];
  private readonly mount: Matrix4;
  private readonly tool: Matrix4;
  private readonly tip: string;
  private readonly poses = new Map<string, Matrix4>();

  constructor(source: unknown) {
    const json = source as RobotJson;
    this.wheels = json.base.wheels ?? null;
    this.sensors = json.sensors ?? [];
    this.mount = poseMatrix(json.base.mount);
    this.tool = poseMatrix(json.arm.tool);
    this.tip = json.arm.tip;
    const joints = readJoints(json.urdf_text);
    const byChild = new Map(joints.map((joint) => [joint.child, joint]));
    const chain: Joint[] = [];
    for (let joint = byChild.get(this.tip); joint !== undefined; joint = byChild.get(joint.parent)) chain.unshift(joint);
    const locked = json.arm.locked ?? {};
    const place = new Map<string, number>();
    for (const joint of chain) {
      if (!moves(joint) || joint.name in locked) continue;
      const limits = json.arm.limits?.[joint.name];
      place.set(joint.name, this.driven.length);
      this.driven.push({ name: joint.name, lower: limits?.lower ?? joint.lower ?? -Infinity, upper: limits?.upper ?? joint.upper ?? Infinity });
    }
    const byName = new Map(joints.map((joint) => [joint.name, joint]));
    const held = (joint: Joint, depth: number): number => {
      const fixed = locked[joint.name];
      if (fixed !== undefined) return fixed;
      const index = place.get(joint.name);
      if (index !== undefined) return json.arm.ready?.[index] ?? 0;
      const other = joint.mimic === null ? undefined : byName.get(joint.mimic.joint);
      if (joint.mimic !== null && other !== undefined && depth < 32) return joint.mimic.multiplier * held(other, depth + 1) + joint.mimic.offset;
      return joint.lower !== null && joint.upper !== null && joint.lower <= joint.upper ? Math.min(Math.max(0, joint.lower), joint.upper) : 0;
    };
    const root = joints.map((joint) => joint.parent).find((link) => !byChild.has(link)) ?? this.tip;
    this.order.push({ link: root, parent: '@base', joint: null, driven: -1, held: 0 });
    for (let i = 0; i < this.order.length; ++i) {
      const link = this.order[i]?.link;
      for (const joint of joints) {
        if (joint.parent !== link) continue;
        const driven = place.get(joint.name) ?? -1;
        this.order.push({ link: joint.child, parent: joint.parent, joint, driven, held: driven < 0 && moves(joint) ? held(joint, 0) : 0 });
      }
    }
    const add = (shape: ShapeJson, link: string): void => { this.shapes.push({ link, shape, local: poseMatrix(shape) }); };
    if (json.base.footprint !== undefined) add(json.base.footprint, '@base');
    for (const shape of wheelBoxes(json.base.wheels)) add(shape, '@base');
    for (const shape of json.collision?.shapes ?? []) add(shape, shape.link ?? '@base');
    this.poses.set('@base', new Matrix4());
    for (const { link } of this.order) this.poses.set(link, new Matrix4());
  }

  /** Poses of all links for a base (x, y, phi) and joint values. */
  update(x: number, y: number, phi: number, q: (index: number) => number): void {
    this.pose('@base').makeRotationZ(phi).setPosition(x, y, 0);
    const turn = new Matrix4();
    for (const { link, parent, joint, driven, held } of this.order) {
      const pose = this.pose(link).copy(this.pose(parent));
      if (joint === null) {
        pose.multiply(this.mount);
        continue;
      }
      pose.multiply(joint.origin);
      if (!moves(joint)) continue;
      const value = driven >= 0 ? q(driven) : held;
      pose.multiply(joint.type === 'prismatic' ? turn.makeTranslation(joint.axis.x * value, joint.axis.y * value, joint.axis.z * value) : turn.makeRotationAxis(joint.axis, value));
    }
  }

  pose(link: string): Matrix4 {
    const found = this.poses.get(link);
    if (found === undefined) throw new Error(`the robot has no link ${link}`);
    return found;
  }

  /** The link that the nearest driven joint above `link` moves; '@base' where none does. Links of one are rigid to each other. */
  rigid(link: string): string {
    for (let at = this.order.find((o) => o.link === link); at !== undefined; at = this.order.find((o) => o.link === at?.parent)) {
      if (at.driven >= 0) return at.link;
    }
    return '@base';
  }

  /** Rigid with the tip, and moved by the arm. */
  inHand(link: string): boolean {
    return this.rigid(link) !== '@base' && this.rigid(link) === this.rigid(this.tip);
  }

  has(link: string): boolean {
    return this.poses.has(link);
  }

  /** Pose of a sensor whose head looks there. */
  sensorPose({ link = '', head, ...pose }: SensorJson, { pan, tilt }: Gaze): Matrix4 {
    const axes = poseMatrix(head?.axes === undefined ? undefined : { position: head.axes });
    const turn = new Matrix4().makeRotationZ(pan).multiply(new Matrix4().makeRotationY(tilt));
    return this.pose(link === '' ? '@base' : link).clone().multiply(axes).multiply(turn).multiply(axes.invert()).multiply(poseMatrix(pose));
  }

  tipPose(out: Matrix4): Matrix4 {
    return out.copy(this.pose(this.tip)).multiply(this.tool);
  }
}

/** Quaternions are written w x y z. */
export function quaternion(wxyz: readonly number[] | undefined): Quaternion {
  const [w = 1, x = 0, y = 0, z = 0] = wxyz ?? [];
  return new Quaternion(x, y, z, w).normalize();
}
