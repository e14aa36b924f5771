// The page's data block, as reports/render writes it, and the views of it that figures share.

import { integer, plural } from './format';
import { describeMetrics, type MetricData } from './metrics';

/** How a trial ends, in the words of the store. */
export type Outcome = string;

/** All of them, in the order of their description. */
export let kOutcomes: readonly Outcome[] = [];

/** Words for the numbers in columns of samples: status, fallback, plan_mode, plan_reason. */
export let kWords: Readonly<Record<string, readonly string[]>> = {};

export function describeSamples(words: typeof kWords): void {
  kWords = words;
}

/** The outcome in words: "joint limit". */
export function outcomeName(outcome: Outcome): string {
  return outcome.replaceAll('_', ' ');
}

type Cell = number | string | null;

export interface SummaryRow {
  suite: string; robot: string; controller: string; point: string; family: string | null; mode: string;
  /** Trials that the rates are of, and those of them that ended by an error, which is no success. */
  n: number; errors: number;
  success_rate: number; success_low: number; success_high: number; success_without_errors: number | null;
  collision_rate: number; collision_low: number; collision_high: number;
  time_to_goal_median_s: number | null;
  /** Means of the suites' own metrics, by their keys. */
  own?: Record<string, number | null>;
  store?: string;
}

/** Cell of a row: a column of v_summary, a metric's mean (Metric.summary), or a suite's own metric. */
export function cellOf(row: SummaryRow, key: string): string | number | null {
  const own = row.own?.[key];
  return own === undefined ? (row as unknown as Record<string, string | number | null>)[key] ?? null : own;
}

export interface PointInfo {
  store?: string;
  suite: string; robot: string; controller: string; point: string; mode: string;
  params: Record<string, unknown>; parameters: unknown; worlds: { seed?: number | string; [key: string]: unknown };
  control_period_s: number; physics_step_s: number; time_limit_s: number;
  success_position_m: number; success_orientation_rad: number; success_dwell_s: number;
  simulation_version: number;
  robot_content: string;
  /** Parts of the URDF that were left out, a sentence each; empty after strict reading. */
  left_out: readonly string[];
  /** Disturbances between robot and controller (docs/reference/disturbances.md); empty without any. */
  disturbances: Record<string, unknown>;
}

interface Invocation {
  suite: string; started: string; ended: string | null; status: string; arguments: string[];
  moma_version: string; git_commit: string | null; git_dirty: number | null; build_type: string;
  compiler: string; compiler_flags: string; libraries: Record<string, string>; host: string; os: string;
  cpu: string; cpu_count: number; threads: number; machine_class: string;
  /** `notes` of the suite, Markdown; the author of the page may add others (PageData.notes). */
  notes?: string | null;
  trials_planned: number; trials_present: number; trials_done: number; store?: string;
  /** State of a "running" invocation: whether its program still holds the store's lock. */
  writer?: 'at work' | 'gone' | 'unknown';
  /** Estimates of `moma risk`. */
  risk: RiskEstimate[] | null;
}

/** The probability of an event for a point and a family of worlds, or "all". */
export interface RiskEstimate {
  controller: string; point: string; family: string; event: string;
  /** Metric that says how near a trial came, and its value at the event; null: the event is no value of it. */
  level: string; at: number | null;
  p: number; low: number; high: number; refused: boolean; replicates: number; trials: number;
  crude: number; crude_low: number; crude_high: number; crude_trials: number;
  excess: number; died: number; ancestors: number; tied: number;
  /** Levels from far to near: value, probability to reach it, its interval, share among the first draws. */
  way: [value: number, p: number, low: number, high: number, crude: number][];
}

export interface ReplayData {
  trial: string; robot: string; world: unknown; hz: number; n: number; columns: string[]; data: string;
  /** Rows of the QP, if the trial was simulated again for them (replay/rows.ts). */
  rows?: { names: string[]; n: number[]; data: string };
  /** The controller's map, likewise (replay/map.ts). */
  map?: { cell: number; hz: number; data: string; looks: { n: number; data: string } };
}

