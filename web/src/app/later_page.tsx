// SPDX-License-Identifier: GPL-3.0-or-later
import { Button, Icon } from '../ui';
import type { Craft } from './crafts';
import { go } from './route';

/** An honest page for a craft that is still to come. */
export function LaterPage({ craft }: { craft: Craft }) {
  return (
    <main class="view start" aria-label={craft.title}>
      <div class="later-page">
        <span class="later-icon">
          <Icon name={craft.icon} />
        </span>
        <h1>{craft.title} is not here yet</h1>
        <p>{craft.pitch}</p>
        <p>
          This version makes reliefs, thermoforms and zippables. Nothing you make now will be lost when{' '}
          {craft.title} arrives.
        </p>
        <Button onClick={() => go('relief')}>Make a relief</Button>
      </div>
    </main>
  );
}
