// Success rate against what makes a world hard, in bins of about equal size.

import { axis, curveNames, endLabels, kFont, kNarrow, nice, plain, smallMultiples, tip, whisker, type FigureSpec, type Option } from '../chart';
import { choice } from '../dom';
import { integer, percent, percentRange, sizes } from '../format';
import { axisName, kMetrics, metric } from '../metrics';
import * as state from '../state';
import { wilson } from '../stats';
import { dashOf, seriesColour, seriesInk, symbolOf, type Palette } from '../theme';
import { view } from '../view';

const kBins = 6;
/** Intervals of more lines than this hide each other: each is then drawn in a plot of its own. */
const kTogether = 4;

/** Inner edges of bins that hold about equally many of `values`; distinct. */
function edges(values: number[]): number[] {
  const sorted = [...values].sort((a, b) => a - b);
  const first = sorted[0] ?? 0;
  const out: number[] = [];
  for (let i = 1; i < kBins; ++i) {
    const edge = sorted[Math.floor((i * sorted.length) / kBins)] ?? first;
    if (edge > (out[out.length - 1] ?? first)) out.push(edge);
  }
  return out;
}

interface Cell { x: number; hits: number; n: number; low: number; high: number; from: number; to: number }

export function difficulty(): FigureSpec {
  state.setDefault('f.difficulty', 'goal_distance_m');
  return {
    id: 'difficulty',
    title: () => `Success against ${metric(state.get('f.difficulty')).name}`,
    caption: 'Worlds in bins of about equal number; each point is the success rate in its bin, at the mean difficulty, with its 95 % interval.',
    empty: 'Nothing varies here among the worlds shown.',
    controls: (redraw) => {
      const { model, series } = view();
      const options = kMetrics.filter((m) => m.of === 'world').map((m) => m.key).filter((key) => series.some((s) => model.trials.any(key, s.rows)));
      return [choice('Against', options.map((key) => [key, axisName(metric(key))] as const), state.get('f.difficulty'),
        (value) => { state.set({ 'f.difficulty': value }); redraw(); })];
    },
    draw: (p: Palette, width: number) => {
      const of = metric(state.get('f.difficulty'));
      const { model, series } = view();
      const t = model.trials;
      const all = series.flatMap((s) => s.rows.map((row) => t.number(of.key, row)).filter(Number.isFinite));
      const inner = edges(all);
      if (all.length === 0 || inner.length === 0) return null;
      const lines = series.map((s) => {
        const cells: Cell[] = Array.from({ length: inner.length + 1 }, () => ({ x: 0, hits: 0, n: 0, low: 0, high: 0, from: Infinity, to: -Infinity }));
        for (const row of s.rows) {
          const x = t.number(of.key, row);
          if (!Number.isFinite(x)) continue;
          const cell = cells[inner.filter((edge) => x >= edge).length] as Cell;
          cell.x += x;
          cell.n += 1;
          cell.hits += t.success(row) ? 1 : 0;
          cell.from = Math.min(cell.from, x);
          cell.to = Math.max(cell.to, x);
        }
        for (const cell of cells) {
          const w = wilson(cell.hits, cell.n);
          cell.x /= cell.n;
          cell.low = w.low;
          cell.high = w.high;
        }
        return { s, cells: cells.filter((cell) => cell.n > 0) };
      }).filter((line) => line.cells.length > 0);
      const perCell = lines.flatMap((line) => line.cells.map((cell) => cell.n));
      const centres = lines.flatMap((line) => line.cells.map((cell) => cell.x));
      const [least, most] = [Math.min(...centres), Math.max(...centres)];
      // Side by side, since intervals of equal place would hide one another.
      const together = lines.length <= kTogether;
      const beside = (i: number): number => (together ? (i - (lines.length - 1) / 2) * (most - least) * (width < kNarrow ? 0.022 : 0.008) : 0);
      const named = curveNames(p, lines.map((line) => line.s.short), width);
      const unused = series.reduce((sum, s) => sum + s.rows.length, 0) - all.length;
      const xAxis = axis(p, axisName(of), { scale: true, nameGap: 28 });
      const yAxis = axis(p, '', { min: 0, max: 1, interval: 0.25, axisLabel: { color: p.muted, formatter: (v: number) => `${Math.round(100 * v)} %` } });
      const tooltip = {
        trigger: 'item',
        formatter: ({ seriesName, dataIndex }: { seriesName: string; dataIndex: number }) => {
          const line = lines.find((l) => l.s.short === seriesName);
          const c = line?.cells[dataIndex];
          if (line === undefined || c === undefined) return '';
          return tip(line.s.short, [
            [of.name, `${of.write(c.from)} \u2026 ${of.write(c.to)} ${of.unit}`],
            ['success', `${integer(c.hits)} of ${integer(c.n)}: ${percent(c.hits / c.n)}`],
            ['95 % interval', percentRange(c.low, c.high)],
          ], seriesColour(p, line.s.mark));
        },
      };
      const drawn = (i: number): Option[] => {
        const { s, cells } = lines[i]!;
        const colour = seriesColour(p, s.mark);
        return [
          {
            type: 'custom', silent: true, data: cells.map((c) => [c.x + beside(i), c.low, c.high]), encode: { x: 0, y: [1, 2] },
            renderItem: whisker(colour, false, 1.6), tooltip: { show: false },
          },
          {
            name: s.short, type: 'line', data: cells.map((c) => [c.x + beside(i), c.hits / c.n]), symbol: together ? symbolOf(s.mark) : 'circle', symbolSize: together ? 9 : 7, clip: false,
            lineStyle: { color: colour, width: 1.6, type: together ? dashOf(s.mark) : 'solid' }, itemStyle: { color: colour },
            emphasis: { disabled: true }, z: 4,
          },
        ];
      };
      return {
        note: `n = ${sizes(perCell)} trials a point; 95 % Wilson.`
          + (unused > 0 ? ` ${integer(unused)} trials have no such value.` : ''),
        columns: ['controller', 'point', `${of.key}_from`, `${of.key}_to`, `${of.key}_mean`, 'successes', 'n', 'success_rate', 'success_low', 'success_high'],
        rows: lines.flatMap(({ s, cells }) => cells.map((c) => [s.controller, s.point, c.from, c.to, c.x, c.hits, c.n, c.hits / c.n, c.low, c.high])),
        ...(together ? {
          height: 350 + named.above,
          option: {
            grid: named.grid, ...named.option, yAxis, tooltip, textStyle: { fontFamily: kFont },
            xAxis: { ...xAxis, ...nice(least, most, width < kNarrow ? 4 : 7), max: most + 0.02 * (most - least), axisLabel: { color: p.muted, fontSize: 11, showMaxLabel: false, formatter: plain } },
            series: [...lines.flatMap((_, i) => drawn(i)), ...endLabels(lines.map(({ s, cells }, i) => {
              const end = cells[cells.length - 1];
              return { name: s.short, x: (end?.x ?? 0) + beside(i), y: (end?.hits ?? 0) / (end?.n ?? 1), colour: seriesInk(p, s.mark) };
            }), named.room)],
          },
        } : smallMultiples(width, lines.map(({ s }) => ({ title: s.short, colour: seriesInk(p, s.mark) })),
          { ...xAxis, ...nice(least, most, 3), axisLabel: { color: p.muted, formatter: plain } }, yAxis, drawn, tooltip)),
      };
    },
  };
}
