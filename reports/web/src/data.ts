// The page's data block, as reports/render writes it, and the views of it that figures share.

export const kOutcomes = [
  'success', 'collision', 'timeout', 'stuck', 'joint_limit', 'tipped', 'infeasible', 'diverged', 'error',
] as const;
export type Outcome = (typeof kOutcomes)[number];

/** Outcomes as a person reads them. */
export const kOutcomeNames: Record<Outcome, string> = {
  success: 'success', collision: 'collision', timeout: 'time-out', stuck: 'stuck', joint_limit: 'joint limit',
  tipped: 'tipped over', infeasible: 'infeasible', diverged: 'diverged', error: 'error',
};

type Cell = number | string | null;

export interface SummaryRow {
  suite: string; robot: string; controller: string; point: string; family: string | null; mode: string; n: number;
  success_rate: number; success_low: number; success_high: number;
  collision_rate: number; collision_low: number; collision_high: number;
  time_to_goal_median_s: number | null; manip_mean: number | null; clearance_min_m: number | null;
  command_change_mean: number | null;
}

export interface PointInfo {
  suite: string; robot: string; controller: string; point: string; mode: string;
  params: Record<string, unknown>; parameters: unknown; worlds: { seed?: number | string; [key: string]: unknown };
  control_period_s: number; physics_step_s: number; time_limit_s: number;
  success_position_m: number; success_orientation_rad: number; success_dwell_s: number;
  simulation_version: number;
}

export interface Invocation {
  suite: string; started: string; ended: string | null; status: string; arguments: string[];
  moma_version: string; git_commit: string | null; git_dirty: number | null; build_type: string;
  compiler: string; compiler_flags: string; libraries: Record<string, string>; host: string; os: string;
  cpu: string; cpu_count: number; threads: number; machine_class: string;
  trials_planned: number; trials_present: number; trials_done: number;
}

export interface ReplayData {
  trial: string; robot: number; world: unknown; hz: number; n: number; columns: string[]; data: string;
}

export interface TuneSearch {
  suite: string; controller: string; objective: string; unit: string; budget_trials: number; started: string; ended: string | null;
  status: string; trials: number | null; trials_saved: number | null; evaluations_cut: number | null;
  held_out_suite: string | null; verdict: string | null; notes: string[];
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
  invocations: Invocation[];
  points: PointInfo[];
  summary: SummaryRow[];
  overall: SummaryRow[];
  trials: { n: number; columns: Record<string, Cell[] | { values: string[]; codes: number[] }> };
  robots: Record<string, unknown>;
  replays: ReplayData[];
  samples_stored: number;
  tuning: TuneSearch[];
}

interface TextColumn {
  values: string[];
  codes: number[];
}

/** One row per trial, by column. */
export class Trials {
  readonly n: number;
  private readonly texts = new Map<string, TextColumn>();
  private readonly numbers = new Map<string, Float64Array>();

  constructor(source: PageData['trials']) {
    this.n = source.n;
    for (const [name, column] of Object.entries(source.columns)) {
      if (Array.isArray(column)) {
        this.numbers.set(name, Float64Array.from(column, (v) => (v === null ? NaN : v === 'inf' ? Infinity : v === '-inf' ? -Infinity : Number(v))));
      } else {
        this.texts.set(name, column);
      }
    }
  }

  has(name: string): boolean {
    return this.numbers.has(name) || this.texts.has(name);
  }

  /** NaN where the store has none. */
  number(name: string, row: number): number {
    return this.numbers.get(name)?.[row] ?? NaN;
  }

  text(name: string, row: number): string {
    const column = this.texts.get(name);
    return column?.values[column.codes[row] ?? -1] ?? '';
  }

  column(name: string): TextColumn {
    return this.texts.get(name) ?? { values: [], codes: [] };
  }

  outcome(row: number): Outcome {
    return this.text('outcome', row) as Outcome;
  }

  success(row: number): boolean {
    return this.text('outcome', row) === 'success';
  }

  /** True when any of `rows` has a finite value. */
  any(name: string, rows: readonly number[]): boolean {
    const column = this.numbers.get(name);
    return column !== undefined && rows.some((row) => Number.isFinite(column[row]));
  }
}

/** What may be compared: trials of one suite, robot and mode. */
export interface Slice {
  id: string;
  suite: string;
  robot: string;
  mode: string;
}

/** A controller at one sweep point, with its trials. */
export interface Series {
  index: number;   // within its slice: decides colour and mark
  name: string;
  controller: string;
  point: string;
  info: PointInfo | undefined;
  rows: number[];
}

export class Model {
  readonly trials: Trials;
  readonly slices: Slice[] = [];
  private readonly rowOf = new Map<string, number>();
  private readonly replayOf = new Map<string, ReplayData>();

  constructor(readonly page: PageData) {
    this.trials = new Trials(page.trials);
    const seen = new Set<string>();
    for (const { suite, robot, mode } of page.points) {
      const id = [suite, robot, mode].join(' / ');
      if (seen.has(id)) continue;
      seen.add(id);
      this.slices.push({ id, suite, robot, mode });
    }
    for (let row = 0; row < this.trials.n; ++row) {
      const key = this.trials.text('trial', row);
      if (!this.rowOf.has(key)) this.rowOf.set(key, row);
    }
    for (const replay of page.replays) this.replayOf.set(replay.trial, replay);
  }

  row(trial: string): number | undefined {
    return this.rowOf.get(trial);
  }

  replay(trial: string): ReplayData | undefined {
    return this.replayOf.get(trial);
  }

  families(slice: Slice): string[] {
    return [...new Set(this.page.summary.filter((s) => inSlice(s, slice)).map((s) => s.family ?? ''))];
  }

  /** The series of a slice, in the order in which the store defined them, with the trials of `family` ('' all). */
  series(slice: Slice, family: string): Series[] {
    const infos = this.page.points.filter((point) => inSlice(point, slice));
    const series = infos.map((info, index): Series => ({
      index, name: seriesName(info.controller, info.point), controller: info.controller, point: info.point, info, rows: [],
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

export function inSlice(row: { suite: string; robot: string; mode: string }, slice: Slice): boolean {
  return row.suite === slice.suite && row.robot === slice.robot && row.mode === slice.mode;
}

export function seriesName(controller: string, point: string): string {
  return point === '' ? controller : `${controller} \u00b7 ${point}`;
}

export function readPageData(): PageData {
  const block = document.getElementById('moma-data');
  return JSON.parse(block?.textContent ?? '{}') as PageData;
}
