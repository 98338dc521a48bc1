// SPDX-License-Identifier: GPL-3.0-or-later
// Where the size of the sheets comes from, and the ways to another one and back.
import type { LaserSheet } from '../../machines/laser_sheet';
import { sameBed } from '../../machines/laser_sheet';
import { Button, formatNumber, withUnit } from '../../ui';
import { isSetByHand } from './sheet_size';
import type { ZippableSession } from './zippable_session';

/** "400 × 400 mm". */
const size = (x_mm: unknown, y_mm: unknown): string =>
  withUnit([x_mm, y_mm].map((mm) => formatNumber(Number(mm))).join(' × '), 'mm');
const bedOf = ({ laser, bed_x_mm, bed_y_mm }: LaserSheet): string => `${laser}: ${size(bed_x_mm, bed_y_mm)}`;
const kerf = (mm: unknown): string => withUnit(formatNumber(Number(mm), 2), 'mm');

/** "Practice laser: 400 × 400 mm", or what is there instead of it. */
export function sheetWords(session: ZippableSession): string {
  const { sheets } = session;
  const laser = sheets.laser.value;
  const inForce = size(sheets.value('bed_x_mm'), sheets.value('bed_y_mm'));
  if (isSetByHand(session.document.value)) return `Set by hand: ${inForce}`;
  return laser ? bedOf(laser) : `${inForce}, as laid out before`;
}

export function SheetSize({ session }: { readonly session: ZippableSession }) {
  const { sheets } = session;
  const project = session.document.value;
  const [chosen, laser] = [sheets.chosen.value, sheets.laser.value];
  const byHand = isSetByHand(project);
  const { kerf_mm } = project.parameters;
  const ownKerf = typeof kerf_mm === 'number';
  const kerfDiffers =
    !ownKerf && chosen !== null && chosen.kerf_mm !== null && chosen.kerf_mm !== sheets.value('kerf_mm');
  const offered =
    chosen && (byHand || laser === null || !sameBed(laser, chosen) || kerfDiffers) ? chosen : null;
  return (
    <div class="sheet-size">
      <p role="status">{sheetWords(session)}</p>
      {!ownKerf && laser?.material ? (
        <p class="hint">
          Kerf {kerf(laser.kerf_mm)}: {laser.material}
        </p>
      ) : null}
      <div class="row">
        {offered ? (
          <Button size="small" onClick={() => sheets.useLaser()}>
            Use {bedOf(offered)}
            {kerfDiffers ? `, kerf ${kerf(offered.kerf_mm)}` : ''}
          </Button>
        ) : null}
        {byHand ? null : (
          <Button size="small" onClick={() => sheets.setByHand()}>
            Use another size
          </Button>
        )}
      </div>
    </div>
  );
}
