// SPDX-License-Identifier: GPL-3.0-or-later
// Objects, the switch between the two models, what explains the difference, and how it is computed.
import { useSignal } from '@preact/signals';
import type { ComponentChildren } from 'preact';
import { useId } from 'preact/hooks';
import { Button, formatCount, formatNumber, Icon, Menu, Segmented, Switch } from '../../ui';
import { ParameterPanel } from '../../shared/panels/parameters/parameter_panel';
import { begin } from './by_hand/plan_marks';
import { Causes } from './causes';
import type { MeasuredObject, Use } from './evidence_document';
import { evidence } from './evidence_document';
import type { EvidenceSession } from './evidence_session';
import { MainButton } from './main_button';
import { Story } from './story';

export interface InspectorProps {
  readonly session: EvidenceSession;
  readonly onChooseFile: () => void;
}

const modes = [
  { value: 'diagnose', label: 'Diagnose' },
  { value: 'calibrate', label: 'Calibrate' },
] as const;

const useNames: Readonly<Record<Use, string>> = {
  fit: 'Use for fitting',
  unseen: 'Keep for checking: not used for fitting',
  good: 'Good part: from when all was in order',
  off: 'Leave out',
};

const useWords: Readonly<Record<Use, string>> = {
  fit: '',
  unseen: ', kept for checking',
  good: ', good part',
  off: ', left out',
};

export function Inspector({ session, onChooseFile }: InspectorProps) {
  const operation = session.operation.value;
  const { objects } = session.document.value;
  const diagnosis = session.diagnosis.value;
  const solving = session.activity.value.kind === 'solving';
  return (
    <>
      <div class="inspector-scroll" tabIndex={-1}>
        <div class="section">
          <Segmented
            label="What to find out"
            options={modes.map((mode) => ({
              ...mode,
              disabledReason:
                solving && mode.value !== session.mode.value
                  ? 'A diagnosis or calibration is running; Esc cancels it'
                  : undefined,
            }))}
            value={session.mode.value}
            onChange={(mode) => session.services.projects.do(evidence.setMode(mode))}
          />
          {session.result.value ? null : <p class="mode-words">{operation?.summary}</p>}
        </div>
        <section class="section" aria-label="Measured objects">
          <h3>Measured objects</h3>
          <ul class="objects">
            {objects.map((object) => (
              <ObjectRow key={object.id} session={session} object={object} />
            ))}
          </ul>
          <Button size="small" icon="plus" onClick={onChooseFile}>
            Add an object
          </Button>
          <Button size="small" kind="quiet" onClick={() => begin(session)}>
            Measure one with calipers
          </Button>
        </section>
        {diagnosis ? (
          <>
            <Story session={session} diagnosis={diagnosis} />
            <div class="section">
              <Switch
                label="Show the simulation with this cause included"
                help="On: the simulation includes the causes found. Off: it uses the calibrated material alone."
                value={session.extended.value}
                onChange={(on) => (session.extended.value = on)}
              />
            </div>
            <Causes session={session} diagnosis={diagnosis} />
            <Fold title="Material, fitted with and without the cause" count={diagnosis.parameters.length}>
              <table class="refitted">
                <thead>
                  <tr>
                    <th scope="col">Parameter</th>
                    <th scope="col">material alone</th>
                    <th scope="col">with the cause</th>
                  </tr>
                </thead>
                <tbody>
                  {diagnosis.parameters.map(({ name, label, unit, calibrated, extended }) => (
                    <tr key={name}>
                      <th scope="row">
                        {label}
                        {unit ? `, ${unit}` : ''}
                      </th>
                      <td>{shortNumber(calibrated)}</td>
                      <td>{shortNumber(extended)}</td>
                    </tr>
                  ))}
                </tbody>
              </table>
            </Fold>
            {diagnosis.notes.length > 0 ? (
              <Fold title="Notes" count={diagnosis.notes.length}>
                <ul class="plain-list">
                  {diagnosis.notes.map((note) => (
                    <li key={note}>{note}</li>
                  ))}
                </ul>
              </Fold>
            ) : null}
          </>
        ) : null}
        {operation ? (
          <ParameterPanel
            operation={operation}
            parameters={session.asked.value}
            errors={session.fieldErrors.value}
            onPreview={(name, value) => session.preview(name, value)}
            onCommit={() => session.services.projects.commit()}
            {...(session.result.value ? { openGroups: [] } : {})}
          />
        ) : null}
      </div>
      <div class="inspector-foot">
        <MainButton session={session} />
      </div>
    </>
  );
}

/** "2.51e6" where plain digits would be too many. */
export function shortNumber(value: number): string {
  const size = Math.abs(value);
  if (size !== 0 && (size >= 1e5 || size < 1e-3))
    return value.toExponential(2).replace('e+', 'e').replaceAll('-', '\u2212');
  return formatNumber(value);
}

function ObjectRow({ session, object }: { session: EvidenceSession; object: MeasuredObject }) {
  const { projects } = session.services;
  const uses: readonly Use[] =
    session.mode.value === 'diagnose' ? ['fit', 'unseen', 'good', 'off'] : ['fit', 'off'];
  const chosen = session.chosen.value?.id === object.id;
  return (
    <li class="object-row">
      <button
        type="button"
        class="object"
        aria-current={chosen ? 'true' : undefined}
        onClick={() => (session.chosenId.value = object.id)}
      >
        <strong class="clip">{object.name}</strong>
        <span>
          {formatCount(object.points)} points
          {object.thickness ? `, ${formatCount(object.thickness)} thickness` : ''}
          {useWords[object.use]}
        </span>
      </button>
      <Menu
        label={`What ${object.name} is used for`}
        buttonClass="icon-button"
        align="right"
        items={[
          ...uses.map((use) => ({
            label: useNames[use],
            checked: object.use === use,
            onSelect: () => projects.do(evidence.useObject(object, use)),
          })),
          null,
          {
            label: 'Remove this object',
            icon: 'trash' as const,
            onSelect: () => projects.do(evidence.removeObject(object)),
          },
        ]}
      >
        <Icon name="more" />
      </Menu>
    </li>
  );
}

function Fold({ title, count, children }: { title: string; count: number; children: ComponentChildren }) {
  const open = useSignal(false);
  const id = useId();
  return (
    <>
      <button
        type="button"
        class="fold"
        aria-expanded={open.value}
        aria-controls={id}
        onClick={() => (open.value = !open.value)}
      >
        <Icon name={open.value ? 'chevronDown' : 'chevronRight'} small />
        {title}
        <span>{count}</span>
      </button>
      <section id={id} class="section" hidden={!open.value} aria-label={title}>
        {open.value ? children : null}
      </section>
    </>
  );
}
