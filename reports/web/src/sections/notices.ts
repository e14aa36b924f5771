// Warnings before the numbers: missing, failed or mixed data.

import { inSlice, type Model, type PointInfo } from '../data';
import { integer, list, plural } from '../format';
import { view } from '../view';

export const kSettings: readonly (readonly [keyof PointInfo, string])[] = [
  ['control_period_s', 'control period'], ['physics_step_s', 'physics step'], ['time_limit_s', 'time limit'],
  ['success_position_m', 'tolerance in position'], ['success_orientation_rad', 'tolerance in orientation'], ['success_dwell_s', 'dwell time'],
];

/** Conditions that must be equal for rates to be comparable. Within one store they are. */
function settings(points: readonly PointInfo[], several: boolean): string[] {
  if (!several) return [];
  const differ = kSettings.filter(([key]) => new Set(points.map((p) => p[key])).size > 1).map(([key, name]) => `${name} (${list([...new Set(points.map((p) => String(p[key])))])})`);
  if (new Set(points.map((p) => p.store)).size > 1 && new Set(points.map((p) => JSON.stringify(p.disturbances))).size > 1) differ.push('disturbances (below, under provenance)');
  return differ.length === 0 ? [] : [`The stores were not run alike, so that their rates must not be compared as they are: they differ in ${list(differ)}.`];
}

export function notices(model: Model, suites: readonly string[]): string[] {
  const { page, trials } = model;
  const { slice } = view();
  const points = model.pointsOf(slice);
  const overall = page.overall.filter((o) => inSlice(o, slice));
  const out: string[] = [];
  if (page.points.length === 0 || trials.n === 0) {
    if (page.invocations.every((i) => i.risk === null)) out.push('This store holds no trials yet: nothing has been evaluated, or the run has only begun.');
    return out;
  }
  const { n, stored: all, worlds } = page.trials;
  if (n < all) {
    out.push(`Of ${plural(all, 'trial')} the page shows ${integer(n)} one by one, those of the first ${plural(worlds, 'world')} of each point. Verdicts and the table of results are over all; figures, failures and comparisons over what is shown, as their n says.`);
  }
  const runs = page.invocations.filter((i) => i.suite === slice.suite);
  for (const store of page.stores?.map((s) => s.label) ?? [undefined]) {
    const latest = runs.find((i) => i.store === store);
    if (latest === undefined) continue;
    const stored = page.overall.filter((o) => o.suite === slice.suite && o.store === store).reduce((sum, o) => sum + o.n, 0);
    const where = store === undefined ? '' : `${store}: `;
    const missing = latest.trials_planned - stored;
    const running = { 'at work': page.live === undefined ? 'The run was still going on when this page was made' : 'The run goes on', gone: 'The last run was killed' }[latest.writer as string]
      ?? 'The run was still going on, or was killed, when this page was made';
    const why = { running, stopped: 'The last run was stopped early',
      failed: 'The last run failed', finished: 'The last run planned more' }[latest.status] ?? 'The last run did not finish';
    if (missing > 0) out.push(`${where}${why}: ${integer(stored)} of ${plural(latest.trials_planned, 'trial')} are here, ${integer(missing)} missing.${latest.writer === 'at work' ? '' : ' The same command goes on where it stopped.'} What follows is interim: whoever looks before the end and stops when a difference shows finds more of them than there are. Its p-values hold for the whole run.`);
    else if (latest.status !== 'finished') out.push(`${where}${why}, yet all ${plural(latest.trials_planned, 'planned trial')} are here.`);
  }
  const leftOut = new Set(points.flatMap((p) => p.left_out));
  if (leftOut.size > 0) {
    out.push(`Of the URDF of ${slice.robot} ${leftOut.size === 1 ? 'one part was' : `${integer(leftOut.size)} parts were`} not understood and left out (--lenient), so that nothing can collide with what is missing: ${list([...leftOut])}.`);
  }
  if (new Set(overall.map((o) => o.n)).size > 1) out.push('The controllers do not have equally many trials: compare them world by world.');
  const errors = overall.reduce((sum, o) => sum + o.errors, 0);
  const diverged = trials.rows().filter((row) => trials.outcome(row) === 'diverged' && trials.text('suite', row) === slice.suite).length;
  if (errors > 0) out.push(`${plural(errors, 'trial')} ended by an error; ${errors === 1 ? 'it counts' : 'they count'} as failed. The table of results has the rate without ${errors === 1 ? 'it' : 'them'}, the table of trials the text.`);
  if (diverged > 0) out.push(`In ${plural(diverged, 'trial')} the physics diverged; ${diverged === 1 ? 'it counts' : 'they count'} as failed.`);
  const classes = new Set(runs.map((r) => r.machine_class));
  if (classes.size > 1) out.push(`Trials come from ${integer(classes.size)} classes of machines, whose last bits may differ.`);
  out.push(...settings(points, page.stores !== undefined));
  const versions = new Set(points.map((p) => p.simulation_version));
  if (versions.size > 1) out.push('Trials of different simulation versions are shown together: run the suite again before comparing.');
  if (suites.length > 1) out.push(`The store holds ${integer(suites.length)} suites: ${list(suites)}. The bar below chooses the one that the page shows.`);
  return out;
}
