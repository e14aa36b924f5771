// Numbers for a person: sensible digits, a true minus sign, thin spaces between thousands.

const kThin = '\u202f';
const kMinus = '\u2212';
const kNone = '\u2013';

export function integer(value: number): string {
  if (!Number.isFinite(value)) return kNone;
  const digits = Math.abs(Math.round(value)).toString();
  const text = digits.length > 4 ? digits.replace(/\B(?=(\d{3})+$)/g, kThin) : digits;
  return value < 0 && digits !== '0' ? kMinus + text : text;
}

/** `digits` significant ones, without an exponent between 1e-4 and 1e7. */
export function significant(value: number | null | undefined, digits = 3): string {
  if (value === null || value === undefined || Number.isNaN(value)) return kNone;
  if (value === Infinity) return '\u221e';
  if (value === -Infinity) return kMinus + '\u221e';
  if (value === 0) return '0';
  const size = Math.abs(value);
  const sign = value < 0 ? kMinus : '';
  if (size < 1e-4 || size >= 1e7) {
    const [mantissa, exponent] = size.toExponential(digits - 1).split('e');
    return `${sign}${mantissa}e${exponent?.replace('+', '').replace('-', kMinus)}`;
  }
  const rounded = Number(size.toPrecision(digits));
  const decimals = Math.max(0, digits - 1 - Math.floor(Math.log10(rounded)));
  return rounded >= 10000 ? sign + integer(rounded) : sign + rounded.toFixed(decimals);
}

export function fixed(value: number | null | undefined, decimals: number): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return significant(value);
  const text = Math.abs(value).toFixed(decimals);
  return (value < 0 && Number(text) !== 0 ? kMinus : '') + text;
}

/** More decimals of a percentage than this are never written. */
const kMostDecimals = 6;

/** Half a unit of the last decimal is rounded up, also where its binary form lies below: 0.8235 is 82.4 %, however it was computed. */
function percentWith(share: number, decimals: number): string {
  return fixed(Math.round(Number((100 * share * 10 ** decimals).toPrecision(12))) / 10 ** decimals, decimals);
}

/** 0.635 -> "63.5 %". */
export function percent(share: number | null | undefined): string {
  if (share === null || share === undefined || !Number.isFinite(share)) return kNone;
  return `${percentNumber(share)}\u00a0%`;
}

/** One decimal, or as many as tell a share from none and from all: 1 of 10,000 is 0.01 %. */
export function percentNumber(share: number): string {
  if (share === 0 || share === 1) return fixed(100 * share, 0);
  for (let decimals = 1; ; ++decimals) {
    const text = percentWith(share, decimals);
    if (decimals === kMostDecimals || (Number(text) !== 0 && Number(text) !== 100)) return text;
  }
}

/** "56.7–69.9 %": one decimal, or as many as tell the ends apart. */
export function percentRange(low: number | null, high: number | null): string {
  if (low === null || high === null || !Number.isFinite(low) || !Number.isFinite(high)) return kNone;
  let decimals = 1;
  while (low < high && decimals < kMostDecimals && percentWith(low, decimals) === percentWith(high, decimals)) ++decimals;
  return `${percentWith(low, decimals)}\u2013${percentWith(high, decimals)}\u00a0%`;
}

/** Writes a value with its sign, unless its digits are zeros: "+0.3", "0.0". */
export function signed(value: number, write: (v: number) => string): string {
  const text = write(value);
  return (value > 0 && /[1-9]/.test(text) ? '+' : '') + text;
}

export function probability(p: number): string {
  return p < 0.001 ? 'p\u00a0<\u00a00.001' : `p\u00a0=\u00a0${fixed(p, p < 0.01 ? 4 : 3)}`;
}

export function plural(count: number, one: string, many = one + 's'): string {
  return `${integer(count)}\u00a0${count === 1 ? one : many}`;
}

/** What was thrown, in words. */
export function said(error: unknown): string {
  return error instanceof Error ? error.message : String(error);
}

/** "time to goal" -> "Time to goal". */
export function upper(text: string): string {
  return text.charAt(0).toUpperCase() + text.slice(1);
}

export function list(words: readonly string[]): string {
  if (words.length <= 1) return words[0] ?? '';
  return `${words.slice(0, -1).join(', ')} and ${words[words.length - 1]}`;
}

/** "33" or "33 to 34": the sizes of several groups. */
export function sizes(counts: readonly number[]): string {
  const [low, high] = [Math.min(...counts), Math.max(...counts)];
  return low === high ? integer(low) : `${integer(low)} to ${integer(high)}`;
}

export interface Table { columns: readonly string[]; rows: readonly (readonly (string | number | null)[])[] }

/** Quotes where needed; numbers with every digit. */
export function csv({ columns, rows }: Table): string {
  const cell = (value: string | number | null): string => {
    if (value === null || (typeof value === 'number' && Number.isNaN(value))) return '';
    const text = String(value);
    return /[",\n\r]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
  };
  return [columns, ...rows].map((row) => row.map(cell).join(',')).join('\n') + '\n';
}
