// SPDX-License-Identifier: GPL-3.0-or-later
// Sheets of the plan on their way to a machine, one at a time: a bed takes no more.
import { unzipSync } from 'fflate';
import { figure } from '../../../shared/session/report';
import { safeFileName } from '../../../shared/session/download';
import { planBytes } from '../make_product';
import type { ZippableSession } from '../zippable_session';

/** Hands a drawing to whoever runs machines, which crafts do not know. */
export type SendToMachine = (fileName: string, drawing: Uint8Array<ArrayBuffer>) => Promise<void>;

/** How many sheets the plan in force has; 1 while there is none. */
export const sheetCount = (session: ZippableSession): number =>
  Math.max(1, figure(session.plan.value?.report ?? {}, 'sheets') ?? 1);

/** "Sheet 2", of two fabrics "Sheet 2, colour 1". Counted from 0. */
export function sheetName({ plan }: Pick<ZippableSession, 'plan'>, sheet: number): string {
  const fabrics = plan.value?.report['sheet_fabrics'];
  const fabric = Array.isArray(fabrics) ? fabrics[sheet] : undefined;
  return `Sheet ${sheet + 1}${typeof fabric === 'number' ? `, colour ${fabric}` : ''}`;
}

/** Out of the plan's archive; undefined where it has no such sheet. Counted from 0. */
export function sheetOf(archive: Uint8Array, sheet: number): Uint8Array<ArrayBuffer> | undefined {
  const name = `sheet_${sheet + 1}.svg`;
  const found = unzipSync(archive, { filter: (file) => file.name === name })[name];
  return found && new Uint8Array(found);
}

export async function sendSheet(session: ZippableSession, sheet: number, send: SendToMachine): Promise<void> {
  const plan = await planBytes(session, 'plan.svg', 'plan');
  if (plan === null) return;
  const title = safeFileName(session.title);
  if (sheetCount(session) === 1) return await send(`${title}.svg`, plan);
  const archive = await planBytes(session, 'sheets.zip', 'sheets');
  const drawing = archive && sheetOf(archive, sheet);
  if (drawing) await send(`${title}, ${sheetName(session, sheet).toLowerCase()}.svg`, drawing);
}
