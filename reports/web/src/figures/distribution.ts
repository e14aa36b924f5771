// Distribution of any metric, one row per controller and family: density above, box below; of few trials, each as a dot.

import { axis, gridBox, marksIn, nice, rowAxis, rowHeight, tip, type Choice, type FigureSpec, type Option } from '../chart';
import type { Series } from '../data';
import { integer, sizes, upper } from '../format';
import { axisName, kMetrics, metric, withUnit, type Metric } from '../metrics';
import * as state from '../state';
import { density, spread, type Spread } from '../stats';
import { seriesColour } from '../theme';
import { byFamily, view } from '../view';

interface Row { series: Series; family: string; values: number[]; spread: Spread }

function collect(key: string): Row[] {
  const { trials } = view().model;
  return byFamily().flatMap(({ rows, ...of }) => {
    const values = rows.map((row) => trials.number(key, row)).filter(Number.isFinite);
    const summary = spread(values);
    return summary === null ? [] : [{ ...of, values, spread: summary }];
  });
}

/** Fewer values are drawn one by one: their density would show the kernel, and outer percentiles are single trials. */
const kFew = 30;

/** Dots from the axis upwards, each as low as those before it leave room. */
function pile(xs: readonly number[], size: number): number[] {
  const placed: { x: number; level: number }[] = [];
  return xs.map((x) => {
    const taken = new Set(placed.filter((d) => Math.abs(d.x - x) < size).map((d) => d.level));
    let level = 0;
    while (taken.has(level)) ++level;
    placed.push({ x, level });
    return level;
  });
}

function presentMetrics(among: readonly Metric[]): [string, string][] {
  const { model, series } = view();
  return among.filter((m) => series.some((s) => model.trials.any(m.key, s.rows))).map((m) => [m.key, axisName(m)]);
}

/** The metric that is chosen under a key, by default `first`; where no shown trial has it, the first that one has. */
export function metricChoice(key: string, label: string, first: string, among: () => readonly Metric[] = () => kMetrics): { of: () => Metric; choice: Choice } {
  state.setDefault(key, first);
  const of = (): Metric => {
    const present = presentMetrics(among()).map(([name]) => name);
    return metric(present.includes(state.get(key)) ? state.get(key) : present[0] ?? state.get(key));
  };
  return { of, choice: { key, label, options: () => presentMetrics(among()), value: () => of().key } };
}

export function distribution(id: string, first: string): FigureSpec {
  const chosen = metricChoice(`f.${id}`, 'Metric', first);
  return {
    id,
    title: () => upper(chosen.of().name),
    caption: 'How the trials of each controller are spread, failures included. Choose any metric.',
    empty: 'No trial here has this metric.',
    choices: [chosen.choice],
    draw: (p, width) => {
      const of = chosen.of();
      const all = collect(of.key);
      if (all.length === 0) return null;
      // The axis leaves out the last hundredth where a few values would squeeze all others.
      const low = Math.min(...all.map((r) => r.spread.min));
      const far = Math.max(...all.map((r) => r.spread.max));
      const near = Math.max(...all.map((r) => r.spread.p95));
      const high = far > low + 3 * (near - low) && near > low ? low + 1.6 * (near - low) : far;
      const beyond = all.reduce((sum, r) => sum + r.values.filter((v) => v > high).length, 0);
      const several = view().families.length > 1;
      const rows = all.map((r) => ({ name: r.series.short, family: several ? r.family : '' }));
      const counts = all.map((r) => r.spread.n);

      /** Marks of a row above and below its `middle`; `x` places a value. */
      const drawn = (row: Row, middle: number, tall: number, x: (v: number) => number): Option[] => {
        const { spread: s } = row;
        const colour = seriesColour(p, row.series.mark);
        const [floor, box] = [middle + tall * 0.18, middle + tall * 0.48];
        const median = { type: 'circle', shape: { cx: x(s.median), cy: box, r: 4.5 }, style: { fill: p.surface, stroke: colour, lineWidth: 2 } };
        if (s.n < kFew) {
          const inside = row.values.filter((v) => v <= high).sort((a, b) => a - b).map(x);
          const levels = pile(inside, 6.5);
          const room = Math.min(6.5, (tall * 1.1) / Math.max(1, ...levels));
          return [...inside.map((cx, i) => ({ type: 'circle', shape: { cx, cy: floor - (levels[i] ?? 0) * room, r: 3 }, style: { fill: colour, opacity: 0.62 } })), median];
        }
        const curve = density(row.values, low, high, 90).map(([v, d]) => [x(v), floor - d * tall * 0.95]);
        const line = (a: number, b: number, lineWidth: number): Option => ({ type: 'line', shape: { x1: x(a), y1: box, x2: x(b), y2: box }, style: { stroke: colour, lineWidth } });
        return [
          ...(curve.length > 1 ? [{ type: 'polygon', shape: { points: [[x(low), floor], ...curve, [x(high), floor]] }, style: { fill: colour, opacity: p.dark ? 0.3 : 0.22 } }] : []),
          line(s.p5, s.p95, 1.2), line(s.q1, s.q3, 7), median,
        ];
      };
      return {
        height: 70 + all.length * rowHeight(rows, width, all.length > 10 ? 38 : 58),
        note: `n = ${new Set(counts).size === 1 ? `${sizes(counts)} a row` : `${counts.map(integer).join(', ')} (from the top)`}. ${[
          all.some((r) => r.spread.n >= kFew) ? 'Box: quartiles and median; whiskers: 5th to 95th percentile; curve: density.' : '',
          all.some((r) => r.spread.n < kFew) ? `Fewer than ${kFew} trials: each is a dot, the ring is their median.` : '',
          beyond > 0 ? `${integer(beyond)} beyond the axis.` : '',
        ].filter((text) => text !== '').join(' ')}`,
        columns: ['family', 'controller', 'point', of.key],
        rows: all.flatMap((r) => r.values.map((v) => [r.family, r.series.controller, r.series.point, v])),
        option: {
          grid: gridBox(), xAxis: axis(p, axisName(of), nice(low, high, marksIn(width))),
          yAxis: rowAxis(p, rows, width),
          tooltip: {
            formatter: ({ dataIndex }: { dataIndex: number }) => {
              const { series, family, spread: s } = all[dataIndex]!;
              return tip(`${series.short}, ${family}`, [
                ['n', integer(s.n)], ['median', withUnit(of, s.median)], ['mean', withUnit(of, s.mean)],
                ...(s.n < kFew ? [] : [['middle half', `${of.write(s.q1)} \u2026 ${withUnit(of, s.q3)}`], ['5 to 95 %', `${of.write(s.p5)} \u2026 ${withUnit(of, s.p95)}`]] as const),
                ['least, greatest', `${of.write(s.min)} \u2026 ${withUnit(of, s.max)}`],
              ], seriesColour(p, series.mark));
            },
          },
          series: [{
            type: 'custom', clip: true, data: all.map((_, i) => [low, i]),
            renderItem: ({ dataIndex: i }: { dataIndex: number }, api: { coord: (point: number[]) => number[]; size: (extent: number[]) => number[] }) => ({
              type: 'group', children: drawn(all[i]!, api.coord([low, i])[1] ?? 0, (api.size([0, 1])[1] ?? 40) * 0.5, (v) => api.coord([Math.min(Math.max(v, low), high), i])[0] ?? 0),
            }),
          }],
        },
      };
    },
  };
}
