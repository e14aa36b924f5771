// The collision rows of the QP at a sample: n . (v_robot - v_object) >= -xi (d - d_s) / (d_i - d_s) for every pair nearer
// than its distance of influence d_i (docs/explanation/controller.md). The store keeps no rows; they follow from the pose, the
// command and the controller's parameters.

import { Matrix4, Vector3 } from 'three';

import { coreOf, nearestPoints, type Core } from './distance';
import { movingPairs } from './moving_pairs';
import { passing, type PassingParameters } from './passing';
import type { Robot } from './robot';
import type { Trace } from './trace';

interface Damper { influence: number; stop: number; gain: number }

export interface CollisionParameters { object: Damper | null; floor: Damper | null; self: Damper | null; most: number; ends: number; passing: PassingParameters | null }

interface DamperJson { enabled?: boolean; influence?: number; stop?: number; gain?: number }

/** From a controller's resolved parameters; null where it has no collision rows, or is no controller of ours. */
export function collisionParameters(parameters: unknown): CollisionParameters | null {
  const json = (parameters as { collision?: DamperJson & { max_pairs?: number; end_rows?: number; passing?: Partial<PassingParameters>; floor?: DamperJson; self?: DamperJson } } | null)?.collision;
  const damper = (of: DamperJson | undefined): Damper | null =>
    of?.enabled !== false && typeof of?.influence === 'number' && typeof of.stop === 'number' && typeof of.gain === 'number'
      ? { influence: of.influence, stop: of.stop, gain: of.gain } : null;
  if (json === undefined) return null;
  const found = { object: damper(json), floor: damper(json.floor), self: damper(json.self), most: json.max_pairs ?? 30, ends: json.end_rows ?? 0,
    passing: typeof json.passing?.horizon === 'number' ? { horizon: json.passing.horizon, clearance: json.passing.clearance ?? 0 } : null };
  return found.object === null && found.floor === null && found.self === null ? null : found;
}

export interface Row {
  /** "end": of a cap of a capsule against an object; "passing": d is the gap, second the side to pass on. */
  kind: 'object' | 'floor' | 'self' | 'end' | 'passing';
  link: string;
  other: string;
  d: number;
  first: Vector3;    // on the robot
  second: Vector3;
  /** How much slower than allowed the command approaches [m/s]; below 0: faster. */
  room: number;
  /** As fast as allowed, or faster. */
  active: boolean;
}

/** An object where it is now and a moment later. */
export interface Body { name: string; core: Core; now: Matrix4; later: Matrix4 }

/** How long the moment is [s]: short against all motions, long against rounding in float32. */
export const kMoment = 2e-3;
/** Velocities of a base that goes sideways too. */
const kLateral = 3;
/** Length of the arrow that shows a side [m]. */
const kSide = 0.5;
/** Less than this below its limit [m/s], a row counts as at it. */
const kTight = 5e-3;

/** Least rate of a distance that a damper allows [m/s]. */
function limit(damper: Damper, d: number): number {
  return (-damper.gain * (d - damper.stop)) / (damper.influence - damper.stop);
}

