// Colours of the scene, on a light page and on a dark one.

import { palette } from '../theme';

export interface Colours {
  background: string; floor: string; grid: string; base: string; arm: string; object: string; moving: string; hit: string; goal: string; path: string; begin: string; ghost: string; wheel: string; plan: string;
}

export function colours(): Colours {
  return palette().dark
    ? { background: '#171b21', floor: '#1b2027', grid: '#2c343f', base: '#8794a6', arm: '#d7dde6', object: '#6b6257', moving: '#8a7450', hit: '#e2664c', goal: '#dcb45a', path: '#7fb0e6', begin: '#5d6570', ghost: '#cb64a3', wheel: '#4a525e', plan: '#4fb3a0' }
    : { background: '#eeece6', floor: '#f4f2ed', grid: '#d8d4c9', base: '#5d6b7e', arm: '#f7f8fa', object: '#b5ab9b', moving: '#cfae74', hit: '#c4472f', goal: '#c79a2b', path: '#27598f', begin: '#9db4cc', ghost: '#b8447b', wheel: '#3a424d', plan: '#1f8a78' };
}
