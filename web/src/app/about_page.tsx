// SPDX-License-Identifier: GPL-3.0-or-later
import { useEffect, useState } from 'preact/hooks';
import type { Services } from '../shared/session/services';
import type { Licence } from '../../scripts/licences';
import { solverParts } from './solver_parts';

export function AboutPage({ services }: { services: Services }) {
  const [licences, setLicences] = useState<readonly Licence[]>([]);
  useEffect(() => {
    void import('virtual:licences').then((module) => setLicences(module.default));
  }, []);
  return (
    <main class="view start" aria-label="About">
      <div class="start-inner prose">
        <h1>About Formwright</h1>
        <p>
          Formwright turns 3D models into things made by hand-sized machines. It runs in this page, or,
          faster, in its worker program on your own machine. Models are never sent anywhere else.
        </p>
        <p>Version {services.catalog.value?.version ?? 'unknown'}.</p>
        <h2>Licence</h2>
        <p>
          Formwright is free software: you can redistribute it and modify it under the terms of the GNU
          General Public License, version 3 or any later version. It comes without any warranty.
        </p>
        <h2>The method</h2>
        <p>
          Reliefs: C. Schüller, D. Panozzo, O. Sorkine-Hornung, “Appearance-mimicking surfaces”, ACM
          Transactions on Graphics 33 (6), 2014.
        </p>
        <h2>Programs in the solver</h2>
        <ul class="licence-list">
          {solverParts.map(({ name, licence, use }) => (
            <li key={name}>
              <strong>{name}</strong> <span>{licence}</span> <span>{use}</span>
            </li>
          ))}
        </ul>
        <h2>Programs in the page</h2>
        {licences.map((entry) => (
          <details key={entry.name} class="licence">
            <summary>
              <strong>{entry.name}</strong> <span>{entry.version}</span> <span>{entry.licence}</span>
            </summary>
            <pre tabIndex={0}>{entry.notice || 'The package carries no licence text.'}</pre>
          </details>
        ))}
      </div>
    </main>
  );
}