function room(rate: number, least: number): Pick<Row, 'room' | 'active'> {
  return { room: rate - least, active: rate <= least + kTight };
}

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
    const pairs = parameters.self === null ? [] : movingPairs(robot);   // before the robot is posed
    const [sample] = trace.locate(t);
    const dof = trace.count('command') - trace.count('q');   // of the base: linear velocities, then the turn
    const pose = (h: number): void => {
      const u = (i: number): number => h * (trace.has(`command${i}`) ? trace.column(`command${i}`)[sample] ?? 0 : 0);
      const [x, y, phi] = [trace.at('base_x', t), trace.at('base_y', t), trace.at('base_phi', t)];
      const ahead = dof > 0 ? u(0) : 0;
      const aside = dof === kLateral ? u(1) : 0;
      robot.update(x + ahead * Math.cos(phi) - aside * Math.sin(phi), y + ahead * Math.sin(phi) + aside * Math.cos(phi),
        phi + (dof > 0 ? u(dof - 1) : 0), (i) => trace.at(`q${i}`, t) + u(dof + i));
    };
    pose(kMoment);
    this.later = this.places();
    pose(0);
    this.now = this.places();
    const rows: Row[] = [];
    const of = new Map<Row, [shape: number, body: Body]>();
    const { object, floor, self } = parameters;
    this.cores.forEach((core, i) => {
      const place = this.now[i]!;
      const link = robot.shapes[i]?.link ?? '';
      if (object !== null) {
        for (const body of bodies) {
          this.add(rows, 'object', object, i, core, place, body.core, body.now, body.later, link, body.name);
          const last = rows[rows.length - 1];
          if (last?.kind === 'object' && !of.has(last)) of.set(last, [i, body]);
        }
      }
      if (floor !== null && robot.moves(link)) this.addFloor(rows, floor, i, core, place, link);
    });
    if (self !== null) {
      for (const [i, j] of pairs) {
        const [a, b] = [this.cores[i], this.cores[j]];
        if (a !== undefined && b !== undefined) this.add(rows, 'self', self, i, a, this.now[i]!, b, this.now[j]!, this.later[j]!, robot.shapes[i]?.link ?? '', robot.shapes[j]?.link ?? '');
      }
    }
    const stop = (row: Row): number => row.d - (parameters[row.kind as 'object' | 'floor' | 'self']?.stop ?? 0);
    const kept = rows.sort((a, b) => stop(a) - stop(b)).slice(0, parameters.most);
    const ends = object === null ? [] : kept.flatMap((row) => {
      const pair = of.get(row);
      return pair === undefined || row.d >= parameters.ends ? [] : this.ends(row, object, ...pair);
    });
    return [...kept, ...ends, ...(dof > 0 ? this.passing(bodies, dof === kLateral) : [])];
  }

  private add(rows: Row[], kind: Row['kind'], damper: Damper, i: number, core: Core, place: Matrix4, other: Core, otherNow: Matrix4, otherLater: Matrix4, link: string, name: string, later = this.later[i]!): void {
    const far = new Vector3().setFromMatrixPosition(place).distanceTo(new Vector3().setFromMatrixPosition(otherNow));
    if (far - core.reach - other.reach > damper.influence) return;
    const near = nearestPoints(core, place, other, otherNow);
    if (near === null || near.d >= damper.influence) return;
    const n = near.first.clone().sub(near.second).normalize().multiplyScalar(near.d < 0 ? -1 : 1);
    const v1 = this.moved(near.first, place, later);
    const v2 = this.moved(near.second, otherNow, otherLater);
    rows.push({ kind, link, other: name, ...near, ...room(n.dot(v1.sub(v2)) / kMoment, limit(damper, near.d)) });
  }

  /** Rows of the caps of a pair's capsules, those left out that say what the pair's own row says. */
  private ends(row: Row, damper: Damper, i: number, body: Body): Row[] {
    const out: Row[] = [];
    const ball = (radius: number): Core => ({ radius, half: 0, reach: radius, support: (_, point) => point.set(0, 0, 0) });
    const cap = (place: Matrix4, z: number): Matrix4 => place.clone().multiply(new Matrix4().makeTranslation(0, 0, z));
    const [core, now, later] = [this.cores[i]!, this.now[i]!, this.later[i]!];
    for (const side of [-1, 1]) {
      if (core.half > 0) this.add(out, 'end', damper, i, ball(core.radius), cap(now, side * core.half), body.core, body.now, body.later, row.link, row.other, cap(later, side * core.half));
      if (body.core.half > 0) this.add(out, 'end', damper, i, core, now, ball(body.core.radius), cap(body.now, side * body.core.half), cap(body.later, side * body.core.half), row.link, row.other);
    }
    return out.filter((end) => end.first.distanceTo(row.first) > 1e-3 || end.second.distanceTo(row.second) > 1e-3);
  }

  /** Rows for objects in motion that pass the base, nearest first. */
  private passing(bodies: readonly Body[], lateral: boolean): Row[] {
    const { robot, parameters } = this;
    const of = parameters.passing;
    if (of === null || parameters.object === null) return [];
    const rows: Row[] = [];
    const velocity = (now: Matrix4, later: Matrix4): Vector3 => new Vector3().setFromMatrixPosition(later).sub(new Vector3().setFromMatrixPosition(now)).divideScalar(kMoment);
    const base = new Vector3().setFromMatrixPosition(robot.pose('@base'));
    this.cores.forEach((core, i) => {
      const link = robot.shapes[i]?.link ?? '';
      if (robot.moves(link)) return;
      const place = this.now[i]!;
      const centre = new Vector3().setFromMatrixPosition(place);
      const fastest = (lateral ? Math.SQRT2 : 1) * robot.fastest.linear + Math.hypot(centre.x - base.x, centre.y - base.y) * robot.fastest.angular;
      for (const body of bodies) {
        const row = passing(of, { core, place, velocity: velocity(place, this.later[i]!) }, { core: body.core, place: body.now, velocity: velocity(body.now, body.later) }, fastest);
        if (row !== null) rows.push({ kind: 'passing', link, other: body.name, d: row.gap, first: centre, second: centre.clone().addScaledVector(row.n, kSide), ...room(row.rate, row.limit) });
      }
    });
    return rows.sort((a, b) => a.d - b.d).slice(0, parameters.most);
  }

  private addFloor(rows: Row[], damper: Damper, i: number, core: Core, place: Matrix4, link: string): void {
    const down = new Vector3(0, 0, -1);
    const first = core.support(down.clone().transformDirection(place.clone().invert()), new Vector3()).applyMatrix4(place).addScaledVector(down, core.radius);
    if (first.z >= damper.influence) return;
    const rate = this.moved(first, place, this.later[i]!).z / kMoment;
    rows.push({ kind: 'floor', link, other: 'floor', d: first.z, first, second: new Vector3(first.x, first.y, 0), ...room(rate, limit(damper, first.z)) });
  }

  /** How far a point fixed to something moves with it. */
  private moved(point: Vector3, from: Matrix4, to: Matrix4): Vector3 {
    return point.clone().applyMatrix4(from.clone().invert()).applyMatrix4(to).sub(point);
  }
}
