// SPDX-License-Identifier: GPL-3.0-or-later
// The pillar forest in the relief room: its plan from above, the pillars in space, and what is seen of them.
import { Button, IconButton, Segmented, Sheet } from '../../../ui';
import { useRoomKeys } from '../../../shared/session/room_keys';
import '../../../shared/panels/room.css';
import { EyePicture } from './eye/eye_picture';
import { FloorPlan } from './floor/floor_plan';
import './forest.css';
import { ForestInspector, makeForest, saveOutput } from './forest_inspector';
import { ForestNotes } from './forest_notes';
import { ForestPictures } from './forest_pictures';
import { ForestSpace } from './forest_space';
import { ForestStrip } from './forest_strip';
import type { ForestSession } from './forest_session';
import { useNarrow } from './use_narrow';
import { eyeShown, planReach, view } from './views';

export interface ForestPageProps {
  readonly session: ForestSession;
  readonly onChooseFile: () => void;
}

const views = [
  { value: 'plan', label: 'Floor plan', short: 'Plan' },
  { value: 'space', label: 'In space', short: 'Space' },
  { value: 'pictures', label: 'From the eyes', short: 'Eyes' },
] as const;

export function ForestPage({ session, onChooseFile }: ForestPageProps) {
  useRoomKeys(session, () => ({
    solve: () => void makeForest(session),
    save: () => {
      const [main] = session.operation.value?.outputs ?? [];
      if (main && session.result.value) void saveOutput(session, main);
    },
  }));
  const isNarrow = useNarrow();
  const scene = session.scene.value;
  const made = session.shown.value;
  const shown = made === null ? 'plan' : view.value;
  const planned = session.plan.planned.value;
  const withEye = shown === 'plan' && (eyeShown.value ?? !isNarrow);
  const options = views.map(({ value, label, short }) => ({
    value,
    label: isNarrow ? short : label,
    disabledReason: value !== 'plan' && made === null ? 'Make the forest first' : undefined,
  }));
  return (
    <>
      <main class={withEye ? 'view forest-view with-eye' : 'view forest-view'} aria-label="Pillar forest">
        <h1 class="hidden-text">Pillar forest</h1>
        {shown === 'space' ? <ForestSpace session={session} /> : null}
        {shown === 'pictures' && made ? <ForestPictures session={session} result={made} /> : null}
        {shown === 'plan' && scene ? <FloorPlan session={session} scene={scene} /> : null}
        {withEye && planned ? <EyePicture session={session} planned={planned} /> : null}
        <div class="float top-left forest-bar">
          <Button icon="chevronLeft" size="small" onClick={() => session.show(false)}>
            Relief
          </Button>
          <Segmented
            floating
            label="View"
            options={options}
            value={shown}
            onChange={(value) => (view.value = value)}
          />
          {shown === 'plan' ? (
            <>
              <IconButton
                icon="frame"
                class="outlined"
                label="Show the floor up to the eyes"
                pressed={planReach.value === 'eyes'}
                onClick={() => (planReach.value = planReach.value === 'eyes' ? 'pillars' : 'eyes')}
              />
              <IconButton
                icon="eye"
                class="outlined"
                label="Show what an eye sees"
                pressed={withEye}
                onClick={() => (eyeShown.value = !withEye)}
              />
            </>
          ) : null}
        </div>
        <div class="float bottom-left foot">
          <ForestNotes session={session} view={shown} />
        </div>
      </main>
      <Sheet label="Scene and parameters">
        <ForestInspector session={session} onChooseFile={onChooseFile} />
      </Sheet>
      <footer class="strip">
        <ForestStrip session={session} />
      </footer>
    </>
  );
}
