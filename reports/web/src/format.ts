// Numbers for a person: sensible digits, a true minus sign, thin spaces between thousands.

const kThin = '\u202f';
const kMinus = '\u2212';
export const kNone = '\u2013';

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

/** 0.635 -> "63.5 %". */
export function percent(share: number | null | undefined, decimals = 1): string {
  if (share === null || share === undefined || !Number.isFinite(share)) return kNone;
  return `${percentNumber(share, decimals)}\u00a0%`;
}

export function percentNumber(share: number, decimals = 1): string {
  return fixed(100 * share, share === 0 || share === 1 ? 0 : decimals);
}

/** "56.7–69.9 %". */
export function percentRange(low: number | null, high: number | null): string {
  if (low === null || high === null || !Number.isFinite(low) || !Number.isFinite(high)) return kNone;
  return `${fixed(100 * low, 1)}\u2013${fixed(100 * high, 1)}\u00a0%`;
}

/** With its sign, unless it is written as nothing: "+0.3", "0.0". */
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

/** "once", "twice", "7 times". */
export function times(count: number): string {
  return count === 1 ? 'once' : count === 2 ? 'twice' : count === 0 ? 'never' : `${integer(count)}\u00a0times`;
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

export function seconds(value: number | null | undefined): string {
  return value === null || value === undefined || !Number.isFinite(value) ? kNone : `${fixed(value, value < 10 ? 2 : 1)}\u00a0s`;
}

/** A column of any CSV: quotes where needed; numbers with every digit. */
export function csv(columns: readonly string[], rows: readonly (readonly (string | number | null)[])[]): string {
  const cell = (value: string | number | null): string => {
    if (value === null || (typeof value === 'number' && Number.isNaN(value))) return '';
    const text = String(value);
    return /[",\n\r]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
  };
  return [columns, ...rows].map((row) => row.map(cell).join(',')).join('\n') + '\n';
}
