// SPDX-License-Identifier: GPL-3.0-or-later
// The relief's heights on their way to a mill, with their size in millimetres.
import type { JsonObject } from '../../jobs/contract';
import { safeFileName } from '../../shared/session/download';
import { outputOf } from '../../shared/session/full_solve';
import type { ReliefSession } from './relief_session';

/** Hands a height map to whoever runs mills, which crafts do not know; `size` in the words of mill jobs. */
export type SendToMill = (
  fileName: string,
  heightMap: Uint8Array<ArrayBuffer>,
  size: JsonObject,
) => Promise<void>;

/** Of the result in force: from black to white is all above its plate, and pixels stand where the relief's own are. */
export async function sendRelief(session: ReliefSession, send: SendToMill): Promise<void> {
  const size = session.result.value?.report['size_mm']; // another may be chosen while the file is made
  const thickness_mm =
    Array.isArray(size) && typeof size[2] === 'number'
      ? size[2] - Number(session.value('plate_mm'))
      : session.value('thickness_mm');
  const heightMap = await outputOf(session, 'heightmap.png', 'height map');
  const width = Array.isArray(size) && typeof size[0] === 'number' ? { width_mm: size[0] } : {};
  if (heightMap) await send(`${safeFileName(session.title)}.png`, heightMap, { thickness_mm, ...width });
}
