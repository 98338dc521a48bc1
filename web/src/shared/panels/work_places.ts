// SPDX-License-Identifier: GPL-3.0-or-later
// How many simulations of a job run where.
import type { WorkPlace } from '../../jobs/contract';
import { formatCount } from '../../ui';

/** "Simulations: this computer 2 running, 31 done; lab-b 1 running"; undefined while there are none. */
export function placesText(places: readonly WorkPlace[] = []): string | undefined {
  const texts = places.flatMap(({ name, running, done }) => {
    const counts = [
      ...(running > 0 ? [`${formatCount(running)} running`] : []),
      ...(done > 0 ? [`${formatCount(done)} done`] : []),
    ];
    return counts.length > 0 ? [`${name || 'this computer'} ${counts.join(', ')}`] : [];
  });
  return texts.length > 0 ? `Simulations: ${texts.join('; ')}` : undefined;
}
