// Distribution of any metric, one row per controller and family: density above, box below; of few trials, each as a dot.

import { axis, kNarrow, nice, plain, rowAxis, tip, type FigureSpec } from '../chart';
import { choice } from '../dom';
import { integer, sizes, upper } from '../format';
import { axisName, kMetrics, metric, withUnit } from '../metrics';
import * as state from '../state';
import { density, spread, type Spread } from '../stats';
import { seriesColour, type Palette } from '../theme';
import { view } from '../view';
import type { Series } from '../data';

interface Row {
  series: Series;
  family: string;
  values: number[];
  spread: Spread;
}

function collect(key: string): Row[] {
  const { model, families, family, series } = view();
  const out: Row[] = [];
  for (const name of family === '' ? families : [family]) {
    for (const s of series) {
      const values = s.rows.filter((row) => model.trials.text('family', row) === name)
        .map((row) => model.trials.number(key, row)).filter(Number.isFinite);
      const summary = spread(values);
      if (summary !== null) out.push({ series: s, family: name, values, spread: summary });
    }
  }
  return out;
}

/** Of fewer values a density shows its kernel, and outer percentiles are single trials: they are drawn one by one. */
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

/** Metrics that some shown trial has. */
export function presentMetrics(): [string, string][] {
  const { model, series } = view();
  return kMetrics.filter((m) => series.some((s) => model.trials.any(m.key, s.rows))).map((m) => [m.key, axisName(m)]);
}

interface CustomApi {
  coord: (point: number[]) => number[];
  size: (extent: number[]) => number[];
}

export function distribution(id: string, first: string): FigureSpec {
  const key = `f.${id}`;
  state.setDefault(key, first);
  return {
    id,
    title: () => upper(metric(state.get(key)).name),
    caption: 'How the trials of each controller are spread, failures included. Choose any metric.',
    empty: 'No trial here has this metric.',
    controls: (redraw) => [choice('Metric', presentMetrics(), state.get(key), (value) => { state.set({ [key]: value }); redraw(); })],
    draw: (p: Palette, width: number) => {
      const of = metric(state.get(key));
      const all = collect(of.key);
      if (all.length === 0) return null;
      // The axis leaves out the last hundredth where a few values would squeeze all others.
      const low = Math.min(...all.map((r) => r.spread.min));
      const far = Math.max(...all.map((r) => r.spread.max));
      const near = Math.max(...all.map((r) => r.spread.p95));
      const high = far > low + 3 * (near - low) && near > low ? low + 1.6 * (near - low) : far;
      const beyond = all.reduce((sum, r) => sum + r.values.filter((v) => v > high).length, 0);
      const range = nice(low, high, width < kNarrow ? 4 : 8);
      const families = view().families.length > 1;
      const counts = all.map((r) => r.spread.n);
      return {
        height: 70 + all.length * (all.length > 10 ? 38 : 58),
        note: `n = ${new Set(counts).size === 1 ? `${sizes(counts)} a row` : `${counts.map(integer).join(', ')} (from the top)`}. ${[
          all.some((r) => r.spread.n >= kFew) ? 'Box: quartiles and median; whiskers: 5th to 95th percentile; curve: density.' : '',
          all.some((r) => r.spread.n < kFew) ? `Fewer than ${kFew} trials: each is a dot, the ring is their median.` : '',
        ].filter((text) => text !== '').join(' ')}`
          + (beyond > 0 ? ` ${integer(beyond)} beyond the axis.` : ''),
        columns: ['family', 'controller', 'point', of.key],
        rows: all.flatMap((r) => r.values.map((v) => [r.family, r.series.controller, r.series.point, v])),
        option: {
          grid: { left: 4, right: 24, top: 8, bottom: 8, outerBoundsMode: 'same', outerBoundsContain: 'all' },
          xAxis: axis(p, axisName(of), { ...range, nameGap: 28, axisLabel: { color: p.muted, fontSize: 11, hideOverlap: true, formatter: plain } }),
          yAxis: rowAxis(p, all.map((r) => ({ name: r.series.short, family: families ? r.family : '' })), width),
          tooltip: {
            trigger: 'item',
            formatter: ({ dataIndex }: { dataIndex: number }) => {
              const row = all[dataIndex] as Row;
              const s = row.spread;
              return tip(`${row.series.short}, ${row.family}`, [
                ['n', integer(s.n)], ['median', withUnit(of, s.median)], ['mean', withUnit(of, s.mean)],
                ...(s.n < kFew ? [] : [['middle half', `${of.write(s.q1)} \u2026 ${withUnit(of, s.q3)}`], ['5 to 95 %', `${of.write(s.p5)} \u2026 ${withUnit(of, s.p95)}`]] as const),
                ['least, greatest', `${of.write(s.min)} \u2026 ${withUnit(of, s.max)}`],
              ], seriesColour(p, row.series.mark));
            },
          },
          series: [{
            type: 'custom', clip: true, data: all.map((_, i) => [low, i]),
            renderItem: (params: { dataIndex: number }, api: CustomApi) => {
              const row = all[params.dataIndex] as Row;
              const colour = seriesColour(p, row.series.mark);
              const [, middle = 0] = api.coord([low, params.dataIndex]);
              const tall = (api.size([0, 1])[1] ?? 40) * 0.5;
              const x = (v: number): number => api.coord([Math.min(Math.max(v, low), high), params.dataIndex])[0] ?? 0;
              const floor = middle + tall * 0.18;
              if (row.spread.n < kFew) {
                const inside = row.values.filter((v) => v <= high).sort((a, b) => a - b).map(x);
                const levels = pile(inside, 6.5);
                const room = Math.min(6.5, (tall * 1.1) / Math.max(1, ...levels));
                return {
                  type: 'group',
                  children: [
                    ...inside.map((cx, i) => ({ type: 'circle', shape: { cx, cy: floor - (levels[i] ?? 0) * room, r: 3 }, style: { fill: colour, opacity: 0.62 } })),
                    { type: 'circle', shape: { cx: x(row.spread.median), cy: middle + tall * 0.48, r: 4.5 }, style: { fill: p.surface, stroke: colour, lineWidth: 2 } },
                  ],
                };
              }
              const curve = density(row.values, low, high, 90).map(([v, d]) => [x(v), floor - d * tall * 0.95]);
              const box = middle + tall * 0.48;
              const s = row.spread;
              const line = (a: number, b: number, lineWidth: number) =>
                ({ type: 'line', shape: { x1: x(a), y1: box, x2: x(b), y2: box }, style: { stroke: colour, lineWidth } });
              return {
                type: 'group',
                children: [
                  ...(curve.length > 1 ? [{
                    type: 'polygon', shape: { points: [[x(low), floor], ...curve, [x(high), floor]] },
                    style: { fill: colour, opacity: p.dark ? 0.3 : 0.22 },
                  }] : []),
                  line(s.p5, s.p95, 1.2), line(s.q1, s.q3, 7),
                  { type: 'circle', shape: { cx: x(s.median), cy: box, r: 4.5 }, style: { fill: p.surface, stroke: colour, lineWidth: 2 } },
                ],
              };
            },
          }],
        },
      };
    },
  };
}
