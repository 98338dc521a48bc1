// SPDX-License-Identifier: GPL-3.0-or-later
// The light in which the relief is shown: its controls, the day's hours, the pictures to take along.
import { useId } from 'preact/hooks';
import { Button, formatFixed, Icon, withUnit } from '../../../ui';
import { ParameterPanel } from '../../../shared/panels/parameters/parameter_panel';
import { inForce } from '../../../shared/session/craft_document';
import { figure } from '../../../shared/session/report';
import type { ReliefSession } from '../relief_session';
import { DayCurve } from './day_curve';
import { clock, dayOf, lightControls } from './light_values';
import './light_panel.css';

export function LightPanel({ session }: { readonly session: ReliefSession }) {
  const { light } = session;
  const operation = light.operation.value;
  if (operation === null) return null;
  const values = session.document.value.light;
  return (
    <>
      <ParameterPanel
        operation={lightControls(operation, values)}
        parameters={values}
        errors={light.errors.value}
        onPreview={(name, value) => light.preview(name, value)}
        onCommit={() => session.services.projects.commit()}
        groupHead={{ Light: <LightHead session={session} /> }}
      />
      <LightFiles session={session} />
    </>
  );
}

function LightHead({ session }: { session: ReliefSession }) {
  const { light } = session;
  const operation = light.operation.value;
  const lit = light.lit.value;
  const dateId = useId();
  if (operation === null) return null;
  const value = (name: string) => inForce(operation, session.document.value.light, name);
  const day = lit && value('light') === 'sun' ? dayOf(lit.report) : null;
  const notes = lit?.report['notes'];
  const dateError = light.errors.value['date'];
  return (
    <>
      <LightWords session={session} />
      {day ? (
        <>
          <DayCurve day={day} hour={Number(value('hour'))} onHour={(hour) => light.set('hour', hour)} />
          <div class="row">
            {day.best === null ? null : (
              <Button size="small" onClick={() => light.set('hour', day.best)}>
                Best hour: {clock(day.best)}
              </Button>
            )}
            {day.bestInSun === null || day.bestInSun === day.best ? null : (
              <Button size="small" onClick={() => light.set('hour', day.bestInSun)}>
                Best in the sun: {clock(day.bestInSun)}
              </Button>
            )}
          </div>
        </>
      ) : null}
      {Array.isArray(notes)
        ? notes.map((note) => (
            <p key={String(note)} class="light-note" role="status">
              {String(note)}
            </p>
          ))
        : null}
      {light.problem.value ? (
        <p class="problem" role="alert">
          {light.problem.value}
        </p>
      ) : null}
      {value('light') === 'sun' ? (
        <div class="field-line">
          <label for={dateId}>Date</label>
          <input
            id={dateId}
            class="select"
            type="date"
            min="1901-01-01"
            max="2099-12-31"
            value={String(value('date'))}
            onChange={({ currentTarget }) => light.set('date', currentTarget.value)}
          />
          {dateError ? (
            <span class="problem" role="alert">
              {dateError}
            </span>
          ) : null}
        </div>
      ) : null}
    </>
  );
}

/** One line of figures. */
function LightWords({ session }: { session: ReliefSession }) {
  const { lit, running } = session.light;
  const report = lit.value?.report ?? {};
  const likeness = figure(report, 'light_similarity');
  const shadow = figure(report, 'relief_in_shadow_percent');
  return (
    <p class="light-figures" aria-live="polite">
      {running.value ? (
        <>
          <Icon name="clock" small /> Casting the light
        </>
      ) : likeness === null ? (
        'No light falls on the relief'
      ) : (
        `Likeness to the model ${formatFixed(likeness, 2)}, ${withUnit(formatFixed(shadow ?? 0, 0), '%')} in cast shadow`
      )}
    </p>
  );
}

function LightFiles({ session }: { session: ReliefSession }) {
  const { light } = session;
  const ready = light.lit.value !== null && !light.running.value;
  const reason = ready
    ? session.activity.value.kind === 'idle'
      ? undefined
      : 'Another file is being made'
    : 'Available when the light is cast';
  const save = (name: string, label: string) => (
    <Button size="small" icon="download" disabledReason={reason} onClick={() => void light.save(name, label)}>
      {label}
    </Button>
  );
  return (
    <section class="section" aria-label="Pictures in this light">
      <h3>Pictures in this light</h3>
      <div class="row wrap">
        {save('light.png', 'Picture')}
        {save('light_aside.png', 'From aside')}
        {save('walk_past.zip', 'Walking past')}
        {save('lithophane.png', 'Lithophane')}
      </div>
    </section>
  );
}
