// Why a trial failed, as far as the store tells: from its outcome, its reason, its counts, and what report and view read
// from its samples (reports/render/evidence.h). One cause per trial; where several fit, the first below.

import type { Model } from './data';

export const kCauseTexts = {
  'late detection': 'the object had been known for less than a second at the contact, or not at all',
  contact: 'touched something that it knew, itself or the floor',
  infeasible: 'no command kept all rows in more than a tenth of the steps, or at the end for too long',
  'local minimum': 'stands or circles before an object within 10 cm, away from the goal',
  limit: 'a joint is at its limit',
  'almost there': 'nothing near, within three tolerances of the goal',
  'base misaligned': 'nothing near, but the goal lies beside a base that cannot drive sideways (more than 30\u00b0 off its axis)',
  'out of time': 'nothing near, still on its way at the time limit',
  standstill: 'nothing near, and yet at rest',
  tilted: 'the tool tilted farther than the world allows',
  other: 'tipped over, diverged, a program error',
};
export type Cause = keyof typeof kCauseTexts;
export const kCauses = Object.keys(kCauseTexts) as Cause[];

/** "sphere3" and "sphere7" are one kind of thing; what follows "self:" is kept. */
export function kind(object: string): string {
  if (object.startsWith('self:')) return `itself (${object.slice(5)})`;
  const stem = object.replace(/[\s_-]*\d+$/, '') || object;
  return stem === 'object' ? 'an object' : stem;
}

/** "@base" is the mobile base; "hand/2" the second shape of hand. */
export function part(link: string): string {
  const stem = link.replace(/\/\d+$/, '');
  return stem === '@base' ? 'base' : stem;
}

/** An object nearer than this counts as the obstacle that holds the robot [m]. */
const kHolds = 0.1;
/** An object detected less than this before the contact was detected too late [s]. */
const kLate = 1;
/** Share of infeasible steps that is more than a passing difficulty. */
const kOften = 0.1;
/** Sine of the bearing beyond which a goal lies beside the base. */
const kBeside = 0.5;

/**
 * Kind of the store's reason: "0.4 m and 0.1 rad from the goal; link4 is 0.02 m from sphere3; joint4 is 0.01 from its
 * limit". Numbers differ from trial to trial and would make every failure its own cluster.
 */
function held(reason: string) {
  const out = { near: [] as string[], limits: [] as string[], outside: '', told: false };
  for (const text of reason.split(';')) {
    const near = /^\s*(\S+) is ([-+.\deE]+) m from (.+)$/.exec(text);
    const limit = /^\s*(\S+) is ([-+.\deE]+) from its limit$/.exec(text);
    const outside = /^\s*(\S+) at \S+ is outside /.exec(text);
    if (/ from the goal$/.test(text)) out.told = true;
    else if (outside !== null) out.outside = `${outside[1]} beyond its limit`;
    else if (near !== null) {
      if (Number(near[2]) < kHolds) out.near.push(`${part(near[1] ?? '')} close to ${kind(near[3] ?? '')}`);
    } else if (limit !== null) out.limits.push(`${limit[1]} at its limit`);
  }
  return out;
}

export function causeOf(model: Model, row: number): { cause: Cause; what: string } {
  const t = model.trials;
  const outcome = t.outcome(row);
  const reason = t.text('reason', row);
  if (outcome === 'collision') {
    const what = `${part(t.text('link', row)) || 'robot'} against ${kind(t.text('object', row)) || 'something'}`;
    return { cause: t.number('known_before_contact_s', row) < kLate ? 'late detection' : 'contact', what };
  }
  // Digits that belong to a name stay.
  const plain = reason.replace(/(?<![\w.])-?\d+(\.\d+)?([eE][-+]?\d+)?/g, '\u2026').slice(0, 90);
  const { near, limits, outside, told } = held(reason);
  const what = outside || [...near, ...limits].join(', ') || (told ? 'clear of objects and limits' : plain);
  if (outcome === 'infeasible' || t.number('qp_infeasible', row) > kOften * t.number('steps', row)) return { cause: 'infeasible', what };
  if (outcome === 'joint_limit') return { cause: 'limit', what };
  if (outcome === 'spilled') return { cause: 'tilted', what };
  if (outcome !== 'stuck' && outcome !== 'timeout') return { cause: 'other', what };
  if (near.length > 0) return { cause: 'local minimum', what };
  if (limits.length > 0) return { cause: 'limit', what };
  const info = model.point(row);
  const close = t.number('position_error_m', row) < 3 * (info?.success_position_m ?? 0) && t.number('orientation_error_rad', row) < 3 * (info?.success_orientation_rad ?? 0);
  if (close) return { cause: 'almost there', what };
  if (Math.abs(Math.sin(t.number('goal_bearing_rad', row))) > kBeside) return { cause: 'base misaligned', what: 'the goal lies beside the base' };
  return { cause: outcome === 'timeout' ? 'out of time' : 'standstill', what };
}
