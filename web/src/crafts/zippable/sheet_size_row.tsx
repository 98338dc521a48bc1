// SPDX-License-Identifier: GPL-3.0-or-later
// Where the size of the sheets comes from, and the ways to another one and back.
import type { LaserSheet } from '../../machines/laser_sheet';
import { sameBed } from '../../machines/laser_sheet';
import { Button, formatNumber, withUnit } from '../../ui';
import { isSetByHand, laserOf } from './sheet_size';
import type { ZippableSession } from './zippable_session';

/** "400 × 400 mm". */
const size = (x_mm: unknown, y_mm: unknown): string =>
  withUnit([x_mm, y_mm].map((mm) => formatNumber(Number(mm))).join(' × '), 'mm');
const bedOf = ({ laser, bed_x_mm, bed_y_mm }: LaserSheet): string => `${laser}: ${size(bed_x_mm, bed_y_mm)}`;
const kerf = (mm: unknown): string => withUnit(formatNumber(Number(mm), 2), 'mm');

/** "Practice laser: 400 × 400 mm", or what is there instead of it. */
export function sheetWords(session: ZippableSession): string {
  const project = session.document.value;
  const laser = laserOf(project, session.laser.value);
  const inForce = size(session.planValue('bed_x_mm'), session.planValue('bed_y_mm'));
  if (isSetByHand(project)) return `Set by hand: ${inForce}`;
  return laser ? bedOf(laser) : `${inForce}, as laid out before`;
}

export function SheetSize({ session }: { readonly session: ZippableSession }) {
  const project = session.document.value;
  const chosen = session.laser.value;
  const laser = laserOf(project, chosen);
  const byHand = isSetByHand(project);
  const { kerf_mm } = project.parameters;
  const ownKerf = typeof kerf_mm === 'number';
  const kerfDiffers =
    !ownKerf && chosen !== null && chosen.kerf_mm !== null && chosen.kerf_mm !== session.planValue('kerf_mm');
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
          <Button size="small" onClick={() => session.layOutForLaser()}>
            Use {bedOf(offered)}
            {kerfDiffers ? `, kerf ${kerf(offered.kerf_mm)}` : ''}
          </Button>
        ) : null}
        {byHand ? null : (
          <Button size="small" kind="quiet" onClick={() => useAnother(session)}>
            Use another size
          </Button>
        )}
      </div>
    </div>
  );
}

/** The size in force becomes one that is set by hand, to be changed in the fields below. */
function useAnother(session: ZippableSession): void {
  const [bed_x_mm, bed_y_mm] = ['bed_x_mm', 'bed_y_mm'].map((name) => session.planValue(name));
  if (typeof bed_x_mm === 'number' && typeof bed_y_mm === 'number')
    session.setParameters({ bed_x_mm, bed_y_mm }, 'Use another sheet size');
}
