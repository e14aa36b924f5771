// The shown part of the data: slice, family and series that the reader has chosen.

import { equalConditions, meets, onlyConditions } from './conditions';
import { inSlice, namedBy, type Model, type Series, type Slice, type SummaryRow } from './data';
import * as state from './state';
import { kColours } from './theme';

/** More than this many series in one figure cannot be told apart; where none of them may be left out, a few more. */
const kMostSeries = kColours;
const kMostConditions = 12;
/** More series than this are many: the best of them are judged, against the first. */
export const kFew = 4;

export interface View {
  model: Model;
  slice: Slice;
  family: string;     // '' all
  families: string[];
  all: Series[];      // of the slice under the chosen conditions, with the trials of the family
  series: Series[];   // those shown
}

let cached: View | null = null;
let source: Model | null = null;
/** Keys of the address that choose what is shown, and the data themselves. */
export const kView: readonly string[] = ['slice', 'family', 'show', 'at', 'data'];

/** The first slice that has trials: that of a search's own suite has none. */
function firstSlice(model: Model): string {
  const filled = model.slices.find((slice) => model.page.overall.some((row) => row.n > 0 && inSlice(row, slice)));
  return (filled ?? model.slices[0])?.id ?? '';
}

export function startView(model: Model): void {
  source = model;
  state.setDefault('slice', firstSlice(model));
  state.listen(kView, () => { cached = null; });   // before all others
}

/** The model's data has changed. */
export function refreshView(): void {
  if (source !== null) state.setDefault('slice', firstSlice(source));
  state.tell(new Set(['data']));
}

export function view(): View {
  if (cached !== null) return cached;
  if (source === null) throw new Error('the view has no data yet');
  const model = source;
  const slice = model.slices.find((s) => s.id === state.get('slice')) ?? model.slices.find((s) => s.id === firstSlice(model)) ?? { id: '', suite: '', robot: '', mode: '' };
  const families = model.families(slice);
  const wanted = state.get('family');
  const family = families.includes(wanted) ? wanted : '';
  const points = model.series(slice, family);
  const met = points.filter((s) => meets(model, slice, s.info));
  const all = met.length > 0 ? met : points;
  const series = shown(model, slice, all);
  if (points.length > kColours) {   // colours go to those that are shown
    for (const s of points) s.mark = series.indexOf(s);
  }
  cached = { model, slice, family, families, all, series };
  return cached;
}

/** Whether all series are shown unless the reader chooses among them. */
function fit(model: Model, slice: Slice, all: readonly Series[]): boolean {
  return all.length <= (onlyConditions(model, slice) ? kMostConditions : kMostSeries);
}

/** Those that the reader has chosen, else all; of too many the few with the highest success rate over all families. */
function shown(model: Model, slice: Slice, all: readonly Series[]): Series[] {
  const indices = state.get('show').split(',');
  const chosen = all.filter((s) => indices.includes(String(s.index)));
  if (chosen.length > 0) return chosen;
  if (fit(model, slice, all)) return [...all];
  const rate = new Map(all.map((s) => [s, rowOf(model, slice, '', s)?.success_rate ?? -1]));
  const best = [...all].sort((a, b) => rate.get(b)! - rate.get(a)!).slice(0, kMostSeries - 2);
  return all.filter((s) => best.includes(s));
}

/** The trials of each shown series in each shown family of worlds, where it has any. */
export function byFamily(): { family: string; series: Series; rows: number[] }[] {
  const { model, families, family, series } = view();
  return (family === '' ? families : [family]).flatMap((name) => series.map((s) => ({ family: name, series: s, rows: s.rows.filter((row) => model.trials.text('family', row) === name) })))
    .filter(({ rows }) => rows.length > 0);
}

/** The row of a series in the table of results; `family` '': of all together. */
function rowOf(model: Model, slice: Slice, family: string, s: Pick<Series, 'controller' | 'point'>): SummaryRow | undefined {
  const { overall, summary } = model.page;
  return (family === '' ? overall : summary).find((row) => (row.family ?? '') === family && row.controller === s.controller && row.point === s.point && inSlice(row, slice));
}

/** The row of a series in the table of results, of the chosen family unless another is named; undefined where it has no trials. */
export function resultOf(s: Pick<Series, 'controller' | 'point'>, family = view().family): SummaryRow | undefined {
  const { model, slice } = view();
  return rowOf(model, slice, family, s);
}

/**
 * The series that others are compared with: as chosen, else the first that the suite defines. Of many it is the first of all, though it
 * may not be among the best that are shown: two neighbours at the top are mostly a tie.
 */
export function baseline(): Series | undefined {
  const { all, series } = view();
  const asked = state.get('base');
  return all.find((s) => asked !== '' && s.index === Number(asked)) ?? (series.length > kFew ? all[0] : series[0]);
}

/**
 * The others of `among` that `base` may be compared with. A pair differs in its controllers or in the conditions, never in both: those
 * under the same conditions; where there are none, the same controller under other ones.
 */
export function rivalsOf(base: Series, among: readonly Series[]): Series[] {
  const { model, slice } = view();
  const others = among.filter((s) => s !== base);
  const alike = others.filter((s) => equalConditions(model, slice, base.info, s.info));
  return alike.length > 0 ? alike : others.filter((s) => s.controller === base.controller);
}

/** Returns the shown series with the highest success rate that can be compared with `base`. */
export function bestRival(base: Series | undefined): Series | undefined {
  const rate = (s: Series): number => resultOf(s, '')?.success_rate ?? -1;
  return base === undefined ? undefined : rivalsOf(base, view().series).sort((a, b) => rate(b) - rate(a))[0];
}

/** Says which quantity a name's number is, where names are numbers alone. */
export function naming(): string {
  const keys = namedBy(view().all.map((s) => s.point));
  return keys === '' ? '' : ` Names are values of ${keys}.`;
}

export function toggleSeries(index: number): void {
  const now = new Set(view().series.map((s) => s.index));
  if (!now.delete(index)) now.add(index);
  if (now.size === 0) return;
  const { all, model, slice } = view();
  const text = [...now].sort((a, b) => a - b).join(',');
  state.set({ show: now.size === all.length && fit(model, slice, all) ? '' : text });
}
