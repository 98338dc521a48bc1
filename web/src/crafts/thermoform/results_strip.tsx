// SPDX-License-Identifier: GPL-3.0-or-later
import { formatCount, formatDuration, formatNumber, withUnit } from '../../ui';
import type { CraftResult } from '../../shared/session/craft_document';
import { CraftStrip } from '../../shared/panels/craft_strip';
import { figure } from '../../shared/session/report';
import { simulate, thermoform } from './thermoform_document';
import type { ThermoformSession } from './thermoform_session';

export function ResultsStrip({ session }: { session: ThermoformSession }) {
  const activity = session.activity.value;
  const own = session.operationNamed(simulate)?.parameters.properties ?? {};
  return (
    <CraftStrip
      session={session}
      titles={{
        solving: 'Forming the sheet',
        opening: 'Opening the model',
        exporting: activity.kind === 'idle' ? '' : `Making the ${activity.name}`,
        done: 'Sheet formed',
        empty: 'No sheet yet',
        failed: 'The sheet was not formed',
      }}
      detailOf={formedLine}
      cornersOf={({ sheet }) => sheet.indices.length}
      usualParameter="sheet_thickness_mm"
      figureOf={thinnest}
      figureName="thinnest place"
      onRestore={(one, label) =>
        session.services.projects.do(thermoform.restoreResult(one, label, (name) => name in own))
      }
    />
  );
}

const thinnest = ({ report }: CraftResult): string => {
  const thin = figure(report, 'thickness_min_mm');
  return thin === null ? '' : withUnit(formatNumber(thin, 2), 'mm');
};

/** "10,240 triangles, 8.9 s in the worker program". */
function formedLine({ report, seconds, backend }: CraftResult): string {
  const triangles = figure(report, 'triangles');
  const where = backend === 'native' ? 'in the worker program' : 'in the browser';
  const time = `${formatDuration(seconds)} ${where}`;
  return triangles === null ? time : `${formatCount(triangles)} triangles, ${time}`;
}
