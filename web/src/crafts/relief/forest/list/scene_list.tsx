// SPDX-License-Identifier: GPL-3.0-or-later
// The list beside the plan: viewpoints with what they see of their models, pillars, and the chosen one in numbers.
import { useId } from 'preact/hooks';
import { Button, formatFixed, withUnit } from '../../../../ui';
import type { ForestSession } from '../forest_session';
import { PillarFields } from './pillar_fields';
import { figuresOf } from '../plan';
import type { Scene } from '../scene';
import { addPillar, addViewpoint } from '../scene';
import { ViewpointFields } from './viewpoint_fields';
import '../../scene_fields.css';
import { colourOf, isChosen, modelName, shapeName } from '../views';

export interface SceneListProps {
  readonly session: ForestSession;
  readonly scene: Scene;
  readonly onChooseFile: () => void;
}

export function SceneList({ session, scene, onChooseFile }: SceneListProps) {
  const { viewpoints, pillars } = scene;
  const chosen = session.chosen.value;
  const viewpoint = chosen?.kind === 'viewpoint' ? viewpoints[chosen.index] : undefined;
  const pillar = chosen?.kind === 'pillar' ? pillars[chosen.index] : undefined;
  return (
    <>
      <section class="section" aria-label="Viewpoints">
        <h3>Viewpoints</h3>
        <Viewpoints session={session} scene={scene} />
        <Button
          class="scene-add"
          size="small"
          icon="plus"
          onClick={() => {
            session.change((before) => addViewpoint(before, null), 'Add a viewpoint');
            session.chosen.value = { kind: 'viewpoint', index: viewpoints.length };
          }}
        >
          Add a viewpoint
        </Button>
      </section>
      {chosen && viewpoint ? (
        <ViewpointFields
          session={session}
          viewpoint={viewpoint}
          index={chosen.index}
          count={viewpoints.length}
          onChooseFile={onChooseFile}
        />
      ) : null}
      <section class="section" aria-label="Pillars of the scene">
        <h3>{pillars.length} pillars</h3>
        <PillarChoice session={session} scene={scene} />
        <Button
          class="scene-add"
          size="small"
          icon="plus"
          onClick={() => {
            session.change((before) => addPillar(before, null, session.firstPillar()), 'Add a pillar');
            session.chosen.value = { kind: 'pillar', index: pillars.length };
          }}
        >
          Add a pillar
        </Button>
      </section>
      {chosen && pillar ? (
        <PillarFields session={session} pillar={pillar} index={chosen.index} count={pillars.length} />
      ) : null}
    </>
  );
}

function Viewpoints({ session, scene }: { session: ForestSession; scene: Scene }) {
  const planned = session.plan.planned.value;
  const figures = planned ? figuresOf(planned.report, 'in_plan') : [];
  return (
    <ul class="scene-list" aria-busy={session.plan.running.value}>
      {scene.viewpoints.map((viewpoint, v) => {
        const own = figures[v]?.shares['own_percent'];
        return (
          <li key={v}>
            <button
              type="button"
              aria-pressed={isChosen(session.chosen.value, 'viewpoint', v)}
              onClick={() => (session.chosen.value = { kind: 'viewpoint', index: v })}
            >
              <i style={{ background: colourOf(v) }} aria-hidden="true">
                {v + 1}
              </i>
              <span class="hidden-text">Viewpoint {v + 1}, </span>
              <span class="grow clip">{modelName(session, viewpoint)}</span>
              {own === undefined ? null : <small>{withUnit(formatFixed(own, 0), '%')} on pillars</small>}
            </button>
          </li>
        );
      })}
    </ul>
  );
}

function PillarChoice({ session, scene }: { session: ForestSession; scene: Scene }) {
  const id = useId();
  const chosen = session.chosen.value;
  const value = chosen?.kind === 'pillar' ? String(chosen.index) : '';
  return (
    <div class="field-line">
      <label for={id}>Change one</label>
      <select
        id={id}
        class="select"
        value={value}
        onChange={({ currentTarget }) =>
          (session.chosen.value =
            currentTarget.value === '' ? null : { kind: 'pillar', index: Number(currentTarget.value) })
        }
      >
        <option value="">Choose one</option>
        {scene.pillars.map((pillar, p) => (
          <option key={p} value={String(p)}>
            {p + 1}, {shapeName(pillar).toLowerCase()}
          </option>
        ))}
      </select>
    </div>
  );
}