export interface Motion { replay: ReplayData; robot: unknown; simulated: boolean }

export interface TuneSearch {
  suite: string; controller: string; objective: string; unit: string; budget_trials: number; started: string; ended: string | null;
  status: string; trials: number | null; trials_saved: number | null; evaluations_cut: number | null;
  held_out_suite: string | null; verdict: string | null; notes: string[];
  writer?: 'at work' | 'gone' | 'unknown';
  variables: { key: string; lower: number; upper: number; scale: string; start: number; found: number | null; importance: number | null }[];
  evaluations: { evaluation: number; phase: string; worlds: number; cut: number; valid: number; cost: number; merit: number; candidate: number[] }[];
  sensitivity: { variable: number; value: number | null; change: number; error: number; valid: number }[];
  comparisons: {
    family: string; other: string; metric: string; n: number; found: number | null; found_low: number | null; found_high: number | null;
    theirs: number | null; theirs_low: number | null; theirs_high: number | null; difference: number | null;
    difference_low: number | null; difference_high: number | null; p: number | null; verdict: string;
  }[];
}

export interface PageData {
  format: number;
  store: { file: string; schema: number };
  /** The compared stores, if several; rows then name their store. */
  stores?: { label: string; file: string }[];
  /** Notes of the page's author for its head, Markdown. */
  notes?: string;
  /** Set if `moma view` serves the page: motions are then requested. */
  live?: { token: string; simulates: boolean };
  metrics: MetricData[];
  outcomes: Outcome[];
  words: Record<string, readonly string[]>;
  invocations: Invocation[];
  points: PointInfo[];
  summary: SummaryRow[];
  overall: SummaryRow[];
  /** Trials of each point's first `worlds` worlds, among `stored`; the summary covers all. */
  trials: { n: number; stored: number; worlds: number; columns: Record<string, Cell[] | { values: string[]; codes: number[] }> };
  robots: Record<string, unknown>;
  /** Visual meshes by the ids of `robots`, for robots whose URDF has visuals. */
  looks?: Record<string, unknown>;
  /** The worst of each kind; with `live` their names only. */
  replays: (ReplayData | { trial: string })[];
  samples_stored: number;
  tuning: TuneSearch[];
}

/** One row per trial, by column. */
export class Trials {
  private source: PageData['trials'] = { n: 0, stored: 0, worlds: 0, columns: {} };
  /** Made when they are first asked for, most of them after the first paint. */
  private readonly numbers = new Map<string, Float64Array>();

  load(source: PageData['trials']): void {
    this.source = source;
    this.numbers.clear();
  }

  get n(): number {
    return this.source.n;
  }

  rows(): number[] {
    return Array.from({ length: this.n }, (_, row) => row);
  }

  /** Values by row, NaN where the store has none. A column that no trial has is empty. */
  values(name: string): Float64Array {
    let made = this.numbers.get(name);
    if (made === undefined) {
      const raw = this.source.columns[name];
      made = Float64Array.from(Array.isArray(raw) ? raw : [], (v) => (v === null ? NaN : v === 'inf' ? Infinity : v === '-inf' ? -Infinity : Number(v)));
      this.numbers.set(name, made);
    }
    return made;
  }

  has(name: string): boolean {
    return name in this.source.columns;
  }

  number(name: string, row: number): number {
    return this.values(name)[row] ?? NaN;
  }

  text(name: string, row: number): string {
    const column = this.source.columns[name];
    return column === undefined || Array.isArray(column) ? '' : column.values[column.codes[row] ?? -1] ?? '';
  }

  outcome(row: number): Outcome {
    return this.text('outcome', row);
  }

  success(row: number): boolean {
    return this.text('outcome', row) === 'success';
  }

  /** True when any of `rows` has a finite value. */
  any(name: string, rows: readonly number[]): boolean {
    const column = this.values(name);
    return column.length > 0 && rows.some((row) => Number.isFinite(column[row]));
  }
}

/** Comparable trials: one suite, robot and mode. */
export interface Slice { id: string; suite: string; robot: string; mode: string }

