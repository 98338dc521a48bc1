// SPDX-License-Identifier: GPL-3.0-or-later
// What of the open project a link can hold, and what it leaves out.
import type { Catalog } from '../../jobs/contract';
import { evidence } from '../../crafts/evidence/evidence_document';
import { machines } from '../../crafts/machines/machines_document';
import { relief } from '../../crafts/relief/relief_document';
import { thermoform } from '../../crafts/thermoform/thermoform_document';
import { handlesOf } from '../../crafts/zippable/drawing/drawn_parts';
import { drawnOn, zippable } from '../../crafts/zippable/zippable_document';
import type { ProjectDocument } from '../../project/document';
import type { CraftDocument } from '../../shared/session/craft_document';
import { inForce, withoutDefaults } from '../../shared/session/craft_document';
import { machineProfile, withProfile } from '../../shared/session/machine_profile';
import type { LinkedRoom, ModelRoomName } from './sample_link';
import { modelRooms, operationOf, writeSampleLink } from './sample_link';

export type ProjectLink =
  | {
      /** The fragment of an address. */
      readonly link: string;
      /** What is in the project and not in the link, in words. */
      readonly leftOut: readonly string[];
    }
  /** Why there is none, in a few words for a menu and in a sentence. */
  | { readonly reason: string; readonly sentence: string };

const documentIn = (document: ProjectDocument, room: ModelRoomName): CraftDocument =>
  ({ relief, thermoform, zippable })[room].of(document);

/** Results are not among it: they are made again. */
function leftOut(document: ProjectDocument): string[] {
  const { objects, draft, scan } = evidence.of(document);
  return [
    handlesOf(drawnOn(zippable.of(document))).length > 0 ? 'the drawn parts' : '',
    machineProfile.of(document).profile ? 'the machine profile' : '',
    objects.length > 0 || draft || scan ? 'the measured objects' : '',
    machines.of(document).drawing ? 'the machine’s job' : '',
  ].filter(Boolean);
}

/** `here`: the room that the link opens in, where it has a model. */
export function linkTo(document: ProjectDocument, catalog: Catalog, here: string): ProjectLink {
  const { profile } = machineProfile.of(document);
  const rooms: LinkedRoom[] = [];
  for (const room of modelRooms) {
    const { model, parameters } = documentIn(document, room);
    const operation = operationOf(catalog, room);
    if (model === null || operation === null) continue;
    if (model.source.kind === 'file')
      return {
        reason: 'for samples only',
        sentence: `A link holds settings and the name of a built-in sample. ${model.source.file_name} is a file of your own, which is not sent anywhere. A project file has it in it.`,
      };
    if (model.source.kind === 'group')
      return {
        reason: 'for single samples only',
        sentence: `A link holds settings and the name of a built-in sample, and ${model.source.title} are several models. A project file has them in it.`,
      };
    // A machine profile has defaults of its own; the link is opened without it.
    const inUse = withProfile(operation, profile);
    const names = Object.keys(operation.parameters.properties);
    const values = Object.fromEntries(names.map((name) => [name, inForce(inUse, parameters, name)]));
    rooms.push({ room, sample: model.source.sample, parameters: withoutDefaults(operation, values) });
  }
  if (rooms.length === 0)
    return {
      reason: 'no sample in it',
      sentence:
        'A link holds settings and the name of a built-in sample, and this project has no sample. A project file has everything in it.',
    };
  rooms.sort((a, b) => Number(b.room === here) - Number(a.room === here));
  try {
    return { link: writeSampleLink({ name: document.name, rooms }), leftOut: leftOut(document) };
  } catch (thrown) {
    return { reason: 'too many settings', sentence: (thrown as Error).message };
  }
}

/** "the drawn parts, the machine profile and the measured objects". */
export const listed = (things: readonly string[]): string =>
  things.length < 2 ? things.join('') : `${things.slice(0, -1).join(', ')} and ${things.at(-1) ?? ''}`;
