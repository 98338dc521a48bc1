// SPDX-License-Identifier: GPL-3.0-or-later
// What the picture takes from the style sheet's tokens, with the tokens' own values where there are none.
import type { ColourMapName, Theme, Vec3 } from './api';
import { parseColour } from './mesh/colour_map';

export interface Palette {
  dark: boolean;
  /** sRGB 0..1. */
  viewCentre: Vec3;
  viewRim: Vec3;
  accent: Vec3;
  live: Vec3;
  maps: Partial<Record<ColourMapName, string>>;
}

const FALLBACK = {
  light: { '--view-a': '#efece6', '--view-b': '#d9d4cb', '--accent': '#2a58b5', '--live': '#b05e00' },
  dark: { '--view-a': '#35322e', '--view-b': '#1d1b19', '--accent': '#8fb3ff', '--live': '#f2ae4b' },
} as const;

function isDark(theme: Theme, element: Element | null): boolean {
  if (theme !== 'auto') return theme === 'dark';
  const chosen = element?.closest('[data-theme]')?.getAttribute('data-theme');
  if (chosen === 'dark' || chosen === 'light') return chosen === 'dark';
  return typeof matchMedia === 'function' && matchMedia('(prefers-color-scheme: dark)').matches;
}

export function readPalette(theme: Theme, element: Element | null): Palette {
  const dark = isDark(theme, element);
  // A forced theme may differ from the page's: then only the fallbacks speak for it.
  const style = element && dark === isDark('auto', element) ? getComputedStyle(element) : null;
  const colour = (name: keyof (typeof FALLBACK)['light']): Vec3 => {
    const fallback = FALLBACK[dark ? 'dark' : 'light'][name];
    const [r, g, b] = parseColour(style?.getPropertyValue(name) ?? '') ?? parseColour(fallback) ?? [0, 0, 0];
    return [r / 255, g / 255, b / 255];
  };
  const maps: Palette['maps'] = {};
  for (const name of ['error', 'thickness', 'signed'] as const) {
    const token = style?.getPropertyValue(`--map-${name}`);
    if (token) maps[name] = token;
  }
  return {
    dark,
    viewCentre: colour('--view-a'),
    viewRim: colour('--view-b'),
    accent: colour('--accent'),
    live: colour('--live'),
    maps,
  };
}

/** A CSS colour or the name of a token, sRGB 0..1. */
export function resolveColour(colour: string, element: Element | null): Vec3 {
  const text =
    colour.startsWith('--') && element ? getComputedStyle(element).getPropertyValue(colour) : colour;
  const [r, g, b] = parseColour(text) ?? [176, 94, 0];
  return [r / 255, g / 255, b / 255];
}

export function prefersReducedMotion(): boolean {
  return typeof matchMedia === 'function' && matchMedia('(prefers-reduced-motion: reduce)').matches;
}