/** A controller at one sweep point, with its trials. */
export interface Series {
  index: number;   // within its slice
  mark: number;    // decides colour, dash and symbol; below 0: not shown
  name: string;
  /** For figures, where room is short: never longer than the name; namedBy() says what its numbers are. */
  short: string;
  controller: string;
  point: string;
  info: PointInfo;
  rows: number[];
}

export class Model {
  readonly trials = new Trials();
  slices: Slice[] = [];
  page!: PageData;
  private rowOf = new Map<string, number>();
  private replays = new Map<string, PageData['replays'][number]>();
  private fetched = new Map<string, Promise<Motion>>();

  constructor(page: PageData) {
    this.load(page);
  }

  /** Shows other data from now on; whoever draws must draw again. */
  load(page: PageData): void {
    this.page = page;
    describeMetrics(page.metrics);
    kOutcomes = page.outcomes;
    describeSamples(page.words);
    this.trials.load(page.trials);
    const slices = page.points.map(({ suite, robot, mode }): Slice => ({ id: [suite, robot, mode].join(' / '), suite, robot, mode }));
    this.slices = [...new Map(slices.map((slice) => [slice.id, slice])).values()];
    this.rowOf = new Map(this.trials.rows().reverse().map((row) => [this.trials.text('trial', row), row]));   // the first of several
    this.replays = new Map(page.replays.map((replay) => [replay.trial, replay]));
  }

  row(trial: string): number | undefined {
    return this.rowOf.get(trial);
  }

  playable(trial: string): boolean {
    return this.page.live?.simulates === true ? this.rowOf.has(trial) : this.replays.has(trial);
  }

  /** A sentence that says how a click on a trial's mark acts, and how many motions the page has. */
  clickPlays(): string {
    const { live, replays: { length: motions } } = this.page;
    if (live === undefined ? motions >= this.trials.n : live.simulates) return 'A click plays the trial.';
    return `A click plays the trial where its motion is at hand (${integer(motions)} of ${plural(this.page.trials.stored, 'trial')}); `
      + (live === undefined ? `moma view ${this.page.store.file} plays any.` : 'of another it shows the command.');
  }

  embedded(trial: string): Motion | undefined {
    const replay = this.replays.get(trial);
    return replay === undefined || !('data' in replay) ? undefined : { replay, robot: this.page.robots[replay.robot], simulated: false };
  }

  /** The motion, from the page or from its server. */
  motion(trial: string): Promise<Motion> {
    const embedded = this.embedded(trial);
    if (embedded !== undefined) return Promise.resolve(embedded);
    if (this.page.live === undefined) return Promise.reject(new Error('its motion is not in the page'));
    let asked = this.fetched.get(trial);
    if (asked === undefined) {
      asked = fetchMotion(trial);
      this.fetched.set(trial, asked);
      asked.catch(() => this.fetched.delete(trial));   // may be asked for again
      if (this.fetched.size > 60) this.fetched.delete(this.fetched.keys().next().value ?? '');
    }
    return asked;
  }

  point(row: number): PointInfo | undefined {
    const t = this.trials;
    return this.page.points.find((p) => p.controller === t.text('controller', row) && p.point === t.text('point', row) && p.suite === t.text('suite', row) && p.mode === t.text('mode', row));
  }

  file(row: number): string {
    const label = this.trials.text('store', row);
    return this.page.stores?.find((s) => s.label === label)?.file ?? this.page.store.file;
  }

  pointsOf(slice: Slice): PointInfo[] {
    return this.page.points.filter((point) => inSlice(point, slice));
  }

  families(slice: Slice): string[] {
    return [...new Set(this.page.summary.filter((s) => inSlice(s, slice)).map((s) => s.family ?? ''))];
  }

