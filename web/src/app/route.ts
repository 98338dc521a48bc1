// SPDX-License-Identifier: GPL-3.0-or-later
import { signal } from '@preact/signals';

export const places = ['start', 'relief', 'thermoform', 'zippable', 'evidence', 'machines', 'about'] as const;
export type Place = (typeof places)[number];

export function placeOf(hash: string): Place | null {
  const name = /^#\/([a-z]+)/.exec(hash)?.[1];
  return places.find((place) => place === name) ?? null;
}

export const place = signal<Place>('start');

export function go(next: Place): void {
  if (placeOf(location.hash) === next) place.value = next;
  else location.hash = `#/${next}`;
}

/** Follows the address; returns false where it names no place. */
export function startRouting(): boolean {
  const read = () => {
    const found = placeOf(location.hash);
    if (found) place.value = found;
    return found !== null;
  };
  addEventListener('hashchange', read);
  return read();
}
