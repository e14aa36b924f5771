// State of the look-ahead (docs/explanation/look-ahead.md): in words, and its path as places of the base.

import { kWords } from '../data';
import { fixed, integer, plural } from '../format';
import type { Trace } from './trace';

/** Mode and kinds of choices, by the store's numbers (docs/reference/store.md). */
const kFollow = 1;
const kPolicy = 1;
const kPath = 3;
const kChoices = ['', 'the policy', 'a detour', 'a path'];  // a detour: in stores of simulation version 12 and before

export function looksAhead(trace: Trace): boolean {
  return trace.has('plan_mode');
}

/** Mode, reason, place on the path, and the last choice with the times that were predicted; without a plan whether there is a detour. */
export function planSentence(trace: Trace, t: number): string {
  if (!looksAhead(trace)) return detourTarget(trace, t) === null ? '' : 'The robot makes a detour.';
  const [i] = trace.locate(t);
  const of = (name: string): number => trace.column(`plan_${name}`)[i] ?? 0;
  const mode = of('mode');
  const does = detourTarget(trace, t) === null ? kWords['plan_mode']?.[mode] ?? 'does what this page has no word for' : 'makes a detour';
  const said = [`Looking ahead: the robot ${does}: ${kWords['plan_reason']?.[of('reason')] ?? 'for a reason that this page has no word for'}`
    + (mode === kFollow ? `; at ${fixed(of('clock'), 2)} of ${fixed(of('duration'), 2)} s, ${fixed(of('lag'), 3)} m behind` : '') + '.'];
  if (of('going_on') !== 0) said.push('Meanwhile a path is worked out.');
  const choice = of('choice');
  if (choice !== 0) {
    const rival = (kind: number, name: string, time: number, none: string): string => (choice === kind ? '' : ` ${name}: ${time < 0 ? none : `${fixed(time, 2)} s`}.`);
    const best = of(['', 'time_policy', 'time_detour', 'time_path'][choice] ?? 'time_policy');
    said.push(`Choice ${integer(of('attempts'))}, of ${plural(of('tried'), 'candidate')}, fell on ${kChoices[choice] ?? 'what this page has no word for'}`
      + (best < 0 ? ', since nothing arrived.' : `: ${fixed(best, 2)} s to the goal, the least.`)
      + rival(kPolicy, 'The policy as it was', of('time_policy'), 'would not have arrived')
      + rival(kPath, 'A path', of('time_path'), 'none that is quicker'));
  }
  return said.join(' ');
}

/** Rest of the base's path at time t, (x, y) in the world; empty without a path. */
export function pathAhead(trace: Trace, t: number): [number, number][] {
  if (!looksAhead(trace)) return [];
  const column = (name: string): Float32Array => trace.column(`plan_${name}`);
  const [mode, attempts, x, y] = [column('mode'), column('attempts'), column('target_x'), column('target_y')];
  const [now] = trace.locate(t);
  const places: [number, number][] = [];
  let i = now;
  for (; i < trace.n && mode[i] === kFollow && attempts[i] === attempts[now]; ++i) places.push([x[i] ?? 0, y[i] ?? 0]);
  // A path that was never driven is known by its end alone.
  if (i > now) places.push([column('end_x')[i - 1] ?? 0, column('end_y')[i - 1] ?? 0]);
  return places;
}

/** End of the detour at time t, (x, y) in the world; null without one. */
export function detourTarget(trace: Trace, t: number): [number, number] | null {
  if (!trace.has('detour_x')) return null;
  const [i] = trace.locate(t);
  const of = (name: string): number => trace.column(name)[i] ?? 0;
  return of('detour') === 0 || (looksAhead(trace) && of('plan_mode') === kFollow) ? null : [of('detour_x'), of('detour_y')];
}