  /** The series of a slice, in the order in which the store defined them, with the trials of `family` ('' all). */
  series(slice: Slice, family: string): Series[] {
    const infos = this.pointsOf(slice);
    const label = shortLabels(infos.map((info) => info.point));
    const alone = new Set(infos.map((info) => info.controller)).size === 1;
    const values = valuesOnly(infos.map((info) => info.point));
    const series = infos.map((info, index): Series => ({
      index, mark: index, name: seriesName(info.controller, label(info.point)),
      short: alone && info.point !== '' ? values?.(info.point) ?? label(info.point) : seriesName(info.controller, values?.(info.point) ?? label(info.point)), controller: info.controller, point: info.point, info, rows: [],
    }));
    const byName = new Map(series.map((s) => [`${s.controller}\n${s.point}`, s]));
    const t = this.trials;
    for (let row = 0; row < t.n; ++row) {
      if (t.text('suite', row) !== slice.suite || t.text('mode', row) !== slice.mode) continue;
      if (t.text('robot', row) !== slice.robot || (family !== '' && t.text('family', row) !== family)) continue;
      byName.get(`${t.text('controller', row)}\n${t.text('point', row)}`)?.rows.push(row);
    }
    return series;
  }
}

/** Requests JSON from `moma view`. Throws an Error with its words if it refuses. */
export async function ask(path: string): Promise<unknown> {
  const answer = await fetch(path);
  const json = await answer.json() as { error?: string };
  if (!answer.ok) throw new Error(json.error ?? answer.statusText);
  return json;
}

/** The answer of `moma view` is the motion with its robot. Samples can be simulated anew. */
async function fetchMotion(trial: string): Promise<Motion> {
  const served = await ask(`replay/${trial}`) as ReplayData & { resolved: unknown; simulated?: boolean };
  if (served.n === 0) throw new Error('the store keeps no samples of it');
  return { replay: served, robot: served.resolved, simulated: served.simulated === true };
}

export function inSlice(row: { suite: string; robot: string; mode: string }, slice: Slice): boolean {
  return row.suite === slice.suite && row.robot === slice.robot && row.mode === slice.mode;
}

/** Labels of points that differ in one key: its last part with the value, "disturbances: none" or "lambda_q=0.1". */
function shortLabels(labels: readonly string[]): (label: string) => string {
  const parts = labels.map((label) => /^([^\s=]+)=([^\s=]*)$/.exec(label));
  const keys = new Set(parts.map((part) => part?.[1] ?? ''));
  if (keys.size !== 1 || keys.has('')) return (label) => label;
  const named = parts.every((part) => /^[A-Za-z]/.test(part?.[2] ?? ''));
  return (label) => {
    const short = label.slice(label.lastIndexOf('.', label.indexOf('=')) + 1);
    return named ? short.replace('=', ': ') : short;
  };
}

/** The keys that all labels give values to, where those are too many to be repeated in every name: "lambda_q, k_epsilon". */
export function namedBy(labels: readonly string[]): string {
  const keys = new Set(labels.filter((label) => label !== '').map((label) => label.split(' ').map((part) => part.slice(0, part.indexOf('='))).join(', ')));
  const [only = ''] = keys;
  return keys.size === 1 && only.includes(', ') && labels.every((label) => label === '' || label.split(' ').every((part) => /^[^\s=]+=[^\s=]+$/.test(part))) ? only : '';
}

/** "lambda_q=0.01 k_epsilon=0.5" -> "0.01, 0.5", where all labels have these keys. */
function valuesOnly(labels: readonly string[]): ((label: string) => string) | null {
  return namedBy(labels) === '' ? null : (label) => label.split(' ').map((part) => part.slice(part.indexOf('=') + 1)).join(', ');
}

/** Items that share a key, in the order of their first. */
export function grouped<T>(items: readonly T[], key: (item: T) => string): Map<string, T[]> {
  const out = new Map<string, T[]>(items.map((item) => [key(item), []]));
  for (const item of items) out.get(key(item))?.push(item);
  return out;
}

function seriesName(controller: string, point: string): string {
  return point === '' ? controller : `${controller} \u00b7 ${point}`;
}

/** The data in the page itself; else from the server that it came from. */
export async function readPageData(): Promise<PageData> {
  const block = JSON.parse(document.getElementById('moma-data')?.textContent ?? '{}') as Partial<PageData>;
  return (block.format === undefined ? await ask('data.json') : block) as PageData;
}
