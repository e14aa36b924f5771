// Shares of gains as bars with their errors, the greatest first.

import { axis, gridBox, nice, plain, rowAxis, tip, tipOf, whiskers, type Drawing } from '../chart';
import { percent } from '../format';
import { seriesColour, type Palette } from '../theme';

/** `error`: one standard error; null where there is none. */
export interface Share { name: string; key: string; share: number; error: number | null }

export function shareBars(p: Palette, width: number, shares: readonly Share[], note: string): Drawing {
  const bars = [...shares].sort((a, b) => b.share - a.share);
  const most = Math.min(1, Math.max(...bars.map((bar) => bar.share + (bar.error ?? 0))));
  const colour = seriesColour(p, 0);
  return {
    height: 60 + 26 * bars.length,
    note,
    columns: ['gain', 'share', 'error'],
    rows: bars.map((bar) => [bar.key, bar.share, bar.error]),
    option: {
      grid: gridBox(), xAxis: axis(p, '', nice(0, Math.max(most, 0.05)), (v) => `${plain(100 * v)} %`), yAxis: rowAxis(p, bars, width),
      tooltip: tipOf((bar: Share) => tip(bar.name, [['share', percent(bar.share)], ...(bar.error === null ? [] : [['error', percent(bar.error)] as const])], colour)),
      series: [
        { type: 'bar', barWidth: 12, data: bars.map((of, i) => ({ value: [of.share, String(i)], of, itemStyle: { color: colour, opacity: 0.75 } })) },
        whiskers(bars.flatMap((bar, i) => (bar.error === null ? [] : [[Math.max(0, bar.share - bar.error), Math.min(1, bar.share + bar.error), i]])), p.ink, { level: true }),
      ],
    },
  };
}
