// The collision rows of the QP at a sample: n . (v_robot - v_object) >= -xi (d - d_s) / (d_i - d_s) for every pair nearer
// than its distance of influence d_i (docs/controller.md). The store keeps no rows; they follow from the pose, the
// command and the controller's parameters.

import { Matrix4, Vector3 } from 'three';

import { coreOf, nearestPoints, type Core } from './distance';
import type { Robot } from './robot';
import type { Trace } from './trace';

interface Damper { influence: number; stop: number; gain: number }

export interface CollisionParameters { object: Damper | null; floor: Damper | null; self: Damper | null; most: number }

interface DamperJson { enabled?: boolean; influence?: number; stop?: number; gain?: number }

/** From a controller's resolved parameters; null where it has no collision rows, or is no controller of ours. */
export function collisionParameters(parameters: unknown): CollisionParameters | null {
  const json = (parameters as { collision?: DamperJson & { max_pairs?: number; floor?: DamperJson; self?: DamperJson } } | null)?.collision;
  const damper = (of: DamperJson | undefined): Damper | null =>
    of?.enabled !== false && typeof of?.influence === 'number' && typeof of.stop === 'number' && typeof of.gain === 'number'
      ? { influence: of.influence, stop: of.stop, gain: of.gain } : null;
  if (json === undefined) return null;
  const found = { object: damper(json), floor: damper(json.floor), self: damper(json.self), most: json.max_pairs ?? 30 };
  return found.object === null && found.floor === null && found.self === null ? null : found;
}

export interface Row {
  kind: 'object' | 'floor' | 'self';
  link: string;
  other: string;
  d: number;
  first: Vector3;    // on the robot
  second: Vector3;
  /** The command approaches as fast as the row allows, or faster. */
  active: boolean;
}

/** An object where it is now and a moment later. */
export interface Body { name: string; core: Core; now: Matrix4; later: Matrix4 }

/** How long the moment is [s]: short against all motions, long against rounding in float32. */
export const kMoment = 2e-3;
/** Less than this below its limit [m/s], a row counts as at it. */
const kTight = 5e-3;

export class CollisionRows {
  private readonly cores: Core[];
  private now: Matrix4[] = [];
  private later: Matrix4[] = [];

  constructor(private readonly robot: Robot, private readonly parameters: CollisionParameters) {
    this.cores = robot.shapes.map(({ shape }) => coreOf(shape));
  }

  private places(): Matrix4[] {
    return this.robot.shapes.map(({ link, local }) => this.robot.pose(link).clone().multiply(local));
  }

  /** Rows at time t, nearest to their stop distance first. Leaves the robot posed at t. */
  at(trace: Trace, t: number, bodies: readonly Body[]): Row[] {
    const { robot, parameters } = this;
    const [sample] = trace.locate(t);
    const pose = (h: number): void => {
      const u = (i: number): number => h * (trace.has(`command${i}`) ? trace.column(`command${i}`)[sample] ?? 0 : 0);
      const [x, y, phi] = [trace.at('base_x', t), trace.at('base_y', t), trace.at('base_phi', t)];
      const skip = { differential: 2, omnidirectional: 3, fixed: 0 }[robot.base] ?? 0;
      const ahead = robot.base === 'fixed' ? 0 : u(0);
      const aside = robot.base === 'omnidirectional' ? u(1) : 0;
      robot.update(x + ahead * Math.cos(phi) - aside * Math.sin(phi), y + ahead * Math.sin(phi) + aside * Math.cos(phi),
        phi + (skip > 0 ? u(skip - 1) : 0), (i) => trace.at(`q${i}`, t) + u(skip + i));
    };
    pose(kMoment);
    this.later = this.places();
    pose(0);
    this.now = this.places();
    const rows: Row[] = [];
    const { object, floor, self } = parameters;
    this.cores.forEach((core, i) => {
      const place = this.now[i]!;
      const link = robot.shapes[i]?.link ?? '';
      if (object !== null) {
        for (const body of bodies) this.add(rows, 'object', object, i, core, place, body.core, body.now, body.later, link, body.name);
      }
      if (floor !== null && robot.moves(link)) this.addFloor(rows, floor, i, core, place, link);
    });
    if (self !== null) {
      for (const [i, j] of robot.pairs) {
        const [a, b] = [this.cores[i], this.cores[j]];
        if (a !== undefined && b !== undefined) this.add(rows, 'self', self, i, a, this.now[i]!, b, this.now[j]!, this.later[j]!, robot.shapes[i]?.link ?? '', robot.shapes[j]?.link ?? '');
      }
    }
    const stop = (row: Row): number => row.d - (parameters[row.kind]?.stop ?? 0);
    return rows.sort((a, b) => stop(a) - stop(b)).slice(0, parameters.most);
  }

  private add(rows: Row[], kind: Row['kind'], damper: Damper, i: number, core: Core, place: Matrix4, other: Core, otherNow: Matrix4, otherLater: Matrix4, link: string, name: string): void {
    const far = new Vector3().setFromMatrixPosition(place).distanceTo(new Vector3().setFromMatrixPosition(otherNow));
    if (far - core.reach - other.reach > damper.influence) return;
    const near = nearestPoints(core, place, other, otherNow);
    if (near === null || near.d >= damper.influence) return;
    const n = near.first.clone().sub(near.second).normalize().multiplyScalar(near.d < 0 ? -1 : 1);
    const v1 = this.moved(near.first, place, this.later[i]!);
    const v2 = this.moved(near.second, otherNow, otherLater);
    rows.push({ kind, link, other: name, ...near, active: this.tight(damper, near.d, n.dot(v1.sub(v2)) / kMoment) });
  }

  private addFloor(rows: Row[], damper: Damper, i: number, core: Core, place: Matrix4, link: string): void {
    const down = new Vector3(0, 0, -1);
    const first = core.support(down.clone().transformDirection(place.clone().invert()), new Vector3()).applyMatrix4(place).addScaledVector(down, core.radius);
    if (first.z >= damper.influence) return;
    const rate = this.moved(first, place, this.later[i]!).z / kMoment;
    rows.push({ kind: 'floor', link, other: 'floor', d: first.z, first, second: new Vector3(first.x, first.y, 0), active: this.tight(damper, first.z, rate) });
  }

  /** How far a point fixed to something moves with it. */
  private moved(point: Vector3, from: Matrix4, to: Matrix4): Vector3 {
    return point.clone().applyMatrix4(from.clone().invert()).applyMatrix4(to).sub(point);
  }

  private tight(damper: Damper, d: number, rate: number): boolean {
    return rate <= (-damper.gain * (d - damper.stop)) / (damper.influence - damper.stop) + kTight;
  }
}
