// SPDX-License-Identifier: GPL-3.0-or-later
import { Icon, tipHandlers } from '../ui';
import { crafts, notYet } from './crafts';
import { place } from './route';

export function Rail() {
  return (
    <nav class="rail" aria-label="Places">
      {crafts.map((craft) => (
        <>
          {craft.apart ? <hr key="line" /> : null}
          <a
            key={craft.place}
            href={`#/${craft.place}`}
            class={craft.available ? '' : 'later'}
            aria-current={place.value === craft.place ? 'page' : undefined}
            aria-label={craft.available ? craft.title : `${craft.title}, not in this version yet`}
            {...tipHandlers(craft.available ? undefined : notYet)}
          >
            <Icon name={craft.icon} />
            {craft.title}
          </a>
        </>
      ))}
    </nav>
  );
}
