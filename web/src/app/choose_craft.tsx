// SPDX-License-Identifier: GPL-3.0-or-later
// Where opened files go: the room one is in, the room that reads them, or, for a model on the start page, the one chosen here.
import type { Catalog } from '../jobs/contract';
import { drawingEndings, heightMapEnding, jobEndings } from '../crafts/machines/machines_document';
import { KeptPicture } from '../shared/panels/gallery';
import { Dialog } from '../ui';
import { crafts } from './crafts';
import type { Room } from './rooms';
import { isRoom } from './rooms';
import type { Place } from './route';

/** What measured objects come as. */
export const evidenceEndings = ['.zip', '.json', '.csv'];
const modelRooms = ['relief', 'thermoform', 'zippable'] as const;

const modelEndings = (catalog: Catalog | null) =>
  (catalog?.mesh_formats ?? []).map(({ extension }) => `.${extension}`);
const ends = (files: readonly File[], endings: readonly string[]) =>
  files.some(({ name }) => endings.some((ending) => name.toLowerCase().endsWith(ending)));

/** The room that takes these files, or null for a model that several could take. */
export function roomFor(files: readonly File[], here: Place, catalog: Catalog | null): Room | null {
  const models = modelEndings(catalog);
  if (here === 'evidence' || here === 'machines') return here;
  if (ends(files, evidenceEndings)) return 'evidence';
  const isModel = ends(files, models);
  if (!isModel && ends(files, [...drawingEndings, ...jobEndings])) return 'machines';
  if (isRoom(here)) return here;
  if (isModel) return null;
  return ends(files, [heightMapEnding]) ? 'machines' : 'relief'; // which says what it reads
}

export interface ChooseCraftProps {
  readonly files: readonly File[];
  readonly catalog: Catalog | null;
  readonly onChoose: (room: Room) => void;
  readonly onClose: () => void;
}

/** "What will you make of bunny.obj?" */
export function ChooseCraft({ files, catalog, onChoose, onClose }: ChooseCraftProps) {
  const model = files.find((file) => ends([file], modelEndings(catalog)));
  return (
    <Dialog title={`What will you make of ${model?.name ?? 'the model'}?`} onClose={onClose} wide>
      <ul class="craft-choice">
        {crafts.map(({ place, title, pitch }) => {
          const room = modelRooms.find((one) => one === place);
          return room ? (
            <li key={room}>
              <button
                type="button"
                class="craft-card"
                autofocus={room === modelRooms[0]}
                onClick={() => onChoose(room)}
              >
                <span class="craft-picture">
                  <KeptPicture name={`craft_${room}`} />
                </span>
                <span class="craft-text">
                  <strong>{title}</strong>
                  <span>{pitch}</span>
                </span>
              </button>
            </li>
          ) : null;
        })}
      </ul>
      <p class="aside">The model stays in the project: the other rooms offer it, too.</p>
    </Dialog>
  );
}
