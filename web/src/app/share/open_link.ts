// SPDX-License-Identifier: GPL-3.0-or-later
// Opens a link to a sample as a new project. What is open is saved first, and stays where the link cannot be opened.
import type { Catalog } from '../../jobs/contract';
import { asJobError } from '../../jobs/contract';
import { effect } from '@preact/signals';
import type { Services } from '../../shared/session/services';
import type { CraftModel } from '../../shared/session/craft_document';
import { toast } from '../../ui';
import { sentenceOf } from '../failure_toast';
import type { Sessions } from '../rooms';
import { go } from '../route';
import type { LinkedRoom } from './sample_link';
import { readSampleLink } from './sample_link';

/** Rooms know what they offer once the services have it. */
function catalogOf({ catalog, catalogError }: Services): Promise<Catalog> {
  return new Promise((resolve, reject) => {
    const stop = effect(() => {
      if (catalog.value) resolve(catalog.value);
      else if (catalogError.value !== null) reject(new Error(catalogError.value));
      else return;
      queueMicrotask(() => stop());
    });
  });
}

type RoomSessions = Pick<Sessions, LinkedRoom['room']>;

/** False where the sample could not be read, of which its room tells, or where another project was opened meanwhile. */
async function openRoom(
  { room, sample, parameters }: LinkedRoom,
  title: string,
  sessions: RoomSessions,
  read: ReadonlyMap<string, CraftModel>,
): Promise<boolean> {
  const session = sessions[room];
  const change = session.changesHere();
  const there = read.get(sample);
  if (there) session.model.take(there);
  else if (!(await session.model.openSample(sample, title))) return false;
  change(session.commands.command({ label: 'Take the settings of the link' }, () => ({ parameters })));
  return true;
}

/** Whatever goes wrong is said in one sentence. */
export async function openSampleLink(
  hash: string,
  services: Services,
  sessions: RoomSessions,
): Promise<void> {
  try {
    toast('Opening the link.');
    const catalog = await catalogOf(services);
    const { name, rooms } = readSampleLink(hash, catalog);
    await services.projects.create(name);
    const read = new Map<string, CraftModel>();
    for (const [i, linked] of rooms.entries()) {
      if (i === 0) go(linked.room);
      const title = catalog.samples.find((sample) => sample.name === linked.sample)?.title ?? linked.sample;
      if (!(await openRoom(linked, title, sessions, read))) return;
      const { model } = sessions[linked.room].document.value;
      if (model) read.set(linked.sample, model);
    }
    services.projects.commit();
    toast(`Opened ${name} from the link, as a new project.`);
  } catch (thrown) {
    if (asJobError(thrown).code !== 'cancelled') toast(sentenceOf(thrown), true);
  }
}
