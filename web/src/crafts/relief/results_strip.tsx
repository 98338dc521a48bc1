// SPDX-License-Identifier: GPL-3.0-or-later
import { formatFixed } from '../../ui';
import type { CraftResult } from '../../shared/session/craft_document';
import { CraftStrip } from '../../shared/panels/craft_strip';
import { figure } from '../../shared/session/report';
import { earlierResults, relief } from './relief_document';
import type { ReliefSession } from './relief_session';
import { solvedLine } from './report';

const titles = {
  solving: 'Solving the relief',
  opening: 'Opening the model',
  exporting: 'Making the file',
  done: 'Relief ready',
  empty: 'No relief yet',
  failed: 'The relief was not made',
};

export const ResultsStrip = ({ session }: { session: ReliefSession }) => (
  <CraftStrip
    session={session}
    titles={titles}
    detailOf={({ seconds, report }) => solvedLine(seconds, report)}
    cornersOf={({ mesh }) => mesh.indices.length}
    usualParameter="thickness_mm"
    figureOf={errorText}
    figureName="mean shading difference"
    results={earlierResults(session.document.value, session.subject.value)}
    onRestore={(one, label) => session.services.projects.do(relief.restoreResult(one, label))}
  />
);

function errorText({ report }: CraftResult): string {
  const error = figure(report, 'normal_error_mean_deg');
  return error === null ? '' : `${formatFixed(error, 1)}°`;
}
