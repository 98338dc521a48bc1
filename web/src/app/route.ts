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

export interface RouteActions {
  /** Saves what a load would lose; false: it could not. */
  readonly mayReload: () => Promise<boolean>;
  /** Tells what is no place but something to open, once. */
  readonly isLink: (hash: string) => boolean;
  readonly openLink: (hash: string) => void;
}

/** Follows the address; returns false where it names no place and nothing to open. */
export function startRouting({ mayReload, isLink, openLink }: RouteActions): boolean {
  const read = () => {
    const { hash, pathname, search } = location;
    if (isLink(hash)) {
      // Out of the address, so that neither a reload nor the way back opens it once more.
      history.replaceState(null, '', `${pathname}${search}#/${place.value}`);
      openLink(hash);
      return true;
    }
    const found = placeOf(hash);
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
