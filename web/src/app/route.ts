// SPDX-License-Identifier: GPL-3.0-or-later
import { signal } from '@preact/signals';
import { tokenIn } from '../jobs/native_connection';

const places = ['start', 'relief', 'thermoform', 'zippable', 'evidence', 'machines', 'about'] as const;
export type Place = (typeof places)[number];

function placeOf(hash: string): Place | null {
  const name = /^#\/([a-z]+)/.exec(hash)?.[1];
  return places.find((place) => place === name) ?? null;
}

export const place = signal<Place>('start');

export function go(next: Place): void {
  if (placeOf(location.hash) === next) place.value = next;
  else location.hash = `#/${next}`;
}

/** Follows the address; returns false where it names no place. `mayReload` saves what a load would lose; false: it could not. */
export function startRouting(mayReload: () => Promise<boolean>): boolean {
  const read = () => {
    const found = placeOf(location.hash);
    if (found) place.value = found;
    return found !== null;
  };
  addEventListener('hashchange', () => {
    // The address of a worker that was started again: only the fragment is another one, so the browser loads nothing, and tokens
    // are taken up at the start alone. A load takes it out of the address, and no load is such an event: this happens once.
    if (tokenIn(location.hash)) void mayReload().then((may) => may && location.reload());
    else read();
  });
  return read();
}
