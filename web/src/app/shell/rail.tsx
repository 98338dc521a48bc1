// SPDX-License-Identifier: GPL-3.0-or-later
import { Icon } from '../../ui';
import { crafts } from '../crafts';
import { place } from '../route';

export function Rail() {
  return (
    <nav class="rail" aria-label="Rooms">
      {crafts.map((craft) => (
        <>
          {craft.apart ? <hr key="line" /> : null}
          <a
            key={craft.place}
            href={`#/${craft.place}`}
            aria-current={place.value === craft.place ? 'page' : undefined}
          >
            <Icon name={craft.icon} />
            {craft.title}
          </a>
        </>
      ))}
    </nav>
  );
}
